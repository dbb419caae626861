//! tinyODIN: 256 neurons, and 65 536 synapses of 4 bits. Its input words have 10 bits.

use super::error::in_range;
use super::{ChipError, Input, Network, OdinChip, OutputSource};

/// The driver of tinyODIN; [`OdinChip`] documents it.
///
/// Source: RTL and documentation, ChFrenkel/tinyODIN.
///
/// ```
/// use spikewire_chips::{ChipError, Input, TinyOdinInput};
///
/// type Word = Result<u32, ChipError<(), ()>>;
/// let word: Word = TinyOdinInput::Virtual { neuron: 5, weight: 2 }.word();
/// assert_eq!(word, Ok(0x225));
/// let word: Word = TinyOdinInput::Virtual { neuron: 5, weight: 0 }.word();
/// assert_eq!(word, Err(ChipError::ZeroWeight));
/// ```
pub type TinyOdin<D, P> = OdinChip<TinyOdinInput, D, P>;

/// A network for tinyODIN, as constant data.
pub type TinyOdinNetwork<const IN: usize, const N: usize, const OUT: usize> =
    Network<TinyOdinInput, IN, N, OUT>;

/// A leaky integrate-and-fire neuron of tinyODIN. It takes 32 bits of memory: bits 0 to 11 hold the potential, bits 12
/// to 23 the threshold, and bits 24 to 30 the leak. Bit 31 disables the neuron.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TinyOdinNeuron {
    /// Threshold, 1 to 2047. A neuron whose potential reaches the threshold fires, and its potential returns to 0.
    /// (Memory that was never written may hold threshold 0, with which a neuron fires at every event.)
    pub threshold: u16,
    /// Amount, 0 to 127, by which a time step moves the potential towards 0.
    pub leak: u8,
    /// The potential, which saturates at -2048 and 2047.
    pub potential: i16,
    /// Whether the neuron is disabled, so that it never fires. Its potential still changes.
    pub is_disabled: bool,
}

impl TinyOdinNeuron {
    /// A neuron with potential 0 and the highest threshold, without leak.
    pub const REST: Self = Self { threshold: 2047, leak: 0, potential: 0, is_disabled: false };
    /// A neuron that is not in use and never fires.
    pub const DISABLED: Self = Self { is_disabled: true, ..Self::REST };
}

/// tinyODIN's configuration registers. They cannot be read back, and a reset leaves them undefined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TinyOdinRegisters {
    /// Register 1: whether the loop is open. In open loop the spikes of neurons go only to the output bus, and not to
    /// other neurons.
    pub is_open_loop: bool,
    /// Register 2: the spikes that go to the output bus.
    pub output_source: OutputSource,
    /// Register 3: the highest neuron in use. A spike takes 2 clock cycles for each neuron up to this one.
    pub last_neuron: u8,
}

/// An input word of tinyODIN: 10 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TinyOdinInput {
    /// A spike of neuron `pre`, which acts through all synapses of that neuron.
    Spike {
        /// The neuron that fired, 0 to 255.
        pre: u8,
    },
    /// A virtual event, which acts on one neuron without a synapse.
    Virtual {
        /// The neuron on which the event acts, 0 to 15.
        neuron: u8,
        /// Weight, -8 to 7 except 0. (With weight 0 the chip would take the event for a spike on a whole row of
        /// synapses.)
        weight: i8,
    },
    /// A time step for one neuron.
    Leak {
        /// The neuron that takes the time step, 0 to 254. (To the chip, 255 means all neurons.)
        neuron: u8,
    },
    /// A time step for all neurons.
    LeakAll,
}

