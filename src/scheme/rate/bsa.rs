//! Ben's spiker (BSA): a spike where subtracting the filter brings the signal nearer to zero.

use super::Taps;
use super::decoder::{RateDecoderState, decode_rate};
use super::encoder::{RateState, Rule, rate_scheme};
use super::filtered::{Filtered, with_shift};
use crate::error::{not_negative, ratio, tri, unwrap};
use crate::num::{Bound, Nearer, Ratio, to_f64};
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Ben's spiker algorithm, as published: errors and subtraction aligned with the sample.
///
/// With `r = x - shift`, `e1 = sum |r[i+j] - h[j]|` and `e2 = sum |r[i+j]|`: a spike at `i` if
/// `e1 <= e2 - threshold` ([`subtractive`](Self::subtractive)) or `e1 <= e2 * threshold`
/// ([`multiplicative`](Self::multiplicative)); then `r[i+j] -= h[j]`. At the end of a recording both sums end with
/// its last sample.
///
/// - **Threshold:** subtractive: 0 or more, in the samples' unit. Multiplicative: 2⁻¹⁴ to 4 - 2⁻¹⁴; with samples in
///   fixed point it is rounded to a multiple of 2⁻¹⁴.
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 8` bytes a channel in `f32`.
/// - **Exactness:** `f32` adds up `e1` and `e2` separately: by rising `(i + j) mod F`, which is their order in
///   memory, and from the first tap on where the recording ends within the filter. Subtractive compares `e1 - e2`
///   with `-threshold`. Fixed point is exact within the range given in [`rate`](crate::rate).
///
/// Source: Schrauwen and Van Campenhout, BSA, 2003; paper, section II-B. The paper's own indices are
/// those of [`BsaToolbox`](super::BsaToolbox).
///
/// ```
/// use spikewire::{Scheme, Spike, rate::{Bsa, Scale, Shape, Taps}};
///
/// const TAPS: Taps<f32, 24> = Taps::shaped(Shape::Hann, Scale::Sum(1.0));
/// static LIFT: Bsa<f32, 24> = Bsa::subtractive(TAPS, 0.955);
///
/// let mut encoder = LIFT.encoder();
/// let spikes = (0..1000).filter(|_| encoder.encode(0.5) == Some(Spike::Up)).count();
/// assert!((480..520).contains(&spikes)); // the rate is the value
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Bsa<S: Sample, const F: usize> {
    filtered: Filtered<S, F>,
    limit: Limit<S>,
}

/// How [`Bsa`] compares the two errors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Criterion<S> {
    /// `e1 <= e2 - threshold`.
    Subtractive(S),
    /// `e1 <= e2 * threshold`.
    Multiplicative(f32),
}

/// A checked criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
enum Limit<S> {
    Subtractive(S),
    Multiplicative(Ratio),
}

impl<S: Sample, const F: usize> Bsa<S, F> {
    /// A scheme with these taps and this criterion. For constants, where a bad threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is out of its range, or not finite.
    pub const fn new(taps: Taps<S, F>, criterion: Criterion<S>) -> Self {
        unwrap(Self::try_new(taps, criterion))
    }

    /// A scheme with these taps and this criterion.
    ///
    /// # Errors
    /// Returns an error if the threshold is out of its range, or not finite.
    pub const fn try_new(taps: Taps<S, F>, criterion: Criterion<S>) -> Result<Self, ConfigError> {
        let (checked, limit) = match criterion {
            Criterion::Subtractive(threshold) => {
                (not_negative("threshold", to_f64(threshold)), Limit::Subtractive(threshold))
            }
            Criterion::Multiplicative(threshold) => {
                (ratio("threshold", threshold), Limit::Multiplicative(Ratio::new(threshold)))
            }
        };
        tri!(checked);
        Ok(Self { filtered: Filtered::new(taps), limit })
    }

    /// A scheme that spikes if `e1 <= e2 - threshold`. For constants, where a bad threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is negative or not finite.
    pub const fn subtractive(taps: Taps<S, F>, threshold: S) -> Self {
        unwrap(Self::try_subtractive(taps, threshold))
    }

    /// A scheme that spikes if `e1 <= e2 - threshold`.
    ///
    /// # Errors
    /// Returns an error if the threshold is negative or not finite.
    pub const fn try_subtractive(taps: Taps<S, F>, threshold: S) -> Result<Self, ConfigError> {
        Self::try_new(taps, Criterion::Subtractive(threshold))
    }

    /// A scheme that spikes if `e1 <= e2 * threshold`. For constants, where a bad threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not within 2⁻¹⁴ to 4 - 2⁻¹⁴.
    pub const fn multiplicative(taps: Taps<S, F>, threshold: f32) -> Self {
        unwrap(Self::try_multiplicative(taps, threshold))
    }

    /// A scheme that spikes if `e1 <= e2 * threshold`.
    ///
    /// # Errors
    /// Returns an error if the threshold is not within 2⁻¹⁴ to 4 - 2⁻¹⁴.
    pub const fn try_multiplicative(taps: Taps<S, F>, threshold: f32) -> Result<Self, ConfigError> {
        Self::try_new(taps, Criterion::Multiplicative(threshold))
    }

    with_shift!();

    /// How it compares the two errors.
    pub const fn criterion(&self) -> Criterion<S> {
        match self.limit {
            Limit::Subtractive(threshold) => Criterion::Subtractive(threshold),
            Limit::Multiplicative(ratio) => Criterion::Multiplicative(ratio.factor()),
        }
    }
}

/// The error with the filter subtracted is smaller than without it, by the criterion.
impl<S: Sample, const F: usize> Rule<S, F> for Bsa<S, F> {
    const IN_ORDER: bool = false;
    const KEEPS_A_SUM: bool = true;

    fn fingerprint(&self) -> Fingerprint {
        let name = Fingerprint::new("Bsa");
        match self.limit {
            Limit::Subtractive(threshold) => name.number(0).sample(threshold),
            Limit::Multiplicative(ratio) => name.number(1).sample(ratio.factor()),
        }
    }

    #[inline(always)]
    fn filtered(&self) -> &Filtered<S, F> {
        &self.filtered
    }

    #[inline(always)]
    fn fits(
        &self,
        magnitude: impl FnOnce() -> S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
        _: bool,
    ) -> bool {
        let bound = match self.limit {
            Limit::Subtractive(threshold) => Bound::Less(threshold.widen()),
            Limit::Multiplicative(ratio) => Bound::Part(ratio),
        };
        S::Residual::is_nearer(bound, S::SHORT, magnitude(), pairs)
    }
}

rate_scheme!(Bsa);

#[cfg(feature = "serde")]
super::filtered::serialize_filtered!(Bsa, "criterion", limit);
