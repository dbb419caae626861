//! Mean and standard deviation of a figure, such as the error of a code, that was measured on many test signals.

use serde::Serialize;

/// The mean and standard deviation of one cell of a table.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Statistics {
    /// Mean of the tests' values.
    pub mean: f64,
    /// The sample standard deviation, with divisor N - 1.
    pub deviation: f64,
    /// The number of tests.
    pub count: usize,
}

impl Statistics {
    /// Computes the statistics of two or more values.
    pub fn new(values: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let count = values.len();
        let mean = values.clone().sum::<f64>() / count as f64;
        let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
        Self { mean, deviation: (squares / (count as f64 - 1.0)).sqrt(), count }
    }

    /// Returns the standard error of the difference between this mean and the mean of `others` further tests. The
    /// further tests are assumed to have the same standard deviation.
    pub fn error_against(&self, others: usize) -> f64 {
        self.deviation * (1.0 / self.count as f64 + 1.0 / others as f64).sqrt()
    }
}
