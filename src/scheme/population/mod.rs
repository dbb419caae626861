//! Population codes: the value is given by which of `M` neurons fire, and when.
//!
//! Every neuron has a centre. [`Position`] and [`Gaussian`] fire the one neuron that a sample is nearest to; the other
//! codes fire several, by chance, in [slots](crate::NeuronSpike::slot) by the strength of their response, or in the order of
//! their distance. Nothing is added up from sample to sample, so that a lost spike harms one sample only, and no
//! keyframes are needed; while no neuron fires, a decoder holds its last value.

mod centres;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
#[cfg(feature = "alloc")]
pub(super) mod dynamic_nonlinear;
#[cfg(feature = "alloc")]
pub(super) mod dynamic_rank_order;
mod fields;
#[cfg(feature = "rand-010")]
mod fired_neurons;
mod gaussian;
mod methods;
mod neuron;
mod neuron_slots;
mod nonlinear;
mod nonlinear_slots;
mod position;
#[cfg(feature = "rand-010")]
mod probabilistic;
mod rank_order;
mod slot_spikes;
mod slots;

pub use super::held::Held;
#[cfg(feature = "rand-010")]
pub use fired_neurons::FiredNeurons;
pub use gaussian::Gaussian;
pub use neuron::Neuron;
pub use neuron_slots::NeuronSlots;
pub use nonlinear_slots::NonLinearSlots;
pub use position::{Position, PositionState};
#[cfg(feature = "rand-010")]
pub use probabilistic::{Probabilistic, ProbabilisticState};
pub use rank_order::RankOrder;
pub use slot_spikes::SlotSpikes;
pub use slots::{Slots, SlotsState};
