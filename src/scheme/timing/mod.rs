//! Timing codes: the time of a spike within its sample gives the value.
//!
//! A sample is divided into slots, sub-timesteps of the caller's length: [`NeuronSpike::slot`](crate::NeuronSpike::slot) names
//! one, [`Bank::with_slot_ticks`](crate::Bank::with_slot_ticks) says how long they last. Nothing is added up from
//! sample to sample, so that a lost spike harms one sample only, and no keyframes are needed.
//!
//! **Range.** The codes cover `min..=max`; samples outside are encoded as the nearer end.

mod burst;
mod burst_spikes;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
mod first_spike;
mod latency_phase;
mod phase_bits;
mod phase_spikes;
mod slot;
mod state;
mod weighted_phase;

pub use super::held::Held;
pub use burst::Burst;
pub use burst_spikes::BurstSpikes;
pub use first_spike::FirstSpike;
pub use latency_phase::LatencyPhase;
pub use phase_bits::PhaseBits;
pub use phase_spikes::PhaseSpikes;
pub use slot::Slot;
pub use state::TimingState;
pub use weighted_phase::WeightedPhase;
