//! The code of a sample as spikes of neighbouring neurons, each in one of several sub-timesteps.

use crate::{Code, NeuronSpike, Polarity};

/// The spikes of one sample: neighbouring neurons of `M`, each in one of `N` slots.
///
/// `M + 4` bytes, rounded up to words.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlotSpikes<const M: usize, const N: usize> {
    pub(super) first: u16,
    pub(super) length: u16,
    pub(super) slots: [u8; M],
}

impl<const M: usize, const N: usize> SlotSpikes<M, N> {
    /// No spike.
    pub const EMPTY: Self = Self { first: 0, length: 0, slots: [0; M] };

    /// The code in which the neurons from `first` on fire in these slots, from a link or a file.
    ///
    /// `None` if they reach beyond the `M` neurons, or a slot is not below `N`.
    pub fn new(first: u16, slots: &[u8]) -> Option<Self> {
        let end = usize::from(first) + slots.len();
        if end > M || slots.iter().any(|&slot| usize::from(slot) >= N) {
            return None;
        }
        let mut spikes = Self { first, length: slots.len() as u16, ..Self::EMPTY };
        for (known, &slot) in spikes.slots.iter_mut().zip(slots) {
            *known = slot;
        }
        Some(spikes)
    }

    /// The neurons that fire, by rising index, each with its slot.
    pub fn iter(&self) -> impl Iterator<Item = (u16, u16)> {
        let slots = (0..self.length).zip(&self.slots);
        slots.map(|(i, &slot)| (self.first.wrapping_add(i), slot.into()))
    }

    /// The first neuron that fires.
    pub(super) const fn first(&self) -> usize {
        self.first as usize
    }

    /// The slots of the neurons that fire.
    pub(super) fn slots(&self) -> &[u8] {
        self.slots.get(..self.len()).unwrap_or(&self.slots)
    }

    /// How many neurons fire.
    pub const fn len(&self) -> usize {
        self.length as usize
    }

    /// Whether none fires.
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }
}

impl<const M: usize, const N: usize> Code for SlotSpikes<M, N> {
    const NEURONS: usize = M;
    const SLOTS: usize = N;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.iter().map(|(neuron, slot)| NeuronSpike { neuron, slot, polarity: Polarity::Up })
    }

    /// The neuron that fired first (the lowest, if there are several) and its neighbours on either side up to one that
    /// did not fire, each in the slot of its first spike.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let mut slots = [None::<u8>; M];
        for NeuronSpike { neuron, slot, .. } in
            firings.filter(|firing| usize::from(firing.slot) < N)
        {
            if let Some(known) = slots.get_mut(usize::from(neuron)) {
                *known = Some(known.map_or(slot as u8, |known| known.min(slot as u8)));
            }
        }
        let Some(earliest) = slots.iter().flatten().copied().min() else { return Self::EMPTY };
        let winner = slots.iter().position(|&slot| slot == Some(earliest)).unwrap_or_default();
        let (before, after) = slots.split_at_checked(winner).unwrap_or_default();
        let left = before.iter().rev().take_while(|slot| slot.is_some()).count();
        let right = after.iter().take_while(|slot| slot.is_some()).count();
        let first = winner.wrapping_sub(left);
        let mut spikes =
            Self { first: first as u16, length: left.wrapping_add(right) as u16, ..Self::EMPTY };
        for (slot, fired) in spikes.slots.iter_mut().zip(slots.iter().skip(first).flatten()) {
            *slot = *fired;
        }
        spikes
    }
}

/// The firing neurons, each with its slot: `[[0, 42], [1, 10]]`.
#[cfg(feature = "serde")]
impl<const M: usize, const N: usize> serde::Serialize for SlotSpikes<M, N> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        crate::serial::sequence(|| self.iter(), serializer)
    }
}
