//! ODIN: 256 neurons, and 65 536 synapses that can learn. Its input words have 17 bits.

use super::error::in_range;
use super::{ChipError, Input, Network, OdinChip, OutputSource};

/// The driver of ODIN; [`OdinChip`] documents it.
///
/// Source: RTL and documentation, ChFrenkel/ODIN.
///
/// ```
/// use spikewire_chips::{ChipError, Input, OdinInput};
///
/// type Word = Result<u32, ChipError<(), ()>>;
/// let word: Word = OdinInput::Synapse { pre: 7, post: 5 }.word();
/// assert_eq!(word, Ok(0x1_0705));
/// ```
pub type Odin<D, P> = OdinChip<OdinInput, D, P>;

/// A network for ODIN, as constant data.
pub type OdinNetwork<const IN: usize, const N: usize, const OUT: usize> =
    Network<OdinInput, IN, N, OUT>;

/// A leaky integrate-and-fire neuron of ODIN. It takes 128 bits of memory, numbered 0 to 127; the text of each field
/// names the field's bits. The driver does not support the chip's Izhikevich neurons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OdinNeuron {
    /// Threshold, 1 to 255. A neuron whose potential reaches the threshold fires, and its potential returns to 0. Bits
    /// 9 to 16.
    pub threshold: u8,
    /// Amount, 0 to 127, by which a time step lowers the potential. Bits 1 to 7; bit 8 is 1 unless the amount is 0.
    pub leak: u8,
    /// The potential, which saturates at 0 and 255. Bits 70 to 77.
    pub potential: u8,
    /// The parameters with which the synapses onto the neuron learn; `None` if they do not learn. Bits 17 to 39.
    pub learning: Option<OdinLearning>,
    /// Whether the neuron is disabled, so that it never fires. Its potential still changes. Bit 127.
    pub is_disabled: bool,
}

impl OdinNeuron {
    /// A neuron with potential 0 and the highest threshold, without leak and learning.
    pub const REST: Self =
        Self { threshold: 255, leak: 0, potential: 0, learning: None, is_disabled: false };
    /// A neuron that is not in use and never fires.
    pub const DISABLED: Self = Self { is_disabled: true, ..Self::REST };
}

/// The parameters with which the synapses onto a neuron learn, by spike-driven synaptic plasticity (SDSP).
///
/// The neuron's *calcium* is a number from 0 to 7 that rises by 1 when the neuron fires, and falls with time. A
/// presynaptic spike strengthens a synapse if the neuron's potential is high, and its calcium is at least the first
/// threshold and below the third. The spike weakens the synapse if the potential is low, and the calcium is at least
/// the first threshold and below the second.
///
/// A neuron takes 128 bits of memory, numbered 0 to 127; the text of each field names the field's bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OdinLearning {
    /// Potential at or above which a presynaptic spike can strengthen a synapse; below this potential the spike can
    /// weaken the synapse. Bits 18 to 25.
    pub potential: u8,
    /// The first, second and third threshold with which the calcium is compared, 0 to 7 each. Bits 26 to 34, 3 bits for
    /// each threshold.
    pub calcium: [u8; 3],
    /// Number of time steps after which the calcium falls by 1, 1 to 31; 0 if it never falls. Bits 35 to 39.
    pub calcium_leak: u8,
}

/// A synapse of ODIN. The synapse stores no sign: its weight has the sign of the presynaptic neuron.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OdinSynapse {
    /// Weight, 0 to 7.
    pub weight: u8,
    /// The mapping bit, which enables the synapse. If this bit is 0, the synapse acts only if
    /// [`propagates_unmapped`](OdinRegisters::propagates_unmapped) is set, and learns only if
    /// [`updates_unmapped`](OdinRegisters::updates_unmapped) is set.
    pub is_mapped: bool,
}

/// ODIN's configuration registers. They cannot be read back, and a reset leaves them undefined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[allow(clippy::struct_excessive_bools, reason = "each is a register")]
pub struct OdinRegisters {
    /// Register 1: whether the loop is open. In open loop the spikes of neurons go only to the output bus, and not to
    /// other neurons.
    pub is_open_loop: bool,
    /// Registers 2 to 17: bit `n % 16` of word `n / 16` is 1 if neuron `n` inhibits.
    pub inhibitory: [u16; 16],
    /// Register 18: interval between the spikes of a burst, in clock cycles, 20 bits; 0 disables bursts.
    pub burst_clocks: u32,
    /// Register 19: the spikes that go to the output bus.
    pub output_source: OutputSource,
    /// Registers 20 to 22: a neuron, and the presynaptic neuron of one of its synapses. If set, the output bus shows
    /// the states of the neuron and the synapse instead of spikes.
    pub monitored: Option<(u8, u8)>,
    /// Register 23: whether synapses learn even if their [mapping bit](OdinSynapse::is_mapped) is 0.
    pub updates_unmapped: bool,
    /// Register 24: whether synapses act even if their [mapping bit](OdinSynapse::is_mapped) is 0.
    pub propagates_unmapped: bool,
    /// Register 25: whether synapses also learn from [`OdinInput::Synapse`] events.
    pub learns_from_synapse: bool,
}

