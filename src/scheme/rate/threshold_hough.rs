//! Threshold Hough spiker (T-HSA): a spike where the filter exceeds the signal by a threshold at most.

use super::Taps;
use super::decoder::{RateDecoderState, decode_rate};
use super::encoder::{RateState, Rule, rate_scheme};
use super::filtered::{Filtered, with_shift};
use crate::error::{not_negative, tri, unwrap};
use crate::num::{Shortfall, to_f64};
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// The threshold Hough spike algorithm (T-HSA).
///
/// With the signal `x`, the taps `h`, `r = x - shift` and `error = sum over j of max(0, h[j] - r[i+j])`: a spike at
/// `i` if `error <= threshold`; then `r[i+j] -= h[j]`. Samples past the end of a recording add no error, so that a
/// tail of zeros can spike.
///
/// - **Threshold:** 0 or more, in the samples' unit; 0 makes it [`Hough`](super::Hough).
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 8` bytes a channel in `f32`, and `16 F` of residuals on the
///   stack for slices, at most 432 bytes of stack in all with 15 taps on a Cortex-M4F.
/// - **Exactness:** `f32` sums `|r - h| - (r - h)`, which is twice the error, first tap first, and
///   compares with twice the threshold. Fixed point is exact within the range of
///   [`rate`](crate::rate).
///
/// Source: paper, section II-B, algorithm 4 (where `input >= filter` is a slip for `<`).
///
/// ```
/// use spikewire::{Scheme, Spike, rate::{Taps, ThresholdHough}};
///
/// static LIFT: ThresholdHough<f32, 3> = ThresholdHough::new(Taps::triangular(1.0), 0.25); // 0.5, 1, 0.5
///
/// let mut encoder = LIFT.encoder();
/// let spikes = [0.5, 0.75, 0.5, 0.0].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [None, None, Some(Spike::Up), Some(Spike::None)]);
/// assert!(encoder.finish().eq([Spike::None, Spike::None]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThresholdHough<S: Sample, const F: usize> {
    filtered: Filtered<S, F>,
    threshold: S,
}

impl<S: Sample, const F: usize> ThresholdHough<S, F> {
    /// A scheme with these taps and this threshold. For constants, where a bad threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is negative or not finite.
    pub const fn new(taps: Taps<S, F>, threshold: S) -> Self {
        unwrap(Self::try_new(taps, threshold))
    }

    /// A scheme with these taps and this threshold.
    ///
    /// # Errors
    /// Returns an error if the threshold is negative or not finite.
    pub const fn try_new(taps: Taps<S, F>, threshold: S) -> Result<Self, ConfigError> {
        tri!(not_negative("threshold", to_f64(threshold)));
        Ok(Self { filtered: Filtered::new(taps), threshold })
    }

    with_shift!();

    /// The largest error at which a sample spikes, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }
}

/// A sample spikes if the residuals fall short of their taps by the threshold at most.
impl<S: Sample, const F: usize> Rule<S, F> for ThresholdHough<S, F> {
    const IN_ORDER: bool = true;
    const KEEPS_A_SUM: bool = true;

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("ThresholdHough").sample(self.threshold)
    }

    #[inline(always)]
    fn filtered(&self) -> &Filtered<S, F> {
        &self.filtered
    }

    #[inline(always)]
    fn fits(
        &self,
        _: impl FnOnce() -> S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
        _: bool,
    ) -> bool {
        S::Residual::falls_short_by_at_most(self.threshold.widen(), pairs)
    }

    #[inline(always)]
    fn fits_by_slot(
        &self,
        _: impl FnOnce() -> S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
    ) -> Option<bool> {
        S::Residual::falls_short_in_any_order(self.threshold.widen(), pairs)
    }
}

rate_scheme!(ThresholdHough);

#[cfg(feature = "serde")]
super::filtered::serialize_filtered!(ThresholdHough, "threshold", threshold);
