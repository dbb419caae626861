//! Rate codes: the spikes, convolved with a filter, give the signal back, or their count gives its mean.
//!
//! **Filters** ([`Hough`], [`ThresholdHough`], [`Bsa`], [`BsaToolbox`]). Each looks ahead over the filter's length,
//! and at every spike subtracts the filter from the residual `r`, which is `x - shift` at first. `shift` is the
//! signal's minimum, from a [`Calibration`](crate::Calibration). They share one decoder, [`RateDecoderState`].
//!
//! **The filters' range.** 16-bit residuals are always exact. 32-bit fixed point is exact while `|x - shift|` is at most the
//! type's maximum minus the sum of the taps' magnitudes, and saturates there. In `f32` the shift and the sum of the
//! taps' magnitudes are limited to 10³¹, so that no sample makes a residual infinite.
//!
//! **Means** ([`SigmaDelta`], `Bernoulli`, [`WeightedBurst`], [`IntegrateAndFire`]). These codes do not look ahead.
//! Their decoders give a mean of the past, over a [`Window`] or as an [`Average`], so that a lost spike is forgotten.

// A decision and the subtraction after it share what they load only where both are inlined.
#![allow(clippy::inline_always)]

mod bsa;
mod bsa_toolbox;
mod cursor;
mod decoder;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
mod encoder;
mod filter;
mod filtered;
mod hough;
mod mean;
mod threshold_hough;

pub use bsa::{Bsa, Criterion};
pub use bsa_toolbox::{BsaToolbox, BsaToolboxState};
pub use decoder::RateDecoderState;
pub use encoder::RateState;
pub use filter::{Scale, Shape, Taps};
pub use hough::Hough;
pub use mean::{
    Average, Averaging, IntegrateAndFire, IntegrateAndFireState, MeanState, PotentialState,
    SigmaDelta, SigmaDeltaState, WeightedBurst, WeightedBurstState, Window,
};
#[cfg(feature = "rand-010")]
pub use mean::{Bernoulli, BernoulliState};
pub use threshold_hough::ThresholdHough;