impl OdinRegisters {
    /// Registers for a simple network: the loop is open, all neurons are excitatory, and bursts and monitoring are off.
    /// Synapses without the mapping bit neither act nor learn.
    pub const PLAIN: Self = Self {
        is_open_loop: true,
        inhibitory: [0; 16],
        burst_clocks: 0,
        output_source: OutputSource::Neurons,
        monitored: None,
        updates_unmapped: false,
        propagates_unmapped: false,
        learns_from_synapse: false,
    };
}

/// An input word of ODIN: 17 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OdinInput {
    /// A spike of neuron `pre` that acts through one synapse only. The synapse acts if its
    /// [mapping bit](OdinSynapse::is_mapped) is 1, or if [`propagates_unmapped`](OdinRegisters::propagates_unmapped) is
    /// set.
    Synapse {
        /// The presynaptic neuron.
        pre: u8,
        /// The postsynaptic neuron.
        post: u8,
    },
    /// A spike of neuron `pre`, which acts through all synapses of that neuron.
    Spike {
        /// The neuron that fired.
        pre: u8,
    },
    /// A virtual event, which acts on one neuron without a synapse.
    Virtual {
        /// The neuron on which the event acts.
        neuron: u8,
        /// Weight, 1 to 7.
        weight: u8,
        /// Whether the weight lowers the potential.
        is_inhibitory: bool,
    },
    /// A time step for one neuron. This event waits in the chip's queue, as spikes and virtual events do.
    VirtualLeak {
        /// The neuron that takes the time step.
        neuron: u8,
    },
    /// A time step for one neuron. This event does not wait in the chip's queue.
    Leak {
        /// The neuron that takes the time step.
        neuron: u8,
    },
    /// A time step for all neurons.
    LeakAll,
    /// A bistability event for the synapses *from* one neuron: a weight of 4 or more rises by 1, up to 7; a lower
    /// weight falls by 1, down to 0. (The chip's manual says the synapses onto the neuron; its RTL differs.) Synapses
    /// without the mapping bit do not change, unless [`updates_unmapped`](OdinRegisters::updates_unmapped) is set.
    Bistability {
        /// The presynaptic neuron.
        neuron: u8,
    },
    /// A bistability event for all synapses. Each synapse changes as in [`Bistability`](Self::Bistability).
    BistabilityAll,
}

impl Input for OdinInput {
    const LEAK_ALL: Self = Self::LeakAll;
    const PROBED: u8 = 255;
    const NEURON_BYTES: u8 = 16;
    const PARAMETERS: [u8; 16] = 0xFFFF_FFFF_FFC0_003F_FFFF_FFFF_FFFF_FFFF_u128.to_le_bytes();
    /// The maximum for the slowest word, `BistabilityAll`, rounded up. This word takes 64 clock cycles for each neuron,
    /// and waits for up to 33 spikes of 512 clock cycles each. All other words take at most 1600 clock cycles:
    /// `LeakAll` takes 512, after at most two spikes.
    const MAX_CLOCKS: u32 = 34_000;
    const QUEUE: u32 = 32;
    const OPEN_LOOP: u16 = 1;
    const KIND: u8 = 2;
    const DISABLED: OdinNeuron = OdinNeuron::DISABLED;
    const SIGNS_BY_ROW: bool = true;

    type Neuron = OdinNeuron;
    type Registers = OdinRegisters;
    type Synapse = OdinSynapse;

    fn word<B, P>(self) -> Result<u32, ChipError<B, P>> {
        let word = |high: u8, low: u8| Ok(u32::from(high) << 8 | u32::from(low));
        match self {
            Self::Synapse { pre, post } => Ok(1 << 16 | u32::from(pre) << 8 | u32::from(post)),
            Self::Spike { pre } => word(pre, 0x07),
            Self::Virtual { weight: 0, .. } => Err(ChipError::ZeroWeight),
            Self::Virtual { weight, .. } if weight > 7 => {
                Err(ChipError::OutOfRange { what: "weight", value: weight.into(), min: 1, max: 7 })
            }
            Self::Virtual { neuron, weight, is_inhibitory } => {
                word(neuron, weight << 5 | u8::from(is_inhibitory) << 4 | 0b001)
            }
            Self::VirtualLeak { neuron } => word(neuron, 0b1001),
            Self::Leak { neuron } => word(neuron, 0xFF),
            Self::LeakAll => word(0, 0x7F),
            Self::Bistability { neuron } => word(neuron, 0x80),
            Self::BistabilityAll => word(0, 0x00),
        }
    }

    fn spike(pre: u8) -> Self {
        Self::Spike { pre }
    }

