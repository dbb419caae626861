//! How few spikes, and how near to the signal.

use super::{Coding, Signal};
use anyhow::Result;
use lab::score::Figures;
use lab::trial::Trial;

/// The figures of a coding on a signal, as `spikewire score --json` has those of one scheme.
///
/// # Errors
/// The signal or the parameters are not good.
pub fn score(signal: &Signal, coding: &Coding) -> Result<String> {
    let recording = signal.recording()?;
    let trial = Trial::new(coding.scheme, &coding.asked, coding.sample, &recording)?;
    Ok(serde_json::to_string(&Figures::of(&recording, &trial))?)
}
