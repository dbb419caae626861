//! Figures of a signal, computed before instructions are counted on it.

use spikewire::{Calibration, Sample};

/// A signal's calibration, with which the paper's parameters are scaled to its range.
#[derive(Clone, Copy, Debug)]
pub struct Scaled<S> {
    /// Calibration over all samples.
    pub calibration: Calibration<S>,
    /// Smallest sample.
    pub min: S,
    /// Largest sample.
    pub max: S,
    /// Difference between the largest and the smallest sample.
    pub range: f64,
}

impl<S: Sample> Scaled<S> {
    /// Range of the paper's signal, as the paper states it.
    pub const PAPER_RANGE: f64 = 5.8;

    /// Makes it from a calibration that has seen all samples.
    pub fn new(calibration: Calibration<S>) -> Self {
        let min = calibration.min().unwrap_or_default();
        let max = calibration.max().unwrap_or_default();
        Self { calibration, min, max, range: max.to_f64() - min.to_f64() }
    }

    /// Scales a parameter for the paper's signal to this one.
    pub fn part(&self, value: f64) -> S {
        S::from_f64(value / Self::PAPER_RANGE * self.range)
    }

    /// Returns the means of `M` receptive fields over the range, not rounded to integers.
    pub fn means<const M: usize>(&self) -> [f32; M] {
        let min = self.min.to_f64();
        core::array::from_fn(|i| {
            (min + (2.0 * i as f64 - 1.0) * self.range / (2.0 * (M as f64 - 2.0))) as f32
        })
    }
}