    fn probe(neuron: u8) -> Self {
        Self::Leak { neuron }
    }

    fn virtual_event(neuron: u8, weight: i8) -> Self {
        Self::Virtual { neuron, weight: weight.unsigned_abs(), is_inhibitory: weight < 0 }
    }

    fn neuron_bytes<B, P>(neuron: &OdinNeuron) -> Result<[u8; 16], ChipError<B, P>> {
        let &OdinNeuron { threshold, leak, potential, learning, is_disabled } = neuron;
        in_range("threshold", threshold.into(), 1, 255)?;
        in_range("leak", leak.into(), 0, 127)?;
        let mut bits = 1
            | u128::from(leak) << 1
            | u128::from(leak != 0) << 8
            | u128::from(threshold) << 9
            | u128::from(potential) << 70
            | u128::from(is_disabled) << 127;
        if let Some(OdinLearning { potential, calcium, calcium_leak }) = learning {
            in_range("calcium leak", calcium_leak.into(), 0, 31)?;
            bits |= 1 << 17 | u128::from(potential) << 18 | u128::from(calcium_leak) << 35;
            for (at, calcium) in [26, 29, 32].into_iter().zip(calcium) {
                in_range("calcium", calcium.into(), 0, 7)?;
                bits |= u128::from(calcium) << at;
            }
        }
        Ok(bits.to_le_bytes())
    }

    fn neuron(bytes: [u8; 16]) -> OdinNeuron {
        let bits = u128::from_le_bytes(bytes);
        let field = |at: u32, width: u32| (bits >> at) as u8 & (0xFF >> (8 - width));
        let learning = OdinLearning {
            potential: field(18, 8),
            calcium: [26, 29, 32].map(|at| field(at, 3)),
            calcium_leak: field(35, 5),
        };
        OdinNeuron {
            threshold: field(9, 8),
            leak: if field(8, 1) == 1 { field(1, 7) } else { 0 },
            potential: field(70, 8),
            learning: (field(17, 1) == 1).then_some(learning),
            is_disabled: field(127, 1) == 1,
        }
    }

    fn before_step(neuron: &OdinNeuron) -> Option<OdinNeuron> {
        let &OdinNeuron { threshold, leak, potential, learning, is_disabled } = neuron;
        // A time step also changes the calcium, which only neurons that learn have.
        if learning.is_some() {
            return None;
        }
        // A disabled neuron never fires, so its potential has no effect and may change.
        if is_disabled || potential == 0 && threshold > 0 {
            return Some(*neuron);
        }
        let before = potential.checked_add(leak).filter(|_| potential < threshold)?;
        Some(OdinNeuron { potential: before, ..*neuron })
    }

    /// Encodes a signed weight as the 4 bits of a synapse, which do not contain the sign. If the weight is not 0, sets
    /// the mapping bit, which enables the synapse.
    fn weight_bits<B, P>(weight: i8) -> Result<u8, ChipError<B, P>> {
        in_range("weight", weight.into(), -7, 7)?;
        Ok(if weight == 0 { 0 } else { 8 | weight.unsigned_abs() })
    }

    fn synapse_bits<B, P>(synapse: OdinSynapse) -> Result<u8, ChipError<B, P>> {
        in_range("weight", synapse.weight.into(), 0, 7)?;
        Ok(u8::from(synapse.is_mapped) << 3 | synapse.weight)
    }

    fn synapse(bits: u8) -> OdinSynapse {
        OdinSynapse { weight: bits & 7, is_mapped: bits & 8 != 0 }
    }

    fn registers(_: u8, is_open_loop: bool, inhibitory: [u16; 16]) -> OdinRegisters {
        OdinRegisters { is_open_loop, inhibitory, ..OdinRegisters::PLAIN }
    }

    fn each_register<E>(
        registers: &OdinRegisters,
        mut write: impl FnMut(u16, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        for (register, &bits) in (2..).zip(&registers.inhibitory) {
            write(register, bits.into())?;
        }
        let (neuron, synapse) = registers.monitored.unwrap_or((0, 0));
        write(18, registers.burst_clocks)?;
        write(19, registers.output_source.bit())?;
        write(20, registers.monitored.is_some().into())?;
        write(21, neuron.into())?;
        write(22, synapse.into())?;
        write(23, registers.updates_unmapped.into())?;
        write(24, registers.propagates_unmapped.into())?;
        write(25, registers.learns_from_synapse.into())?;
        write(Self::OPEN_LOOP, registers.is_open_loop.into())
    }

    fn check_registers<B, P>(registers: &OdinRegisters) -> Result<(), ChipError<B, P>> {
        in_range("burst clocks", registers.burst_clocks.into(), 0, (1 << 20) - 1)
    }

    fn is_open_loop(registers: &OdinRegisters) -> bool {
        registers.is_open_loop
    }

    fn sweep_clocks(_: &OdinRegisters) -> u32 {
        516
    }
}
