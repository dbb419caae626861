//! Whether step forward keeps up with a recording.

use crate::settings::{Settings, StepForward};
use crate::trial::Recording;

/// What to say where it does not, by more than a few steps.
pub(crate) fn note(recording: &Recording, settings: &Settings) -> Option<String> {
    const FEW: f64 = 0.1;
    let Settings::StepForward(StepForward { threshold, .. }) = settings else { return None };
    let steps = recording.values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let steep = steps.clone().filter(|step| step > threshold).count();
    let samples = recording.values.len();
    if steep as f64 <= FEW * samples as f64 {
        return None;
    }
    let (rate, unit) = recording.rate.map_or((1.0, "sample"), |rate| (rate, "second"));
    let fastest = (threshold * rate) as f32;
    let steepest = (steps.fold(0.0, f64::max) * rate) as f32;
    Some(format!(
        "SF follows at most one threshold a sample, and {steep} of {samples} samples step further: \
         threshold x rate, {fastest} a {unit}, must exceed the steepest slope, {steepest} a {unit}"
    ))
}
