//! ODIN: tinyODIN's elder, with learning synapses and 17-bit words.

use super::{ChipError, Input, OdinChip};

/// ODIN; see [`OdinChip`]. A neuron has 128 bits of parameters and state.
///
/// Source: RTL and documentation, ChFrenkel/ODIN.
///
/// ```
/// use spikewire::chip::{ChipError, Input, OdinInput};
///
/// type Word = Result<u32, ChipError<(), ()>>;
/// let word: Word = OdinInput::Synapse { pre: 7, post: 5 }.word();
/// assert_eq!(word, Ok(0x1_0705));
/// ```
pub type Odin<D, P> = OdinChip<OdinInput, D, P>;

/// What goes into ODIN: 17 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OdinInput {
    /// Neuron `pre` fired, for one synapse only.
    Synapse {
        /// The neuron that fired.
        pre: u8,
        /// The neuron that it acts on.
        post: u8,
    },
    /// Neuron `pre` fired: all its synapses act.
    Spike {
        /// The neuron that fired.
        pre: u8,
    },
    /// Acts on one neuron without a synapse.
    Virtual {
        /// The neuron.
        neuron: u8,
        /// 1 to 7.
        weight: u8,
        /// Whether it inhibits.
        is_inhibitory: bool,
    },
    /// A time step for one neuron, in turn with virtual events and spikes.
    VirtualLeak {
        /// The neuron.
        neuron: u8,
    },
    /// A time step for one neuron, at once.
    Leak {
        /// The neuron.
        neuron: u8,
    },
    /// A time step for all neurons.
    LeakAll,
    /// Pulls the synapses onto one neuron towards their stable states.
    Bistability {
        /// The neuron.
        neuron: u8,
    },
    /// The same for all synapses.
    BistabilityAll,
}

impl Input for OdinInput {
    const LEAK_ALL: Self = Self::LeakAll;
    const NEURON_BYTES: u8 = 16;
    /// `BistabilityAll` takes 64 clocks a neuron, and waits for up to 33 spikes of 512 each. The others
    /// take 1600 at most: `LeakAll` 512, after no more than two spikes.
    const MAX_CLOCKS: u32 = 34_000;

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
}
