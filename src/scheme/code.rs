//! Codes: the spikes that a sample becomes, and the traits of all codes.

use core::cmp::Ordering;
use core::mem::MaybeUninit;

/// The spike of a temporal or rate code for one sample, or none.
///
/// One byte. Rate codes use only [`Spike::Up`] and [`Spike::None`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(i8)]
pub enum Spike {
    /// The signal fell by a step (-1).
    Down = -1,
    /// No spike (0).
    #[default]
    None = 0,
    /// The signal rose by a step, or the filter fired (+1).
    Up = 1,
}

impl Spike {
    /// -1, 0 or +1, as in the paper.
    pub const fn sign(self) -> i8 {
        self as i8
    }

    /// Whether there is a spike of either polarity.
    pub const fn is_fired(self) -> bool {
        !matches!(self, Self::None)
    }

    /// The polarity, if there is a spike.
    pub const fn polarity(self) -> Option<Polarity> {
        match self {
            Self::Up => Some(Polarity::Up),
            Self::Down => Some(Polarity::Down),
            Self::None => None,
        }
    }

    /// The spike of a signal that is above its band, within it or below it.
    #[inline]
    pub(crate) const fn from_side(side: Ordering) -> Self {
        match side {
            Ordering::Greater => Self::Up,
            Ordering::Equal => Self::None,
            Ordering::Less => Self::Down,
        }
    }
}

/// The direction of a spike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Polarity {
    /// -1.
    Down,
    /// +1, and every spike of a rate or population code.
    Up,
}

impl From<Polarity> for Spike {
    fn from(polarity: Polarity) -> Self {
        match polarity {
            Polarity::Up => Self::Up,
            Polarity::Down => Self::Down,
        }
    }
}

/// One neuron's spike within the code of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NeuronSpike {
    /// The neuron within its channel, from 0.
    pub neuron: u16,
    /// The sub-timestep within the sample, from 0; 0 for codes without sub-timesteps.
    pub slot: u16,
    /// The direction.
    pub polarity: Polarity,
}

/// The code of one sample: any number of neurons that fire.
pub trait Code: Copy {
    /// How many neurons a channel of this code has.
    const NEURONS: usize;

    /// How many sub-timesteps a sample of this code has.
    const SLOTS: usize = 1;

    /// Whether a neuron fires in both directions. A chip, whose inputs have no direction, then needs two inputs for it.
    const IS_SIGNED: bool = false;

    /// The neurons that fire, by rising index.
    fn firings(&self) -> impl Iterator<Item = NeuronSpike>;

    /// The code that these firings, in any order, make up.
    ///
    /// The firings of a code give that code back. A chip may also fire a neuron twice, or neurons that no encoder
    /// fires together; each code's own `assemble` says what that becomes. Neurons and slots that the code does
    /// not have are left out.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self;
}

impl Code for Spike {
    const NEURONS: usize = 1;
    const IS_SIGNED: bool = true;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.polarity().map(|polarity| NeuronSpike { neuron: 0, slot: 0, polarity }).into_iter()
    }

    /// The direction of most spikes; no spike if as many went up as down.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let balance =
            firings.filter(|firing| firing.neuron == 0).fold(0_i32, |balance, firing| match firing
                .polarity
            {
                Polarity::Up => balance.saturating_add(1),
                Polarity::Down => balance.saturating_sub(1),
            });
        Self::from_side(balance.cmp(&0))
    }
}

/// What an encoder returns for a sample: a code, or `None` while it waits for later samples.
pub trait Output: Copy {
    /// The code, which a decoder takes.
    type Code: Code;

    /// The code, or `None` while the encoder waits for later samples.
    fn code(self) -> Option<Self::Code>;
}

/// The code of a scheme that waits for no later sample is its own output.
impl<C: Code> Output for C {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}

/// A place for the output of a sample: an output, which is replaced, or memory that is not initialised yet.
///
/// ```
/// use core::mem::MaybeUninit;
/// use spikewire::{Scheme, Spike, Start, temporal::StepForward};
///
/// const ROLL: StepForward<f32> = StepForward::new(0.25);
/// let mut state = StepForward::START;
/// let mut memory = [const { MaybeUninit::<Spike>::uninit() }; 3];
/// assert_eq!(ROLL.encode_slice(&mut state, &[0.0, 0.3, 0.6], &mut memory), 3);
/// ```
pub trait Destination<T> {
    /// Stores an output.
    fn write(&mut self, output: T);

    /// Fills an output and stores it.
    fn write_with(&mut self, mut output: T, fill: impl FnOnce(&mut T)) {
        fill(&mut output);
        self.write(output);
    }
}

impl<T> Destination<T> for T {
    #[inline]
    fn write(&mut self, output: T) {
        *self = output;
    }

    #[inline]
    fn write_with(&mut self, output: T, fill: impl FnOnce(&mut T)) {
        *self = output;
        fill(self);
    }
}

impl<T> Destination<T> for MaybeUninit<T> {
    #[inline]
    fn write(&mut self, output: T) {
        self.write(output);
    }

    #[inline]
    fn write_with(&mut self, output: T, fill: impl FnOnce(&mut T)) {
        fill(self.write(output));
    }
}

/// What rate codes return: `None` until as many samples have come as the filter has taps, then the spike of the
/// sample [`LATENCY`](crate::Scheme::LATENCY) ago.
impl Output for Option<Spike> {
    type Code = Spike;

    fn code(self) -> Option<Spike> {
        self
    }
}
