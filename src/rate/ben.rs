//! Ben's spiker (BSA): a spike where subtracting the filter brings the signal nearer to zero.

use super::decoder::RateDecoder;
use super::encoder::{RateEncoder, Rule};
use super::filter::Taps;
use super::residual::Residual;
use crate::error::{checked, not_negative, offset, ratio};
use crate::sample::for_each_sample;
use crate::{ConfigError, Sample, Scheme};

/// Ben's spiker algorithm, as published: errors and subtraction aligned with the sample.
///
/// With `r = x - shift`, `e1 = sum |r[i+j] - h[j]|` and `e2 = sum |r[i+j]|`: a spike at `i` if
/// `e1 <= e2 - threshold` ([`subtractive`](Self::subtractive)) or `e1 <= e2 * threshold`
/// ([`multiplicative`](Self::multiplicative)); then `r[i+j] -= h[j]`. At the end of a recording both
/// sums are cut to what is left.
///
/// - **Threshold:** subtractive: 0 or more, in the samples' unit. Multiplicative: above 0 and below
///   4; with samples in fixed point it is rounded to a multiple of 2⁻¹⁴.
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 24` bytes an encoder in `f32`; the taps are
///   in flash, shared.
/// - **Exactness:** `f32` sums `e1` and `e2` apart, by rising `(i + j) mod F` over a whole window
///   (which is how it lies in memory), first tap first over a cut one; subtractive compares
///   `e1 - e2` with `-threshold`. Fixed point is exact within the range of [`rate`](crate::rate).
///
/// Source: Schrauwen and Van Campenhout, BSA, 2003; paper, section II-B. The paper's own indices are
/// those of [`BenToolbox`](super::BenToolbox).
///
/// ```
/// use spikewire::{Encoder, Scheme, Spike, rate::{Ben, Scale, Shape, Taps}};
///
/// static TAPS: Taps<f32, 24> = Taps::<f32, _>::checked_shape(Shape::Hann, Scale::Sum(1.0));
/// const LIFT: Ben<f32, 24> = Ben::<f32, _>::checked_subtractive(&TAPS, 0.955);
///
/// let mut encoder = LIFT.encoder();
/// let spikes = (0..1000).filter(|_| encoder.encode(0.5) == Some(Spike::Up)).count();
/// assert!((480..520).contains(&spikes)); // the rate is the value
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Ben<'a, S, const F: usize> {
    taps: &'a Taps<S, F>,
    criterion: Criterion<S>,
    shift: S,
}

/// What [`Ben`] compares the two errors by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Criterion<S> {
    /// `e1 <= e2 - threshold`.
    Subtractive(S),
    /// `e1 <= e2 * threshold`.
    Multiplicative(f32),
}

impl<'a, S: Sample, const F: usize> Ben<'a, S, F> {
    /// A scheme for signals whose minimum is 0, with either criterion.
    ///
    /// # Errors
    /// The threshold is out of its range, or not finite.
    pub fn new(taps: &'a Taps<S, F>, criterion: Criterion<S>) -> Result<Self, ConfigError> {
        match criterion {
            Criterion::Subtractive(threshold) => not_negative("threshold", threshold.to_f64())?,
            Criterion::Multiplicative(threshold) => ratio("threshold", threshold)?,
        }
        Ok(Self { taps, criterion, shift: S::ZERO })
    }

    /// `e1 <= e2 - threshold`.
    ///
    /// # Errors
    /// The threshold is negative or not finite.
    pub fn subtractive(taps: &'a Taps<S, F>, threshold: S) -> Result<Self, ConfigError> {
        Self::new(taps, Criterion::Subtractive(threshold))
    }

    /// `e1 <= e2 * threshold`.
    ///
    /// # Errors
    /// The threshold is not above 0 and below 4.
    pub fn multiplicative(taps: &'a Taps<S, F>, threshold: f32) -> Result<Self, ConfigError> {
        Self::new(taps, Criterion::Multiplicative(threshold))
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
        impl<'a, const F: usize, $($generics)*> Ben<'a, $sample, F> {
            /// For constants: `e1 <= e2 - threshold`. A negative threshold fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked_subtractive(taps: &'a Taps<$sample, F>, threshold: $sample) -> Self {
                checked!(not_negative("threshold", $to_f64(threshold)));
                Self { taps, criterion: Criterion::Subtractive(threshold), shift: $nearest(0.0) }
            }

            /// For constants: `e1 <= e2 * threshold`. A threshold that is not above 0 and below 4
            /// fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked_multiplicative(taps: &'a Taps<$sample, F>, threshold: f32) -> Self {
                checked!(ratio("threshold", threshold));
                Self { taps, criterion: Criterion::Multiplicative(threshold), shift: $nearest(0.0) }
            }
        }
    };
}
for_each_sample!(constants);

