//! tinyODIN: 256 neurons, 64k synapses of 4 bits.

use super::{ChipError, Input, OdinChip};

/// tinyODIN; see [`OdinChip`].
///
/// Registers: 0 gate activity (see [`OdinChip::gate`]), 1 open loop, 2 source of the output bus, 3 the
/// highest neuron in use. A neuron's 32 bits: 0-11 potential, 12-23 threshold, 24-30 leak, 31 disable.
///
/// Source: RTL and documentation, ChFrenkel/tinyODIN.
///
/// ```
/// use spikewire::chip::{ChipError, Input, TinyOdinInput};
///
/// type Word = Result<u32, ChipError<(), ()>>;
/// let word: Word = TinyOdinInput::Virtual { neuron: 5, weight: 2 }.word();
/// assert_eq!(word, Ok(0x225));
/// let word: Word = TinyOdinInput::Virtual { neuron: 5, weight: 0 }.word();
/// assert_eq!(word, Err(ChipError::ZeroWeight));
/// ```
pub type TinyOdin<D, P> = OdinChip<TinyOdinInput, D, P>;

/// What goes into tinyODIN: 10 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TinyOdinInput {
    /// Neuron `pre` fired: all its synapses act.
    Spike {
        /// The neuron, 0 to 255.
        pre: u8,
    },
    /// Acts on one neuron without a synapse.
    Virtual {
        /// The neuron, 0 to 15.
        neuron: u8,
        /// -8 to 7, but not 0, which would act as a full spike.
        weight: i8,
    },
    /// A time step for one neuron.
    Leak {
        /// The neuron, 0 to 254: 255 stands for all.
        neuron: u8,
    },
    /// A time step for all neurons.
    LeakAll,
}

impl Input for TinyOdinInput {
    const LEAK_ALL: Self = Self::LeakAll;
    const NEURON_BYTES: u8 = 4;
    /// `LeakAll` takes 2 clocks for each neuron up to the highest in use, and waits for up to two spikes
    /// that take as many.
    const MAX_CLOCKS: u32 = 1_600;

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
}
