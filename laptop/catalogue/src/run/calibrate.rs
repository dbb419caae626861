//! Calibrates a scheme on a whole recording, in any sample type.

use std::any::TypeId;

use bytemuck::{Pod, cast_slice};

use super::quantiles::Quantiles;
use super::unordered::Unordered;
use super::{Asked, SampleType, Samples};
use crate::for_sample_type;
use spikewire::temporal::TemporalContrast;
use spikewire::{Calibration, ConfigError, Sample};

/// A calibration in the unit of the recording.
pub struct Calibrated {
    calibration: Box<dyn Calibrate + Send + Sync>,
    quantiles: Option<Quantiles>,
    /// The number that represents 1 in the unit of the calibration.
    one: f64,
}

impl Calibrated {
    /// Starts a calibration without samples.
    pub fn new(sample: SampleType) -> Self {
        Self { quantiles: Some(Quantiles::new()), ..Self::without_quantiles(sample) }
    }

    /// Starts a calibration for these parameters alone, which takes less work where they need no quantiles.
    pub fn of(sample: SampleType, asked: &Asked) -> Self {
        let needs_quantiles = asked.word("centres") == Some("quantiles");
        if needs_quantiles { Self::new(sample) } else { Self::without_quantiles(sample) }
    }

    /// Starts a calibration like that of [`of`](Self::of) for samples in `f32`, with several sums side by side, which
    /// takes less time. [`range`](Self::range) and [`threshold`](Self::threshold) are `None` where the order of the
    /// samples might change them.
    pub fn unordered(asked: &Asked) -> Self {
        Self { calibration: Box::new(Unordered::new()), ..Self::of(SampleType::F32, asked) }
    }

    fn without_quantiles(sample: SampleType) -> Self {
        let calibration: Box<dyn Calibrate + Send + Sync> =
            for_sample_type!(sample, S => Box::new(Calibration::<S>::new()));
        Self { calibration, quantiles: None, one: sample.one() }
    }

    /// Adds the next samples, which must be finite.
    pub fn observe(&mut self, samples: &[f64]) {
        self.observe_samples(Samples::F64(samples));
    }

    /// Adds the next samples, which must be finite, of any type.
    pub fn observe_samples(&mut self, samples: Samples) {
        self.calibration.observe(samples, self.one);
        let Some(quantiles) = &mut self.quantiles else { return };
        match samples {
            Samples::F32(own) => own.iter().for_each(|own| quantiles.observe((*own).into())),
            Samples::F64(own) => own.iter().for_each(|own| quantiles.observe(*own)),
            Samples::I16(own) => own.iter().for_each(|own| quantiles.observe((*own).into())),
        }
    }

    /// Returns the smallest and the largest sample; `None` without samples.
    pub fn range(&self) -> Option<(f64, f64)> {
        self.calibration.range().map(|(min, max)| (min / self.one, max / self.one))
    }

    /// Returns `count` quantiles `(2i + 1) / 2M`, which are dense where samples are frequent; `None` without
    /// samples, or if quantiles were not needed.
    pub fn quantiles(&self, count: usize) -> Option<Vec<f64>> {
        let part = |i: usize| (2 * i + 1) as f64 / (2 * count) as f64;
        self.quantiles.as_ref()?.quantiles((0..count).map(part))
    }

    /// Returns the threshold of temporal contrast, from the differences or from their magnitudes; `None` if sums that
    /// are [`unordered`](Self::unordered) do not tell.
    ///
    /// # Errors
    /// Returns an error if there are too few samples, or if the threshold is not above 0.
    pub fn threshold(&self, factor: f64, of_magnitudes: bool) -> Option<Result<f64, ConfigError>> {
        let threshold = self.calibration.threshold(factor as f32, of_magnitudes)?;
        Some(threshold.map(|own| own / self.one))
    }
}

/// The crate's calibration, for any sample type.
trait Calibrate {
    fn observe(&mut self, samples: Samples, one: f64);
    fn range(&self) -> Option<(f64, f64)>;
    fn threshold(&self, factor: f32, of_magnitudes: bool) -> Option<Result<f64, ConfigError>>;
}

/// Observes samples with a copy of the calibration, which stays in registers.
fn observe_all<S: Sample, T: Pod + Into<f64>>(
    calibration: &mut Calibration<S>,
    samples: &[T],
    one: f64,
) {
    let mut local = *calibration;
    if one == 1.0 && TypeId::of::<T>() == TypeId::of::<S>() {
        for sample in cast_slice::<_, S>(samples) {
            local.observe(*sample);
        }
    } else {
        for sample in samples {
            local.observe(S::from_f64((*sample).into() * one));
        }
    }
    *calibration = local;
}

impl<S: Sample> Calibrate for Calibration<S> {
    fn observe(&mut self, samples: Samples, one: f64) {
        match samples {
            Samples::F32(own) => observe_all(self, own, one),
            Samples::F64(own) => observe_all(self, own, one),
            Samples::I16(own) => observe_all(self, own, one),
        }
    }

    fn range(&self) -> Option<(f64, f64)> {
        Some((self.min()?.to_f64(), self.max()?.to_f64()))
    }

    fn threshold(&self, factor: f32, of_magnitudes: bool) -> Option<Result<f64, ConfigError>> {
        let scheme = if of_magnitudes {
            TemporalContrast::from_magnitudes(self, factor)
        } else {
            TemporalContrast::from_calibration(self, factor)
        };
        Some(scheme.map(|scheme| scheme.threshold().to_f64()))
    }
}

impl Calibrate for Unordered {
    fn observe(&mut self, samples: Samples, _: f64) {
        match samples {
            Samples::F32(own) => self.observe(own),
            Samples::F64(own) => self.observe_rounded(own),
            Samples::I16(own) => self.observe_rounded(own),
        }
    }

    fn range(&self) -> Option<(f64, f64)> {
        self.range()
    }

    fn threshold(&self, factor: f32, of_magnitudes: bool) -> Option<Result<f64, ConfigError>> {
        self.threshold(factor, of_magnitudes).map(|own| Ok(own.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_side_by_side_tell_the_same_of_any_samples() {
        let doubles: Vec<f64> = (0..2000).map(|i| (0.1 * f64::from(i)).sin() / 3.0).collect();
        let integers: Vec<i16> = doubles.iter().map(|own| (3e4 * own) as i16).collect();
        for samples in [Samples::F64(&doubles), Samples::I16(&integers)] {
            let asked = Asked::default();
            let mut unordered = Calibrated::unordered(&asked);
            let mut ordered = Calibrated::of(SampleType::F32, &asked);
            unordered.observe_samples(samples);
            ordered.observe_samples(samples);
            assert_eq!(unordered.range(), ordered.range());
            for of_magnitudes in [false, true] {
                let [one, other] =
                    [&unordered, &ordered].map(|own| own.threshold(0.5, of_magnitudes).unwrap());
                assert_eq!(one, other);
            }
        }
    }
}
