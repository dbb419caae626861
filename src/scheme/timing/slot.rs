//! The code of a sample as the slot of its only spike.

use crate::{Code, NeuronSpike, Polarity};

crate::scheme::index::index! {
    /// One of `N` slots of a sample.
    Slot<N>, "Slot({})"
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
