//! Threshold Hough spiker (T-HSA): a spike where the filter fits under the signal, nearly.

use super::decoder::RateDecoder;
use super::encoder::{RateEncoder, Rule};
use super::filter::Taps;
use super::residual::Residual;
use crate::error::{checked, finite, not_negative};
use crate::sample::for_each_sample;
use crate::{ConfigError, Sample, Scheme};

/// The threshold Hough spike algorithm.
///
/// With `r = x - shift` and `error = sum over j of max(0, h[j] - r[i+j])`: a spike at `i` if
/// `error <= threshold`; then `r[i+j] -= h[j]`. At the end of a recording samples past the end cost
/// nothing, so that a tail of zeros can spike.
///
/// - **Threshold:** 0 or more, in the samples' unit; 0 makes it [`Hough`](super::Hough).
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 20` bytes an encoder in `f32`; the taps are
///   in flash, shared.
/// - **Exactness:** `f32` pays the error out of the threshold, first tap first, one rounding each,
///   and spikes if 0 or more is left. Fixed point is exact within the range of
///   [`rate`](crate::rate).
///
/// Source: paper, section II-B, algorithm 4 (whose comparison is a slip for `<`).
///
/// ```
/// use spikewire::{Encoder, Scheme, Spike, rate::{Taps, ThresholdHough}};
///
/// static TAPS: Taps<f32, 3> = Taps::<f32, _>::triangular(1.0); // 0.5, 1, 0.5
/// const LIFT: ThresholdHough<f32, 3> = ThresholdHough::<f32, _>::checked(&TAPS, 0.25);
///
/// let mut encoder = LIFT.encoder();
/// let spikes = [0.5, 0.75, 0.5, 0.0].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [None, None, Some(Spike::Up), Some(Spike::None)]);
/// assert!(encoder.finish().eq([Spike::None, Spike::None]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ThresholdHough<'a, S, const F: usize> {
    taps: &'a Taps<S, F>,
    threshold: S,
    shift: S,
}

impl<'a, S: Sample, const F: usize> ThresholdHough<'a, S, F> {
    /// A scheme for signals whose minimum is 0.
    ///
    /// # Errors
    /// The threshold is negative or not finite.
    pub fn new(taps: &'a Taps<S, F>, threshold: S) -> Result<Self, ConfigError> {
        not_negative("threshold", threshold.to_f64())?;
        Ok(Self { taps, threshold, shift: S::ZERO })
    }

    /// The same for signals with this minimum.
    ///
    /// # Errors
    /// The shift is not finite.
    pub fn with_shift(self, shift: S) -> Result<Self, ConfigError> {
        finite("shift", shift.to_f64())?;
        Ok(Self { shift, ..self })
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path) => {
        impl<'a, const F: usize, $($generics)*> ThresholdHough<'a, $sample, F> {
            /// For constants: a negative threshold fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked(taps: &'a Taps<$sample, F>, threshold: $sample) -> Self {
                checked!(not_negative("threshold", $to_f64(threshold)));
                Self { taps, threshold, shift: $nearest(0.0) }
            }
        }
    };
}
for_each_sample!(constants);

impl<'a, S: Sample, const F: usize> Scheme for ThresholdHough<'a, S, F> {
    type Sample = S;
    type Encoder = RateEncoder<'a, S, ThresholdHoughRule<S>, F>;
    type Decoder = RateDecoder<'a, S, F>;

    const LATENCY: usize = F - 1;

    fn encoder(self) -> Self::Encoder {
        RateEncoder::new(self.taps, self.shift, ThresholdHoughRule { threshold: self.threshold })
    }

    fn decoder(self) -> Self::Decoder {
        RateDecoder::new(self.taps, self.shift)
    }
}

/// What the residuals lack to their taps is within the threshold.
#[derive(Clone, Copy, Debug)]
pub struct ThresholdHoughRule<S> {
    threshold: S,
}

impl<S: Sample> Rule<S> for ThresholdHoughRule<S> {
    #[inline]
    fn fits(&self, window: [(&[S::Residual], &[S]); 2], _: bool) -> bool {
        let mut budget = S::Residual::budget(self.threshold.widen());
        for (residuals, taps) in window {
            for (residual, tap) in residuals.iter().zip(taps) {
                match residual.pay(tap.widen(), budget) {
                    Some(left) => budget = left,
                    None => return false,
                }
            }
        }
        true
    }
}
