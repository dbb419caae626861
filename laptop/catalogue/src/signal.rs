//! Figures of a signal, found before instructions are counted on it.

use spikewire::{Calibration, Sample};

/// A signal's calibration, and the paper's parameters scaled to its range.
#[derive(Clone, Copy, Debug)]
pub struct Scaled<S> {
    /// The calibration over all its samples.
    pub calibration: Calibration<S>,
    /// Its smallest sample.
    pub min: S,
    /// Its largest sample.
    pub max: S,
    /// Between the two.
    pub range: f64,
}

impl<S: Sample> Scaled<S> {
    /// The paper's amplitude of its signal.
    pub const PAPER_RANGE: f64 = 5.8;

    /// A signal whose calibration has seen its samples.
    pub fn new(calibration: Calibration<S>) -> Self {
        let min = calibration.min().unwrap_or_default();
        let max = calibration.max().unwrap_or_default();
        Self { calibration, min, max, range: max.to_f64() - min.to_f64() }
    }

    /// A parameter for the paper's signal, scaled to this one.
    pub fn part(&self, value: f64) -> S {
        S::from_f64(value / Self::PAPER_RANGE * self.range)
    }

    /// The means of `M` receptive fields over the range, which are not rounded to whole numbers.
    pub fn means<const M: usize>(&self) -> [f32; M] {
        let min = self.min.to_f64();
        core::array::from_fn(|i| {
            (min + (2.0 * i as f64 - 1.0) * self.range / (2.0 * (M as f64 - 2.0))) as f32
        })
    }
}
