//! Rate codes: spikes whose convolution with a filter gives the signal back.
//!
//! All work on `r = x - shift`, look ahead over the filter, and subtract the filter from the
//! residual at every spike. `shift` is the signal's minimum, from a
//! [`Calibration`](crate::Calibration). One decoder serves them all, [`RateDecoderState`].
//!
//! A residual in 32-bit fixed point is exact while `|x - shift|` stays within the type's maximum
//! less the sum of the taps' magnitudes; beyond, it saturates there. In 16 bits it is always exact.
//! In `f32` neither the shift nor all taps together reach beyond 10³¹, so that no residual becomes
//! infinite, whatever the sample.

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
mod threshold_hough;

pub use bsa::{Bsa, Criterion};
pub use bsa_toolbox::{BsaToolbox, BsaToolboxState};
pub use decoder::RateDecoderState;
pub use encoder::RateState;
pub use filter::{Scale, Shape, Taps};
pub use hough::Hough;
pub use threshold_hough::ThresholdHough;
