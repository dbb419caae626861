//! Population codes: the value is given by which of `M` neurons fire, and when.

mod centres;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
mod fields;
#[cfg(feature = "rand")]
mod fired_neurons;
mod gaussian;
mod neuron;
mod position;
#[cfg(feature = "rand")]
mod probabilistic;
mod slot_spikes;
mod slots;

pub use super::held::Held;
#[cfg(feature = "rand")]
pub use fired_neurons::FiredNeurons;
pub use gaussian::Gaussian;
pub use neuron::Neuron;
pub use position::{Position, PositionState};
#[cfg(feature = "rand")]
pub use probabilistic::{Probabilistic, ProbabilisticState};
pub use slot_spikes::SlotSpikes;
pub use slots::{Slots, SlotsState};
