//! The code of a sample as any number of neurons of a population.

use crate::{Code, NeuronSpike, Polarity};

/// Which neurons fired for one sample.
///
/// `M` bytes, rounded up to words.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FiredNeurons<const M: usize> {
    pub(super) fired: [bool; M],
}

impl<const M: usize> FiredNeurons<M> {
    /// No spike.
    pub const EMPTY: Self = Self { fired: [false; M] };

    /// The code in which these neurons fire, from a link or a file. `None` if one is not below `M`, or comes twice.
    pub fn new(neurons: impl IntoIterator<Item = u16>) -> Option<Self> {
        let mut code = Self::EMPTY;
        for neuron in neurons {
            let fired = code.fired.get_mut(usize::from(neuron))?;
            if core::mem::replace(fired, true) {
                return None;
            }
        }
        Some(code)
    }

    /// The neurons that fired, by rising index.
    pub fn iter(&self) -> impl Iterator<Item = u16> {
        (0..M).zip(&self.fired).filter_map(|(neuron, &fired)| fired.then_some(neuron as u16))
    }

    /// Calls `take` for each neuron that fired, by rising index. Skips four at once if none of them fired.
    #[inline]
    pub(super) fn for_each(&self, mut take: impl FnMut(usize)) {
        let mut take_fired = |first: usize, neurons: &[bool]| {
            for (neuron, &fired) in (first..).zip(neurons) {
                if fired {
                    take(neuron);
                }
            }
        };
        let (quartets, rest) = self.fired.as_chunks::<4>();
        for (i, quartet) in quartets.iter().enumerate() {
            if *quartet != [false; 4] {
                take_fired(4 * i, quartet);
            }
        }
        take_fired(M - M % 4, rest);
    }
}

impl<const M: usize> Code for FiredNeurons<M> {
    const NEURONS: usize = M;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        self.iter().map(|neuron| NeuronSpike { neuron, slot: 0, polarity: Polarity::Up })
    }

    /// Every neuron that fired at least once.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let mut neurons = Self::EMPTY;
        for firing in firings {
            if let Some(fired) = neurons.fired.get_mut(usize::from(firing.neuron)) {
                *fired = true;
            }
        }
        neurons
    }
}

/// The neurons that fired: `[2, 3]`.
#[cfg(feature = "serde")]
impl<const M: usize> serde::Serialize for FiredNeurons<M> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        crate::serial::sequence(|| self.iter(), serializer)
    }
}
