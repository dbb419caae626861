//! What is counted.

use serde::Serialize;

/// The cores of the tables.
pub const CORES: [&str; 2] = ["M4F", "M0"];

/// What one form of one direction of a codec costs; instructions are those of a sample.
#[derive(Serialize)]
pub struct Row {
    pub codec: String,
    pub direction: String,
    pub sample: String,
    pub core: &'static str,
    pub form: String,
    pub signal: String,
    pub instructions_mean: f64,
    pub instructions_max: u32,
    /// Of the plain transcription; null where there is none.
    pub plain_mean: Option<f64>,
    pub code_bytes: u32,
    pub state_bytes: u32,
    pub flash_bytes: u32,
    pub stack_bytes: u32,
}

/// To a thousandth, or some would have 16 digits.
pub fn mean(total: u32, count: u32) -> f64 {
    (f64::from(total) / f64::from(count) * 1000.0).round() / 1000.0
}
