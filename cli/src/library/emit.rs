//! Settings to paste into firmware, and to give to the laptop program.

use super::Coding;
use crate::tune::emit;
use anyhow::Result;
use catalogue::run::{Known, Settings};

/// A constant in Rust of this name, below these comments.
///
/// # Errors
/// A parameter is missing or makes no sense, or the scheme has no constant.
pub fn rust(coding: &Coding, name: &str, comments: &[String]) -> Result<String> {
    emit::rust(comments, name, coding.scheme()?, coding.sample, &settings(coding)?)
}

/// A file of parameters for `spikewire … --params`, below these comments.
///
/// # Errors
/// A parameter is missing or makes no sense.
pub fn toml(coding: &Coding, comments: &[String]) -> Result<String> {
    Ok(emit::toml(comments, coding.scheme()?, coding.sample, &settings(coding)?))
}

/// As they run. Where a signal begins is no parameter of a codec that flies.
fn settings(coding: &Coding) -> Result<Settings> {
    let scheme = coding.scheme()?;
    let past = vec![0.0; scheme.looks_back(&coding.options)];
    let known = Known { calibrated: None, first: &past, can_calibrate: false };
    if let Some(what) = scheme.needs_signal(&coding.options) {
        anyhow::bail!("{} needs {what}", scheme.name());
    }
    let settings = scheme.resolve(&coding.options, &known)?;
    Ok(scheme.rounded(coding.sample, &settings)?.0)
}
