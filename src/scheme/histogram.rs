//! Histogram of a signal, and its quantiles, which may become the centres of a population.

use core::ops::RangeInclusive;

use crate::error::{self, not_rising, tri, unwrap, within};
use crate::num::{from_f64, to_f64};
use crate::{ConfigError, Sample};

/// Counts a signal's samples in `B` even cells of a range and gives its quantiles.
///
/// A sample adds 1 to its cell. When the counts add up to the limit, every count is halved and rounded down:
/// the past fades, so that the quantiles follow a signal that changes. Within a quantile's cell the values are
/// taken to be spread evenly, and every cell counts once more than it has samples, so that a quantile moves on
/// from an empty cell, too.
///
/// - **B:** 1 to 1024 cells. **Limit:** 1 to 65 535 samples. **Range:** `min < max`, in the samples' unit; a
///   sample outside counts in the cell at that end.
/// - **Memory:** `2 B` bytes for the counts, and 32 in `f32`.
/// - **Work:** a sample takes a few multiplications in double precision, in software where the core has no such
///   unit, and no division; one in about half the limit halves `B` counts. Run it before arming, or with a
///   keyframe.
/// - **Exactness:** counts are exact in fixed point, and depend on the order of the samples by the halvings alone. A
///   quantile is computed in double precision and rounded to the nearest sample, halves upwards.
/// - **Rejected samples:** a sample that is not finite is counted and changes nothing.
///
/// ```
/// use spikewire::Histogram;
///
/// let mut roll = Histogram::<i16, 8>::new(-400..=400, 1000);
/// for sample in [-60, -20, 5, 8, 15, 40, 170] {
///     roll.observe(sample);
/// }
/// assert_eq!(roll.counts(), &[0, 0, 0, 2, 4, 1, 0, 0]);
/// assert_eq!(roll.quantile(1, 2), Some(30)); // the median
/// let centres: [i16; 5] = roll.centres()?;
/// assert!(centres.is_sorted());
/// # Ok::<(), spikewire::ConfigError>(())
/// ```
///
/// A histogram without cells does not compile:
///
/// ```compile_fail
/// # use spikewire::Histogram;
/// const ROLL: Histogram<i16, 0> = Histogram::new(-400..=400, 1000);
/// # let _ = &ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct Histogram<S: Sample, const B: usize> {
    min: S,
    max: S,
    limit: u16,
    /// The sum of the counts: below the limit.
    total: u16,
    /// Cells per unit of the samples.
    #[cfg_attr(feature = "serde", serde(skip))]
    scale: f64,
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array::serialize"))]
    counts: [u16; B],
    seen: u32,
    rejected: u32,
}

impl<S: Sample, const B: usize> Histogram<S, B> {
    const SHAPE: () = assert!(B >= 1 && B <= 1024, "a histogram has 1 to 1024 cells");

