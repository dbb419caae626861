//! The figures of one channel of a recorded flight, before it is encoded.

use spikewire::{Calibration, Sample};

/// The calibration of one channel, from which parameters are set as fractions of its range.
#[derive(Clone, Copy, Debug)]
pub struct Channel<S> {
    /// Index of the channel, which seeds its random generator.
    pub index: usize,
    /// Calibration over all samples of the channel.
    pub calibration: Calibration<S>,
    /// Smallest sample.
    pub min: S,
    /// Largest sample.
    pub max: S,
}

impl<S: Sample> Channel<S> {
    /// Makes a channel from a calibration that has seen all its samples.
    pub fn new(index: usize, calibration: Calibration<S>) -> Self {
        let (min, max) = (calibration.min(), calibration.max());
        Self { index, calibration, min: min.unwrap_or_default(), max: max.unwrap_or_default() }
    }

    /// Returns a fraction of the range.
    pub fn fraction(&self, part: f64) -> S {
        S::from_f64((self.max.to_f64() - self.min.to_f64()) * part)
    }
}
