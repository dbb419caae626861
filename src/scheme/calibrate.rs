//! What a scheme needs to know about a signal before it flies.

use crate::error::finite;
use crate::{ConfigError, Sample};

/// Watches a signal one sample at a time and gives the quantities that the paper takes from a whole
/// recording.
///
/// Sums are taken in double precision, in software where the core has no such unit: run it before
/// arming. A sample that is not finite is counted and ignored. Memory: 48 bytes in `f32`.
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
    /// The standard deviation with N-1, in the samples' unit.
    pub deviation: f64,
}

impl Differences {
    /// `mean + factor * deviation`.
    ///
    /// # Errors
    /// The factor is not finite.
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
    /// A calibration that has seen nothing.
    pub fn new() -> Self {
        Self {
            previous: S::ZERO,
            min: S::ZERO,
            max: S::ZERO,
            seen: 0,
            rejected: 0,
            sum: 0.0,
            sum_of_magnitudes: 0.0,
            sum_of_squares: 0.0,
        }
    }

    /// Takes one sample.
    pub fn observe(&mut self, sample: S) {
        if !sample.is_finite() {
            self.rejected = self.rejected.saturating_add(1);
            return;
        }
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
        self.seen = self.seen.saturating_add(1);
    }

    /// The smallest sample: the `shift` of the rate codes. `None` before the first.
    pub fn min(&self) -> Option<S> {
        (self.seen > 0).then_some(self.min)
    }

    /// The largest sample. `None` before the first.
    pub fn max(&self) -> Option<S> {
        (self.seen > 0).then_some(self.max)
    }

    /// How many finite samples it has seen.
    pub fn seen(&self) -> u32 {
        self.seen
    }

    /// How many samples were not finite.
    pub fn rejected(&self) -> u32 {
        self.rejected
    }

    /// Mean and deviation of `x[i] - x[i-1]`.
    ///
    /// # Errors
    /// Fewer than three samples.
    pub fn differences(&self) -> Result<Differences, ConfigError> {
        Ok(Differences::from_sums(self.count()?, self.sum, self.sum_of_squares))
    }

    /// Mean and deviation of `|x[i] - x[i-1]|`.
    ///
    /// # Errors
    /// Fewer than three samples.
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
