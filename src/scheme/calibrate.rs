//! Calibration: minimum, maximum and differences of a signal, from which thresholds and shifts follow.

use crate::error::finite;
use crate::{ConfigError, Sample};

/// Minimum, maximum and statistics of the differences of a signal, taken one sample at a time. The paper takes
/// them from a whole recording.
///
/// - **Work:** sums are in double precision, which most flight controllers compute in software: calibrate before
///   arming.
/// - **Range:** the first 2³²-1 finite samples, 49 days at 1 kHz. Later ones are only [counted](Self::ignored), so
///   that every result is that of the samples [seen](Self::seen).
/// - **Rejected samples:** a sample that is not finite is only [counted](Self::rejected).
/// - **Memory:** 48 bytes in `f32`.
///
/// ```
/// use spikewire::{Calibration, temporal::TemporalContrast};
///
/// let mut calibration = Calibration::<f32>::new();
/// for x in [0.0, 1.0, 0.5, 2.0] {
///     calibration.observe(x);
/// }
/// assert_eq!((calibration.min(), calibration.max()), (Some(0.0), Some(2.0)));
/// assert!(TemporalContrast::from_calibration(&calibration, 0.5).is_ok());
///
/// let mut falling = Calibration::<f32>::new();
/// for x in [3.0, 2.0, 1.0, 0.0] {
///     falling.observe(x);
/// }
/// let error = TemporalContrast::from_calibration(&falling, 1.0).unwrap_err();
/// assert_eq!(error.to_string(), "threshold -1 must be above 0 and finite");
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Calibration<S> {
    previous: S,
    min: S,
    max: S,
    seen: u32,
    ignored: u32,
    rejected: u32,
    sum: f64,
    sum_of_magnitudes: f64,
    sum_of_squares: f64,
}

/// Mean and standard deviation of the differences between successive samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Differences {
    /// The mean, in the samples' unit.
    pub mean: f64,
    /// The standard deviation, over `n - 1` for `n` differences, in the samples' unit.
    pub deviation: f64,
}

impl Differences {
    /// `mean + factor * deviation`.
    ///
    /// # Errors
    /// Returns an error if the factor is not finite.
    pub fn threshold(&self, factor: f32) -> Result<f64, ConfigError> {
        let factor = f64::from(factor);
        finite("factor", factor)?;
        Ok(self.mean + factor * self.deviation)
    }

    fn from_sums(count: u32, sum: f64, sum_of_squares: f64) -> Self {
        let count = f64::from(count);
        let mean = sum / count;
        let variance = (sum_of_squares - sum * mean) / (count - 1.0);
        Self { mean, deviation: libm::sqrt(variance.max(0.0)) }
    }
}

impl<S: Sample> Default for Calibration<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Sample> Calibration<S> {
    /// A calibration before its first sample.
    pub const fn new() -> Self {
        Self {
            previous: S::ZERO,
            min: S::ZERO,
            max: S::ZERO,
            seen: 0,
            ignored: 0,
            rejected: 0,
            sum: 0.0,
            sum_of_magnitudes: 0.0,
            sum_of_squares: 0.0,
        }
    }

    /// Adds one sample to the statistics.
    pub fn observe(&mut self, sample: S) {
        if !sample.is_finite() {
            self.rejected = self.rejected.saturating_add(1);
            return;
        }
        let Some(seen) = self.seen.checked_add(1) else {
            self.ignored = self.ignored.saturating_add(1);
            return;
        };
        if self.seen == 0 {
            self.min = sample;
            self.max = sample;
        } else {
            let difference = sample.to_f64() - self.previous.to_f64();
            self.sum += difference;
            self.sum_of_magnitudes += difference.abs();
            self.sum_of_squares += difference * difference;
        }
        if sample < self.min {
            self.min = sample;
        }
        if sample > self.max {
            self.max = sample;
        }
        self.previous = sample;
        self.seen = seen;
    }

    /// The smallest sample: the `shift` of the rate codes. `None` before the first.
    pub fn min(&self) -> Option<S> {
        (self.seen > 0).then_some(self.min)
    }

    /// The largest sample. `None` before the first.
    pub fn max(&self) -> Option<S> {
        (self.seen > 0).then_some(self.max)
    }

    /// How many finite samples the results are taken from, up to 2³²-1.
    pub fn seen(&self) -> u32 {
        self.seen
    }

    /// How many finite samples came after the first 2³²-1 and are left out; up to 2³²-1.
    pub fn ignored(&self) -> u32 {
        self.ignored
    }

    /// How many samples were not finite, up to 2³²-1.
    pub fn rejected(&self) -> u32 {
        self.rejected
    }

    /// Mean and standard deviation of `x[i] - x[i-1]`.
    ///
    /// # Errors
    /// Returns an error if there are fewer than three samples.
    pub fn differences(&self) -> Result<Differences, ConfigError> {
        Ok(Differences::from_sums(self.count()?, self.sum, self.sum_of_squares))
    }

    /// Mean and standard deviation of `|x[i] - x[i-1]|`.
    ///
    /// # Errors
    /// Returns an error if there are fewer than three samples.
    pub fn magnitudes(&self) -> Result<Differences, ConfigError> {
        Ok(Differences::from_sums(self.count()?, self.sum_of_magnitudes, self.sum_of_squares))
    }

    fn count(&self) -> Result<u32, ConfigError> {
        const NEEDED: u32 = 3;
        if self.seen < NEEDED {
            return Err(ConfigError::TooFewSamples { seen: self.seen, needed: NEEDED });
        }
        Ok(self.seen - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::{Calibration, Differences};

    /// A calibration of a signal that rises and falls by 10, as it is after this many samples.
    fn after(seen: u32) -> Calibration<f32> {
        let differences = f64::from(seen - 1);
        Calibration {
            previous: 0.0,
            min: 0.0,
            max: 10.0,
            seen,
            ignored: 0,
            rejected: 0,
            sum: 0.0,
            sum_of_magnitudes: 10.0 * differences,
            sum_of_squares: 100.0 * differences,
        }
    }

    #[test]
    fn the_means_stay_where_the_count_ends() {
        let mut calibration = after(u32::MAX - 2);
        for (sample, seen, ignored) in [
            (10.0, u32::MAX - 1, 0),
            (0.0, u32::MAX, 0),
            (10.0, u32::MAX, 1),
            (f32::NAN, u32::MAX, 1),
            (1e9, u32::MAX, 2),
            (-1e9, u32::MAX, 3),
        ] {
            calibration.observe(sample);
            assert_eq!((calibration.seen(), calibration.ignored()), (seen, ignored), "{sample}");
            let expected = Differences { mean: 10.0, deviation: 0.0 };
            assert_eq!(calibration.magnitudes(), Ok(expected), "{sample}");
            let is_level = calibration.differences().is_ok_and(|level| level.mean.abs() < 1e-8);
            assert!(is_level, "{sample}");
            assert_eq!((calibration.min(), calibration.max()), (Some(0.0), Some(10.0)));
        }
        assert_eq!(calibration.rejected(), 1);
        calibration.ignored = u32::MAX;
        calibration.observe(0.0);
        assert_eq!(calibration.ignored(), u32::MAX);
    }
}