impl Input for TinyOdinInput {
    const LEAK_ALL: Self = Self::LeakAll;
    const PROBED: u8 = 254;
    const NEURON_BYTES: u8 = 4;
    const PARAMETERS: [u8; 16] = [0, 0xF0, 0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    /// The maximum for the slowest word, `LeakAll`, rounded up. This word waits for at most two spikes, and then
    /// processes all neurons in use. Each of the two spikes, and `LeakAll` itself, takes 2 clock cycles for each neuron
    /// in use.
    const MAX_CLOCKS: u32 = 1_600;
    const QUEUE: u32 = 128;
    const OPEN_LOOP: u16 = 1;
    const KIND: u8 = 1;
    const DISABLED: TinyOdinNeuron = TinyOdinNeuron::DISABLED;
    const SIGNS_BY_ROW: bool = false;

    type Neuron = TinyOdinNeuron;
    type Registers = TinyOdinRegisters;
    /// A signed weight, -8 to 7.
    type Synapse = i8;

    fn word<B, P>(self) -> Result<u32, ChipError<B, P>> {
        let out_of_range = |what, value: i16, min, max| {
            Err(ChipError::OutOfRange { what, value: value.into(), min, max })
        };
        match self {
            Self::Spike { pre } => Ok(pre.into()),
            Self::Virtual { weight: 0, .. } => Err(ChipError::ZeroWeight),
            Self::Virtual { weight, .. } if !(-8..=7).contains(&weight) => {
                out_of_range("weight", weight.into(), -8, 7)
            }
            Self::Virtual { neuron, .. } if neuron > 15 => {
                out_of_range("neuron", neuron.into(), 0, 15)
            }
            Self::Virtual { neuron, weight } => {
                Ok(1 << 9 | u32::from(weight as u8 & 0xF) << 4 | u32::from(neuron))
            }
            Self::Leak { neuron: 255 } => out_of_range("neuron", 255, 0, 254),
            Self::Leak { neuron } => Ok(1 << 8 | u32::from(neuron)),
            Self::LeakAll => Ok(0x1FF),
        }
    }

    fn spike(pre: u8) -> Self {
        Self::Spike { pre }
    }

    fn probe(neuron: u8) -> Self {
        Self::Leak { neuron }
    }

    fn virtual_event(neuron: u8, weight: i8) -> Self {
        Self::Virtual { neuron, weight }
    }

    fn neuron_bytes<B, P>(neuron: &TinyOdinNeuron) -> Result<[u8; 16], ChipError<B, P>> {
        let &TinyOdinNeuron { threshold, leak, potential, is_disabled } = neuron;
        in_range("threshold", threshold.into(), 1, 2047)?;
        in_range("leak", leak.into(), 0, 127)?;
        in_range("potential", potential.into(), -2048, 2047)?;
        let bits = u32::from(is_disabled) << 31
            | u32::from(leak) << 24
            | u32::from(threshold) << 12
            | potential as u32 & 0xFFF;
        let mut bytes = [0; 16];
        bytes.iter_mut().zip(bits.to_le_bytes()).for_each(|(byte, bits)| *byte = bits);
        Ok(bytes)
    }

    fn neuron([a, b, c, d, ..]: [u8; 16]) -> TinyOdinNeuron {
        let bits = u32::from_le_bytes([a, b, c, d]);
        TinyOdinNeuron {
            threshold: (bits >> 12 & 0xFFF) as u16,
            leak: (bits >> 24 & 0x7F) as u8,
            potential: (bits << 4) as i16 >> 4,
            is_disabled: bits >> 31 == 1,
        }
    }

    fn before_step(neuron: &TinyOdinNeuron) -> Option<TinyOdinNeuron> {
        let &TinyOdinNeuron { threshold, leak, potential, is_disabled } = neuron;
        let stays = u16::try_from(potential).map_or(true, |potential| potential < threshold);
        let rests = is_disabled && potential == 0;
        let before = potential + potential.signum() * i16::from(leak);
        let is_held = (-2048..=2047).contains(&before);
        (is_held && (stays || rests)).then_some(TinyOdinNeuron { potential: before, ..*neuron })
    }

    fn weight_bits<B, P>(weight: i8) -> Result<u8, ChipError<B, P>> {
        in_range("weight", weight.into(), -8, 7)?;
        Ok(weight as u8 & 0xF)
    }

    fn synapse_bits<B, P>(synapse: i8) -> Result<u8, ChipError<B, P>> {
        Self::weight_bits(synapse)
    }

    fn synapse(bits: u8) -> i8 {
        (bits << 4) as i8 >> 4
    }

    fn registers(last_neuron: u8, is_open_loop: bool, _: [u16; 16]) -> TinyOdinRegisters {
        TinyOdinRegisters { is_open_loop, output_source: OutputSource::Neurons, last_neuron }
    }

    fn each_register<E>(
        registers: &TinyOdinRegisters,
        mut write: impl FnMut(u16, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        write(2, registers.output_source.bit())?;
        write(3, registers.last_neuron.into())?;
        write(Self::OPEN_LOOP, registers.is_open_loop.into())
    }

    fn check_registers<B, P>(_: &TinyOdinRegisters) -> Result<(), ChipError<B, P>> {
        Ok(())
    }

    fn is_open_loop(registers: &TinyOdinRegisters) -> bool {
        registers.is_open_loop
    }

    fn sweep_clocks(registers: &TinyOdinRegisters) -> u32 {
        2 * u32::from(registers.last_neuron) + 6
    }
}
