//! What a sample becomes: a spike, or the neurons of a population that fire.

/// What a step or rate code emits for one sample.
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
pub struct Firing {
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

    /// The neurons that fire, by rising index.
    fn firings(&self) -> impl Iterator<Item = Firing>;
}

impl Code for Spike {
    const NEURONS: usize = 1;

    fn firings(&self) -> impl Iterator<Item = Firing> {
        self.polarity().map(|polarity| Firing { neuron: 0, slot: 0, polarity }).into_iter()
    }
}
