//! Pictures of signals, spikes and what they decode to.

use super::{Coding, Signal};
use anyhow::{Result, bail};
use lab::look::known_unit;
use lab::plot::{Picture, bytes};
use lab::trial::Trial;
use std::ops::Range;

/// What a picture shows, and how.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// The signal's unit; told by its name unless given.
    pub unit: Option<String>,
    /// The samples shown; all of them are encoded.
    pub range: Option<Range<usize>>,
}

/// A panel for each coding, as the bytes of a file `svg` or `png`.
///
/// # Errors
/// The signal, the parameters, the range or the ending are not good.
pub fn plot(signal: &Signal, codings: &[Coding], shown: &Shown, ending: &str) -> Result<Vec<u8>> {
    let recording = signal.recording()?;
    let samples = recording.values.len();
    let range = shown.range.clone().unwrap_or(0..samples);
    if range.start + 1 >= range.end || range.end > samples {
        bail!("range {}..{}: two samples at least, within 0..{samples}", range.start, range.end);
    }
    let trials = codings
        .iter()
        .map(|coding| Trial::new(coding.scheme, &coding.asked, coding.sample, &recording));
    let trials = trials.collect::<Result<Vec<_>>>()?;
    let unit = shown.unit.as_deref().or_else(|| known_unit(&recording.name));
    bytes(ending, &Picture { recording: &recording, trials: &trials, unit, shown: range })
}