impl<'a, S: Sample, const F: usize> Scheme for Ben<'a, S, F> {
    type Sample = S;
    type Encoder = RateEncoder<'a, S, BenRule<S::Residual>, F>;
    type Decoder = RateDecoder<'a, S, F>;

    const LATENCY: usize = F - 1;

    fn encoder(self) -> Self::Encoder {
        let rule = match self.criterion {
            Criterion::Subtractive(threshold) => {
                let taps = self.taps.as_array().iter().map(|tap| tap.widen());
                BenRule::Subtractive(S::Residual::limit(threshold.widen(), taps))
            }
            Criterion::Multiplicative(threshold) => {
                BenRule::Multiplicative(S::Residual::ratio(threshold))
            }
        };
        RateEncoder::new(self.taps, self.shift, rule)
    }

    fn decoder(self) -> Self::Decoder {
        RateDecoder::new(self.taps, self.shift)
    }
}

/// The error with the filter subtracted is smaller than without, by the criterion.
#[derive(Clone, Copy, Debug)]
pub enum BenRule<R: Residual> {
    /// Within this limit, as [`Nearer::limit`] has it.
    Subtractive(R),
    /// At most this part.
    Multiplicative(R::Ratio),
}

impl<R: Residual> Rule<R> for BenRule<R> {
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn fits(&self, pairs: impl Iterator<Item = (R, R)>, _: bool) -> bool {
        R::is_nearer(self, pairs)
    }

    #[inline(always)]
    fn fits_by_slot(&self, pairs: impl Iterator<Item = (R, R)>) -> Option<bool> {
        Some(R::is_nearer(self, pairs))
    }

    fn cut(self, absent: impl Iterator<Item = R>) -> Self {
        match self {
            Self::Subtractive(limit) => Self::Subtractive(R::cut(limit, absent)),
            Self::Multiplicative(ratio) => Self::Multiplicative(ratio),
        }
    }
}

/// Compares residuals with and without their taps. Sealed: only this crate can name it.
pub trait Nearer: Sized {
    /// What the subtractive criterion compares with.
    fn limit(threshold: Self, taps: impl Iterator<Item = Self>) -> Self;

    /// The limit for windows without these taps.
    fn cut(limit: Self, absent: impl Iterator<Item = Self>) -> Self;

    /// Whether the taps bring the residuals nearer to zero, by the criterion.
    fn is_nearer(rule: &BenRule<Self>, pairs: impl Iterator<Item = (Self, Self)>) -> bool
    where
        Self: Residual;
}

impl Nearer for f32 {
    /// Of `e1 - e2`.
    fn limit(threshold: f32, _: impl Iterator<Item = f32>) -> f32 {
        -threshold
    }

    fn cut(limit: f32, _: impl Iterator<Item = f32>) -> f32 {
        limit
    }

    #[inline(always)]
    fn is_nearer(rule: &BenRule<f32>, pairs: impl Iterator<Item = (f32, f32)>) -> bool {
        let (mut with, mut without) = (0.0, 0.0);
        for (residual, tap) in pairs {
            with += (residual - tap).abs();
            without += residual.abs();
        }
        match *rule {
            BenRule::Subtractive(limit) => with - without <= limit,
            BenRule::Multiplicative(ratio) => with <= without * ratio,
        }
    }
}

impl Nearer for i32 {
    /// Of `e1 - e2 + sum |h|`, which no pair makes smaller: it tells as soon as it is passed.
    fn limit(threshold: i32, taps: impl Iterator<Item = i32>) -> i32 {
        taps.fold(threshold.wrapping_neg(), |limit, tap| limit.wrapping_add(tap.wrapping_abs()))
    }

    fn cut(limit: i32, absent: impl Iterator<Item = i32>) -> i32 {
        absent.fold(limit, |limit, tap| limit.wrapping_sub(tap.wrapping_abs()))
    }

    #[inline(always)]
    fn is_nearer(rule: &BenRule<i32>, pairs: impl Iterator<Item = (i32, i32)>) -> bool {
        match *rule {
            // For a tap of 0 or more, `|r-h| - |r| + |h|` is twice what r, if positive, lacks to it.
            BenRule::Subtractive(limit) => {
                let mut left = limit >> 1;
                for (residual, tap) in pairs {
                    // As `tap >= 0 && residual >= tap`.
                    if residual.wrapping_sub(tap) | tap >= 0 {
                        continue;
                    }
                    let residual = if tap < 0 { residual.wrapping_neg() } else { residual };
                    let lack = tap.wrapping_abs().wrapping_sub(residual.max(0));
                    left = left.wrapping_sub(lack.max(0));
                    if left < 0 {
                        return false;
                    }
                }
                left >= 0
            }
            BenRule::Multiplicative(ratio) => {
                let (mut with, mut without) = (i32::no_sum(), i32::no_sum());
                for (residual, tap) in pairs {
                    with = residual.add_distance(tap, with);
                    without = residual.add_distance(0, without);
                }
                i32::at_most(with, without, ratio)
            }
        }
    }
}
