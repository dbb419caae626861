//! The code of a sample as spikes of any neurons of a population, each in one of several sub-timesteps.

use crate::{Code, NeuronSpike, Polarity};

/// The spikes of one sample: any of `M` neurons, each in its slot of `N`, which is at most 256.
///
/// `2 M` bytes, rounded up to words.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NeuronSlots<const M: usize, const N: usize> {
    /// The slot of each neuron, counted from 1; 0 if it is silent.
    pub(super) slots: [u16; M],
}

impl<const M: usize, const N: usize> NeuronSlots<M, N> {
    /// No spike.
    pub const EMPTY: Self = Self { slots: [0; M] };

    /// Neurons, each with its slot, as they came over a link or from a file.
    ///
    /// `None` if a neuron is not below `M` or comes twice, or a slot is not below `N`.
    pub fn new(spikes: impl IntoIterator<Item = (u16, u16)>) -> Option<Self> {
        let mut code = Self::EMPTY;
        for (neuron, slot) in spikes {
            let known = code.slots.get_mut(usize::from(neuron)).filter(|known| **known == 0)?;
            *known = Self::counted(slot)?;
        }
        Some(code)
    }

    /// The neurons that fire, by rising index, each with its slot.
    pub fn iter(&self) -> impl Iterator<Item = (u16, u16)> {
        let slots = (0..M as u16).zip(&self.slots).filter(|&(_, &slot)| slot > 0);
        slots.map(|(neuron, &slot)| (neuron, slot.wrapping_sub(1)))
    }

    /// How many neurons fire.
    pub fn len(&self) -> usize {
        self.slots.iter().filter(|&&slot| slot > 0).count()
    }

    /// Whether none fires.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A slot below `N`, counted from 1.
    const fn counted(slot: u16) -> Option<u16> {
        if (slot as usize) < N { Some(slot.wrapping_add(1)) } else { None }
    }
}

impl<const M: usize, const N: usize> Code for NeuronSlots<M, N> {
    const NEURONS: usize = M;
    const SLOTS: usize = N;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.iter().map(|(neuron, slot)| NeuronSpike { neuron, slot, polarity: Polarity::Up })
    }

    /// Each neuron in the slot of its first spike.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let mut code = Self::EMPTY;
        for NeuronSpike { neuron, slot, .. } in firings {
            let known = code.slots.get_mut(usize::from(neuron));
            if let (Some(known), Some(slot)) = (known, Self::counted(slot)) {
                *known = if *known == 0 { slot } else { slot.min(*known) };
            }
        }
        code
    }
}

/// The firing neurons, each with its slot: `[[0, 42], [3, 10]]`.
#[cfg(feature = "serde")]
impl<const M: usize, const N: usize> serde::Serialize for NeuronSlots<M, N> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        crate::serial::sequence(|| self.iter(), serializer)
    }
}
