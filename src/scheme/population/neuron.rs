//! The code of a sample as one neuron of a population.

use core::num::NonZeroU16;

use crate::{Code, NeuronSpike, Output, Polarity};

/// One of `M` neurons.
///
/// Two bytes, also as an `Option`.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Neuron<const M: usize>(NonZeroU16);

impl<const M: usize> Neuron<M> {
    /// The neuron with this index, if there is one.
    pub const fn new(index: u16) -> Option<Self> {
        if (index as usize) < M { Self::counted(index + 1) } else { None }
    }

    /// Its index, 0 to `M - 1`.
    pub const fn index(self) -> u16 {
        self.0.get() - 1
    }

    /// The neuron with this number, from 1; `None` for 0.
    pub(super) const fn counted(number: u16) -> Option<Self> {
        match NonZeroU16::new(number) {
            Some(number) => Some(Self(number)),
            None => None,
        }
    }
}

impl<const M: usize> core::fmt::Debug for Neuron<M> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Neuron").field(&self.index()).finish()
    }
}

#[cfg(feature = "defmt")]
impl<const M: usize> defmt::Format for Neuron<M> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Neuron({})", self.index());
    }
}

/// Its index.
#[cfg(feature = "serde")]
impl<const M: usize> serde::Serialize for Neuron<M> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_newtype_struct("Neuron", &self.index())
    }
}

/// A sample that is not finite fires no neuron: `None`.
impl<const M: usize> Code for Option<Neuron<M>> {
    const NEURONS: usize = M;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.map(|neuron| NeuronSpike { neuron: neuron.index(), slot: 0, polarity: Polarity::Up })
            .into_iter()
    }

    /// The neuron that fired most often; the lowest, if there are several.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let mut counts = [0_u16; M];
        for firing in firings {
            if let Some(count) = counts.get_mut(usize::from(firing.neuron)) {
                *count = count.saturating_add(1);
            }
        }
        let most = counts.iter().copied().max().filter(|&most| most > 0)?;
        let winner = counts.iter().position(|&count| count == most)?;
        Neuron::new(winner as u16)
    }
}

impl<const M: usize> Output for Option<Neuron<M>> {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}
