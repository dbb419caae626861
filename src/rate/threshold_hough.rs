//! Threshold Hough spiker (T-HSA): a spike where the filter fits under the signal, nearly.

use super::decoder::RateDecoder;
use super::encoder::{RateEncoder, Rule};
use super::filter::Taps;
use super::residual::Residual;
use crate::error::{checked, not_negative, offset};
use crate::sample::for_each_sample;
use crate::{ConfigError, Sample, Scheme};

/// The threshold Hough spike algorithm.
///
/// With `r = x - shift` and `error = sum over j of max(0, h[j] - r[i+j])`: a spike at `i` if
/// `error <= threshold`; then `r[i+j] -= h[j]`. At the end of a recording samples past the end cost
/// nothing, so that a tail of zeros can spike.
///
/// - **Threshold:** 0 or more, in the samples' unit; 0 makes it [`Hough`](super::Hough).
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 20` bytes an encoder in `f32`, and `16 F` of
///   stack for slices; the taps are in flash, shared.
/// - **Exactness:** `f32` sums `|r - h| - (r - h)`, which is twice the error, first tap first, and
///   compares with twice the threshold. Fixed point is exact within the range of
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
    /// The shift is not finite, or beyond ±10³¹ in `f32`.
    pub fn with_shift(self, shift: S) -> Result<Self, ConfigError> {
        offset("shift", shift.to_f64())?;
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
    type Encoder = RateEncoder<'a, S, ThresholdHoughRule<S::Residual>, F>;
    type Decoder = RateDecoder<'a, S, F>;

    const LATENCY: usize = F - 1;

    fn encoder(self) -> Self::Encoder {
        RateEncoder::new(
            self.taps,
            self.shift,
            ThresholdHoughRule { threshold: self.threshold.widen() },
        )
    }

    fn decoder(self) -> Self::Decoder {
        RateDecoder::new(self.taps, self.shift)
    }
}

/// What the residuals lack to their taps is within the threshold.
#[derive(Clone, Copy, Debug)]
pub struct ThresholdHoughRule<R> {
    threshold: R,
}

impl<R: Residual> Rule<R> for ThresholdHoughRule<R> {
    const IN_ORDER: bool = true;

    #[inline(always)]
    fn fits(&self, pairs: impl Iterator<Item = (R, R)>, _: bool) -> bool {
        R::lacks_at_most(self.threshold, pairs)
    }

    #[inline(always)]
    fn fits_by_slot(&self, pairs: impl Iterator<Item = (R, R)>) -> Option<bool> {
        R::lacks_at_most_anyway(self.threshold, pairs)
    }
}

/// What residuals lack to their taps. Sealed: only this crate can name it.
pub trait Lack: Sized {
    /// Whether the error is at most the threshold.
    fn lacks_at_most(threshold: Self, pairs: impl Iterator<Item = (Self, Self)>) -> bool;

    /// The same with the pairs in any order; `None` if the order matters.
    fn lacks_at_most_anyway(
        threshold: Self,
        pairs: impl Iterator<Item = (Self, Self)>,
    ) -> Option<bool>;
}

/// Twice the error, first pair first; `None` if it is more than `most`.
#[inline(always)]
fn twice_error(most: f32, pairs: impl Iterator<Item = (f32, f32)>) -> Option<f32> {
    let mut error = 0.0;
    for (count, (residual, tap)) in pairs.enumerate() {
        let left = residual - tap;
        error += left.abs() - left;
        // It only grows, and is looked at every few taps.
        if count % 4 == 3 && error > most {
            return None;
        }
    }
    (error <= most).then_some(error)
}

impl Lack for f32 {
    #[inline(always)]
    fn lacks_at_most(threshold: f32, pairs: impl Iterator<Item = (f32, f32)>) -> bool {
        twice_error(threshold + threshold, pairs).is_some()
    }

    /// Two orders of the same terms, at most 4096 and none negative, make sums that differ by less
    /// than 2⁻¹⁰ of them: where the limit is farther away than that, either sum tells.
    #[inline(always)]
    fn lacks_at_most_anyway(
        threshold: f32,
        pairs: impl Iterator<Item = (f32, f32)>,
    ) -> Option<bool> {
        const ABOVE: f32 = 1.0 + 1.0 / 1024.0;
        let most = threshold + threshold;
        match twice_error(most * ABOVE, pairs) {
            None => Some(false),
            Some(error) => (error * ABOVE <= most).then_some(true),
        }
    }
}

impl Lack for i32 {
    #[inline(always)]
    fn lacks_at_most(threshold: i32, pairs: impl Iterator<Item = (i32, i32)>) -> bool {
        let mut left = threshold.unsigned_abs();
        for (residual, tap) in pairs {
            if residual < tap {
                let error = tap.abs_diff(residual);
                if error > left {
                    return false;
                }
                left -= error;
            }
        }
        true
    }

    #[inline(always)]
    fn lacks_at_most_anyway(
        threshold: i32,
        pairs: impl Iterator<Item = (i32, i32)>,
    ) -> Option<bool> {
        Some(i32::lacks_at_most(threshold, pairs))
    }
}
