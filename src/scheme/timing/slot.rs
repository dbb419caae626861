//! The code of a sample as the slot of its only spike.

use core::num::NonZeroU16;

use crate::{Code, NeuronSpike, Output, Polarity};

/// One of `N` slots of a sample.
///
/// Two bytes, also as an `Option`.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Slot<const N: usize>(NonZeroU16);

impl<const N: usize> Slot<N> {
    /// The slot with this index, if there is one.
    pub const fn new(index: u16) -> Option<Self> {
        if (index as usize) < N { Self::counted(index.wrapping_add(1)) } else { None }
    }

    /// Its index, 0 to `N - 1`.
    pub const fn index(self) -> u16 {
        self.0.get() - 1
    }

    /// The slot with this number; the first is 1, and 0 is none.
    pub(super) const fn counted(number: u16) -> Option<Self> {
        match NonZeroU16::new(number) {
            Some(number) => Some(Self(number)),
            None => None,
        }
    }
}

impl<const N: usize> core::fmt::Debug for Slot<N> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Slot").field(&self.index()).finish()
    }
}

#[cfg(feature = "defmt")]
impl<const N: usize> defmt::Format for Slot<N> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Slot({})", self.index());
    }
}

/// Its index.
#[cfg(feature = "serde")]
impl<const N: usize> serde::Serialize for Slot<N> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_newtype_struct("Slot", &self.index())
    }
}

/// `None` for a sample without a spike.
impl<const N: usize> Code for Option<Slot<N>> {
    const NEURONS: usize = 1;
    const SLOTS: usize = N;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.map(|slot| NeuronSpike { neuron: 0, slot: slot.index(), polarity: Polarity::Up })
            .into_iter()
    }

    /// The slot of the first spike.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let of_neuron = firings.filter(|firing| firing.neuron == 0);
        of_neuron.map(|firing| firing.slot).min().and_then(Slot::new)
    }
}

impl<const N: usize> Output for Option<Slot<N>> {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}
