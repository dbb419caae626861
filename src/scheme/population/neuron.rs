//! The code of a sample as one neuron of a population.

use crate::{Code, NeuronSpike, Polarity};

crate::scheme::index::index! {
    /// One of `M` neurons.
    Neuron<M>, "Neuron({})"
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
