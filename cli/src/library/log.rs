//! Recordings from files: flight logs and tables.

use super::Arguments;
use crate::inputs::InputOptions;
use anyhow::Result;

/// Channels of a recording.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// What the channels are called.
    pub names: Vec<String>,
    /// Their samples, perhaps not finite, of each channel as many.
    pub columns: Vec<Vec<f64>>,
    /// The samples' times in µs: as many, or none at all.
    pub times: Vec<i64>,
    /// What a user should know of how it was read.
    pub notes: Vec<String>,
}

/// Reads channels of a file with the options that commands have for their input; all of a table unless some are named.
///
/// # Errors
/// There is no such file or channel, or nothing in it.
pub fn read(path: &str, arguments: &Arguments) -> Result<Log> {
    let input: InputOptions = arguments.parse(path)?;
    let mut source = input.or_all()?.open()?;
    let all = source.rest()?;
    let names = source.origin().last().map_or("", |(_, names)| names.as_str());
    let names = names.split(',').map(str::to_owned).collect();
    Ok(Log { names, columns: all.columns, times: all.times, notes: source.notes().to_vec() })
}
