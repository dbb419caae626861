//! Codes of a signal's mean: the number of spikes in a time gives the mean of the signal over that time.
//!
//! What their decoders share is here: a range, and how the mean of spikes is taken.

mod averaging;
#[cfg(feature = "rand-010")]
mod bernoulli;
mod burst;
mod integrate;
mod range;
mod sigma_delta;

pub use averaging::{Average, Averaging, MeanState, Window};
#[cfg(feature = "rand-010")]
pub use bernoulli::{Bernoulli, BernoulliState};
pub use burst::{WeightedBurst, WeightedBurstState};
pub use integrate::{IntegrateAndFire, IntegrateAndFireState, PotentialState};
pub use sigma_delta::{SigmaDelta, SigmaDeltaState};