    /// An empty histogram. For constants, where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, limit: u16) -> Self {
        unwrap(Self::try_new(range, limit))
    }

    /// An empty histogram.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise; the limit is 0.
    pub const fn try_new(range: RangeInclusive<S>, limit: u16) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let (min, max) = (*range.start(), *range.end());
        tri!(error::range(to_f64(min), to_f64(max)));
        tri!(within("limit", limit as f64, 1.0, u16::MAX as f32));
        Ok(Self::over([min, max], limit))
    }

    /// An empty histogram of checked parameters.
    pub(super) const fn over([min, max]: [S; 2], limit: u16) -> Self {
        let scale = B as f64 / (to_f64(max) - to_f64(min));
        Self { min, max, limit, total: 0, scale, counts: [0; B], seen: 0, rejected: 0 }
    }

    /// Takes one sample.
    pub fn observe(&mut self, sample: S) {
        if !sample.is_finite() {
            self.rejected = self.rejected.saturating_add(1);
            return;
        }
        self.seen = self.seen.saturating_add(1);
        let cell = self.cell(sample);
        if let Some(count) = self.counts.get_mut(cell) {
            *count = count.saturating_add(1);
            self.total = self.total.saturating_add(1);
        }
        if self.total >= self.limit {
            self.total = 0;
            for count in &mut self.counts {
                *count >>= 1;
                self.total = self.total.saturating_add(*count);
            }
        }
    }

    /// The cell of a finite sample: `B (x - min) / (max - min)`, rounded down, at most `B - 1`.
    fn cell(&self, sample: S) -> usize {
        if sample <= self.min {
            return 0;
        }
        if sample >= self.max {
            return B - 1;
        }
        let above = sample.to_f64() - self.min.to_f64();
        let (range, cells) = (self.max.to_f64() - self.min.to_f64(), B as f64);
        // The product with a rounded scale may be in a neighbour at a border: whole numbers decide.
        let near = (above * self.scale) as usize;
        let (border, next) = (near as f64 * range, (near as f64 + 1.0) * range);
        if above * cells < border {
            near.saturating_sub(1)
        } else if above * cells >= next {
            near.saturating_add(1).min(B - 1)
        } else {
            near.min(B - 1)
        }
    }

    /// How many samples each cell holds after the halvings, the lowest first.
    pub const fn counts(&self) -> &[u16; B] {
        &self.counts
    }

    /// How many finite samples it has taken, up to 2³²-1.
    pub const fn seen(&self) -> u32 {
        self.seen
    }

    /// How many samples were not finite, up to 2³²-1.
    pub const fn rejected(&self) -> u32 {
        self.rejected
    }

    /// Forgets every sample, and the count of rejected ones.
    pub fn reset(&mut self) {
        *self = Self { total: 0, counts: [0; B], seen: 0, rejected: 0, ..*self };
    }

    /// The value below which this part of the samples lies: `quantile(1, 2)` is the median. `None` unless
    /// `numerator <= denominator` and the denominator is above 0.
    ///
    /// One pass over the counts, and a few divisions.
    pub fn quantile(&self, numerator: u16, denominator: u16) -> Option<S> {
        if numerator > denominator || denominator == 0 {
            return None;
        }
        let (numerator, denominator) = (u64::from(numerator), u64::from(denominator));
        let total = u64::from(self.total).saturating_add(B as u64);
        let wanted = numerator.saturating_mul(total);
        let mut below = 0;
        for (cell, &count) in self.counts.iter().enumerate() {
            let weight = u64::from(count).saturating_add(1).saturating_mul(denominator);
            let rest = wanted.saturating_sub(below);
            if rest <= weight {
                let (min, max) = (self.min.to_f64(), self.max.to_f64());
                let cells = cell as f64 + rest as f64 / weight as f64;
                return Some(from_f64(min + (max - min) * cells / B as f64));
            }
            below = below.saturating_add(weight);
        }
        Some(self.max)
    }

    /// The quantiles `(2i + 1) / 2M`: centres of a population, dense where the samples are.
    ///
    /// # Errors
    /// Returns an error if two are alike in the sample type.
    pub fn centres<const M: usize>(&self) -> Result<[S; M], ConfigError> {
        const { assert!(M >= 1 && M <= 1024, "a population takes up to 1024 neurons") };
        let mut centres = [S::ZERO; M];
        self.write_centres(&mut centres)?;
        Ok(centres)
    }

    /// Fills `centres` with the [`centres`](Self::centres) of as many neurons as it has room for, 1 to 1024.
    ///
    /// # Errors
    /// Returns an error if two are alike in the sample type, or there is room for none or for more than 1024.
    pub fn write_centres(&self, centres: &mut [S]) -> Result<(), ConfigError> {
        within("neurons", centres.len() as f64, 1.0, 1024.0)?;
        let parts = 2 * centres.len() as u16;
        let mut before = None;
        for (i, centre) in centres.iter_mut().enumerate() {
            *centre = self.quantile(2 * i as u16 + 1, parts).unwrap_or(self.max);
            let value = centre.to_f64();
            if let Some(below) = before.filter(|&below| value <= below) {
                return Err(not_rising("centres", i, value, below));
            }
            before = Some(value);
        }
        Ok(())
    }
}
