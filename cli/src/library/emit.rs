//! Settings to paste into firmware, and to give to the laptop program.

use super::Coding;
use crate::commands;
use anyhow::Result;
use catalogue::run::{Known, Settings};
use lab::tune::emit;
use std::fs;
use std::path::Path;

/// A constant in Rust of this name, below these comments.
///
/// # Errors
/// A parameter is missing or makes no sense, or the scheme has no constant.
pub fn rust(coding: &Coding, name: &str, comments: &[String]) -> Result<String> {
    emit::rust(comments, name, coding.scheme, &settings(coding)?)
}

/// A file of parameters for `spikewire … --params`, below these comments.
///
/// # Errors
/// A parameter is missing or makes no sense.
pub fn toml(coding: &Coding, comments: &[String]) -> Result<String> {
    Ok(emit::toml(comments, coding.scheme, &settings(coding)?))
}

/// Writes a crate that makes the library for C of this codec, its parameters in flash, into a new directory.
///
/// # Errors
/// A parameter is missing or makes no sense, the library has no such scheme, or the directory is there.
pub fn c(coding: &Coding, name: &str, directory: &Path, spikewire: Option<&Path>) -> Result<()> {
    let place = tempfile::tempdir()?;
    let params = place.path().join(name).with_extension("toml");
    fs::write(&params, toml(coding, &[])?)?;
    commands::emit::c(&[params], directory, spikewire)
}

/// As they run. Where a signal begins is no parameter of a codec that flies.
fn settings(coding: &Coding) -> Result<Settings> {
    let Coding { scheme, sample, asked } = coding;
    let past = vec![0.0; scheme.looks_back(asked)];
    let known = Known { calibrated: None, first: &past, can_calibrate: false };
    if let Some(what) = scheme.needs_signal(asked) {
        anyhow::bail!("{} needs {what}", scheme.name());
    }
    scheme.resolve(*sample, asked, &known)
}
