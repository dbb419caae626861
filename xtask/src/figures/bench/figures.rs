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
    /// The lower and the upper bound, null on cores without a model; a Cortex-M0+'s and a Cortex-M0's, both exact.
    pub cycles_mean: Option<[f64; 2]>,
    pub cycles_max: Option<[u32; 2]>,
    /// Of the plain transcription; null where there is none.
    pub plain_mean: Option<f64>,
    pub code_bytes: u32,
    pub state_bytes: u32,
    pub flash_bytes: u32,
    /// What painting it showed.
    pub stack_bytes: u32,
    /// What the code can take at most; null where that is not known.
    pub stack_bound_bytes: Option<u32>,
}

/// To a thousandth, or some would have 16 digits.
pub fn mean(total: u32, count: u32) -> f64 {
    (f64::from(total) / f64::from(count) * 1000.0).round() / 1000.0
}

/// None where nobody counted.
pub fn cycles_mean(total: [u32; 2], count: u32) -> Option<[f64; 2]> {
    (total[1] > 0).then(|| total.map(|total| mean(total, count)))
}

pub fn cycles_max(max: [u32; 2]) -> Option<[u32; 2]> {
    (max[1] > 0).then_some(max)
}

/// Both bounds in a cell, or one figure where they are the same.
pub fn between([least, most]: [f64; 2]) -> String {
    let [least, most] = [least, most].map(|bound| format!("{bound:.1}"));
    if least == most { least } else { format!("{least}–{most}") }
}

/// The same of whole cycles.
pub fn between_whole([least, most]: [u32; 2]) -> String {
    if least == most { most.to_string() } else { format!("{least}–{most}") }
}

/// A cell of cycles, which some cores have none of.
pub fn cell(cycles: Option<[f64; 2]>) -> String {
    cycles.map_or("–".into(), between)
}
