//! The figures of one channel of a flight, known before it is flown.

use spikewire::{Calibration, Sample};

/// One channel's calibration, and parameters as fractions of its range.
#[derive(Clone, Copy, Debug)]
pub struct Channel<S> {
    /// The channel's index, from which a generator starts.
    pub index: usize,
    /// The calibration over all its samples.
    pub calibration: Calibration<S>,
    /// Its smallest sample.
    pub min: S,
    /// Its largest sample.
    pub max: S,
}

impl<S: Sample> Channel<S> {
    /// A channel whose calibration has seen its samples.
    pub fn new(index: usize, calibration: Calibration<S>) -> Self {
        let (min, max) = (calibration.min(), calibration.max());
        Self { index, calibration, min: min.unwrap_or_default(), max: max.unwrap_or_default() }
    }

    /// A part of the range.
    pub fn fraction(&self, part: f64) -> S {
        S::from_f64((self.max.to_f64() - self.min.to_f64()) * part)
    }
}
