//! The figures that are counted.

use serde::Serialize;

/// The cores of the tables.
pub const CORES: [&str; 2] = ["M4F", "M0"];

/// Costs of one form of one direction of a codec; instructions are those of a sample.
#[derive(Default, Serialize)]
pub struct Row {
    pub codec: String,
    pub direction: String,
    pub sample: String,
    pub core: &'static str,
    pub form: String,
    pub signal: String,
    pub instructions_mean: f64,
    pub instructions_max: u32,
    /// Lower and upper bound; for a Cortex-M0+ and a Cortex-M0 the exact count of each. Null on cores without a model.
    pub cycles_mean: Option<[f64; 2]>,
    pub cycles_max: Option<[u32; 2]>,
    /// Mean of the plain transcription; null if there is none.
    pub plain_mean: Option<f64>,
    /// Mean of the encoder in plain C, and of its cycles; null if there is none.
    pub in_c_mean: Option<f64>,
    pub in_c_cycles_mean: Option<[f64; 2]>,
    pub code_bytes: u32,
    pub state_bytes: u32,
    pub flash_bytes: u32,
    /// Stack use as seen by painting the stack.
    pub stack_bytes: u32,
    /// Upper bound of the stack use; null if it is not known.
    pub stack_bound_bytes: Option<u32>,
}

/// Energy of a cycle in nJ: the data sheet's current for code in flash, times the voltage. An STM32F405's (DS8626) 238 µA a
/// MHz at 168 MHz, its accelerator on and its peripherals off, at 3.3 V; an nRF51822's (PS v3.1) 275 µA a MHz at 3 V.
pub const ENERGY: [(&str, f64); 2] = [("M4F", 0.238 * 3.3), ("M0", 0.275 * 3.0)];

/// Returns the mean, rounded to a thousandth.
pub fn mean(total: u32, count: u32) -> f64 {
    (f64::from(total) / f64::from(count) * 1000.0).round() / 1000.0
}

/// Returns the means of both bounds; `None` if cycles were not counted.
pub fn cycles_mean(total: [u32; 2], count: u32) -> Option<[f64; 2]> {
    (total[1] > 0).then(|| total.map(|total| mean(total, count)))
}

pub fn cycles_max(max: [u32; 2]) -> Option<[u32; 2]> {
    (max[1] > 0).then_some(max)
}

/// Formats both bounds, or one figure if they are equal.
pub fn between([least, most]: [f64; 2]) -> String {
    let [least, most] = [least, most].map(|bound| format!("{bound:.1}"));
    if least == most { least } else { format!("{least}–{most}") }
}

/// Formats both bounds in whole cycles, or one figure if they are equal.
pub fn between_whole([least, most]: [u32; 2]) -> String {
    if least == most { most.to_string() } else { format!("{least}–{most}") }
}

/// Formats a cell of cycles; a dash if there are none.
pub fn cell(cycles: Option<[f64; 2]>) -> String {
    cycles.map_or("–".into(), between)
}

/// Formats a figure of a CSV file to one decimal; nothing if there is none.
pub fn decimal(figure: Option<f64>) -> String {
    figure.map(|figure| format!("{figure:.1}")).unwrap_or_default()
}

/// Formats both bounds as two cells of a CSV file.
pub fn bounds(cycles: Option<[f64; 2]>) -> String {
    cycles.map_or(",".into(), |[least, most]| format!("{least:.1},{most:.1}"))
}

/// Formats both bounds in whole cycles as two cells of a CSV file.
pub fn whole_bounds(cycles: Option<[u32; 2]>) -> String {
    cycles.map_or(",".into(), |[least, most]| format!("{least},{most}"))
}
