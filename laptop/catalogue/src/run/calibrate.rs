//! The figures that a scheme takes from a whole recording, in any sample type.

use super::SampleType;
use super::quantiles::Quantiles;
use crate::for_sample_type;
use spikewire::temporal::TemporalContrast;
use spikewire::{Calibration, ConfigError, Sample};

/// A calibration in the recording's unit.
pub struct Calibrated {
    calibration: Box<dyn Calibrate + Send + Sync>,
    quantiles: Quantiles,
    /// The value of 1 in the unit of the calibration.
    one: f64,
}

impl Calibrated {
    /// A calibration that has seen nothing.
    pub fn new(sample: SampleType) -> Self {
        let calibration: Box<dyn Calibrate + Send + Sync> =
            for_sample_type!(sample, S => Box::new(Calibration::<S>::new()));
        Self { calibration, quantiles: Quantiles::new(), one: sample.one() }
    }

    /// Takes the next samples, all finite.
    pub fn observe(&mut self, samples: &[f64]) {
        for sample in samples {
            self.calibration.observe(sample * self.one);
            self.quantiles.observe(*sample);
        }
    }

    /// The smallest and the largest sample, if there was one.
    pub fn range(&self) -> Option<(f64, f64)> {
        self.calibration.range().map(|(min, max)| (min / self.one, max / self.one))
    }

    /// This many quantiles `(2i + 1) / 2M`, dense where the samples are; `None` before the first sample.
    pub fn quantiles(&self, count: usize) -> Option<Vec<f64>> {
        let part = |i: usize| (2 * i + 1) as f64 / (2 * count) as f64;
        (0..count).map(|i| self.quantiles.quantile(part(i))).collect()
    }

    /// The threshold of temporal contrast, from the differences or from their magnitudes.
    ///
    /// # Errors
    /// Too few samples, or a threshold that is not above 0.
    pub fn threshold(&self, factor: f64, of_magnitudes: bool) -> Result<f64, ConfigError> {
        Ok(self.calibration.threshold(factor as f32, of_magnitudes)? / self.one)
    }
}

/// The crate's calibration, in any sample type.
trait Calibrate {
    fn observe(&mut self, sample: f64);
    fn range(&self) -> Option<(f64, f64)>;
    fn threshold(&self, factor: f32, of_magnitudes: bool) -> Result<f64, ConfigError>;
}

impl<S: Sample> Calibrate for Calibration<S> {
    fn observe(&mut self, sample: f64) {
        Self::observe(self, S::from_f64(sample));
    }

    fn range(&self) -> Option<(f64, f64)> {
        Some((self.min()?.to_f64(), self.max()?.to_f64()))
    }

    fn threshold(&self, factor: f32, of_magnitudes: bool) -> Result<f64, ConfigError> {
        let scheme = if of_magnitudes {
            TemporalContrast::from_magnitudes(self, factor)
        } else {
            TemporalContrast::from_calibration(self, factor)
        };
        Ok(scheme?.threshold().to_f64())
    }
}
