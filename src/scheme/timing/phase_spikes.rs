//! The code of a sample as the spikes of neurons that share an oscillation.

use crate::{Code, NeuronSpike, Polarity};

/// The spikes of one sample: one of each of `M` neurons, in slots below `W + P - 1`.
///
/// `2 M` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PhaseSpikes<const M: usize, const W: usize, const P: usize> {
    /// The number of each neuron's slot, from 1; 0 is none.
    numbers: [u16; M],
}

impl<const M: usize, const W: usize, const P: usize> PhaseSpikes<M, W, P> {
    /// No spike.
    pub const SILENT: Self = Self { numbers: [0; M] };

    /// How many slots there are.
    const SLOTS: usize = W + P - 1;

    /// Each neuron in its slot, or silent. `None` if a slot is not below `W + P - 1`.
    pub fn new(slots: [Option<u16>; M]) -> Option<Self> {
        let exist = slots.iter().flatten().all(|&slot| usize::from(slot) < Self::SLOTS);
        exist.then(|| Self {
            numbers: slots.map(|slot| slot.map_or(0, |slot| slot.saturating_add(1))),
        })
    }

    /// Each neuron in its slot, neuron 0 first.
    #[inline]
    pub(super) fn of(slots: impl Iterator<Item = u16>) -> Self {
        let mut spikes = Self::SILENT;
        for (number, slot) in spikes.numbers.iter_mut().zip(slots) {
            *number = slot.wrapping_add(1);
        }
        spikes
    }

    /// The earliest slot, and the number, from 1, of the latest; `None` without spikes.
    #[inline]
    pub(super) fn ends(&self) -> Option<(u16, u16)> {
        let (mut earliest, mut latest) = (u16::MAX, 0);
        for number in self.numbers {
            // A silent neuron's number, 0, becomes the latest slot and is the lowest number: it is never an end.
            earliest = earliest.min(number.wrapping_sub(1));
            latest = latest.max(number);
        }
        (latest > 0).then_some((earliest, latest))
    }

    /// The neurons that fire, by rising index, each with its slot.
    pub fn iter(&self) -> impl Iterator<Item = (u16, u16)> {
        let slots = (0..M as u16).zip(self.numbers);
        slots.filter_map(|(neuron, number): (u16, u16)| Some((neuron, number.checked_sub(1)?)))
    }
}

impl<const M: usize, const W: usize, const P: usize> Code for PhaseSpikes<M, W, P> {
    const NEURONS: usize = M;
    const SLOTS: usize = Self::SLOTS;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.iter().map(|(neuron, slot)| NeuronSpike { neuron, slot, polarity: Polarity::Up })
    }

    /// Each neuron in the slot of its first spike.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let mut spikes = Self::SILENT;
        for NeuronSpike { neuron, slot, .. } in firings {
            let number = spikes.numbers.get_mut(usize::from(neuron));
            if let Some(number) = number.filter(|_| usize::from(slot) < Self::SLOTS) {
                let earlier = number.checked_sub(1).map_or(slot, |known| known.min(slot));
                *number = earlier.wrapping_add(1);
            }
        }
        spikes
    }
}

/// The firing neurons, each with its slot: `[[0, 12], [1, 9]]`.
#[cfg(feature = "serde")]
impl<const M: usize, const W: usize, const P: usize> serde::Serialize for PhaseSpikes<M, W, P> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        crate::serial::sequence(|| self.iter(), serializer)
    }
}
