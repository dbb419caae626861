//! Population codes: the value is given by which of `M` neurons fire, and when.

mod centres;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
#[cfg(feature = "alloc")]
pub(super) mod dynamic_nonlinear;
#[cfg(feature = "alloc")]
pub(super) mod dynamic_rank_order;
mod fields;
#[cfg(feature = "rand")]
mod fired_neurons;
mod gaussian;
mod neuron;
mod neuron_slots;
mod nonlinear;
mod nonlinear_slots;
mod position;
#[cfg(feature = "rand")]
mod probabilistic;
mod rank_order;
mod slot_spikes;
mod slots;

pub use super::held::Held;
#[cfg(feature = "rand")]
pub use fired_neurons::FiredNeurons;
pub use gaussian::Gaussian;
pub use neuron::Neuron;
pub use neuron_slots::NeuronSlots;
pub use nonlinear_slots::NonLinearSlots;
pub use position::{Position, PositionState};
#[cfg(feature = "rand")]
pub use probabilistic::{Probabilistic, ProbabilisticState};
pub use rank_order::RankOrder;
pub use slot_spikes::SlotSpikes;
pub use slots::{Slots, SlotsState};
