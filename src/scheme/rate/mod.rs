//! Rate codes: spikes whose convolution with a filter gives the signal back.
//!
//! Each looks ahead over the filter, and at every spike subtracts the filter from the residual `r`, which starts
//! as `x - shift`. `shift` is the signal's minimum, from a [`Calibration`](crate::Calibration). They share one
//! decoder, [`RateDecoderState`].
//!
//! **Range.** 16-bit residuals are always exact. 32-bit fixed point is exact while `|x - shift|` is at most the
//! type's maximum minus the sum of the taps' magnitudes, and saturates there. In `f32` the shift and the sum of the
//! taps' magnitudes are limited to 10³¹, so that no sample makes a residual infinite.

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
