//! Samples that a type cannot hold.

use crate::sample_type::SampleType;
use std::fmt;

/// Counts them.
pub(crate) struct Saturated {
    sample: SampleType,
    count: u64,
}

impl Saturated {
    /// A count of none.
    pub(crate) fn new(sample: SampleType) -> Self {
        Self { sample, count: 0 }
    }

    /// Takes the next samples.
    pub(crate) fn observe(&mut self, values: &[f64]) {
        let (min, max) = self.sample.range();
        self.count += values.iter().filter(|&&value| value < min || value > max).count() as u64;
    }
}

/// A line of what there is to report, or nothing.
impl fmt::Display for Saturated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sample, count } = self;
        if *count == 0 {
            return Ok(());
        }
        let (min, max) = sample.range();
        writeln!(f, "{count} samples were cut to the range of {sample}, {min} to {max}")
    }
}
