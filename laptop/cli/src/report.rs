//! The shape of the reports that commands print with `--json`.

use crate::options::answer;
use crate::words;
use anyhow::{Result, bail, ensure};
use serde::Serialize;
use std::path::Path;

/// A report: the name of the command, an entry for each log, and what holds for all logs together.
#[derive(Debug, Serialize)]
pub(crate) struct Report<'a, L, S> {
    /// Name of the command.
    pub command: &'static str,
    /// The entries of the logs. Each has the members `log`, `refused` and `notes`, and those of the command.
    pub logs: &'a [L],
    /// Results for all logs together.
    pub summary: S,
}

/// The entry of a log.
#[derive(Debug, Serialize)]
#[allow(clippy::struct_field_names, reason = "the members of the report")]
pub(crate) struct Log<T> {
    /// Path of the log, as given or found.
    pub log: String,
    /// Reason that the log could not be processed, or that nothing was found for it.
    pub refused: Option<String>,
    /// Notes for the user on the log, which are printed on standard error without `--json`.
    pub notes: Vec<String>,
    /// Results; `None` if the log could not be processed.
    #[serde(flatten)]
    pub content: Option<T>,
}

/// Returns whether the option `-o` names standard output.
///
/// # Errors
/// Returns an error if it does, and a report as JSON goes there, too.
pub(crate) fn is_stdout(output: Option<&Path>, json: bool) -> Result<bool> {
    let is_stdout = output == Some(Path::new("-"));
    ensure!(!(is_stdout && json), "--json and -o - both write to standard output");
    Ok(is_stdout)
}

/// Number of logs, and number of those that were refused.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Counts {
    pub logs: usize,
    pub refused: usize,
}

impl<L: Serialize, S: Serialize> Report<'_, L, S> {
    /// Prints the report on standard output, as JSON.
    ///
    /// # Errors
    /// Returns an error if standard output cannot be written.
    pub(crate) fn print(&self) -> Result<()> {
        answer(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl<T> Log<T> {
    /// Makes the entry of a log that cannot be processed, and prints the reason on standard error.
    ///
    /// # Errors
    /// Returns the reason if it `ends` the command: that of a single log, without a report that lists it.
    pub(crate) fn refused(log: String, why: anyhow::Error, ends: bool) -> Result<Self> {
        if ends {
            return Err(why);
        }
        let words = words::of(&why);
        let is_named = words.strip_prefix(&log).is_some_and(|rest| rest.starts_with(':'));
        let of = if is_named { String::new() } else { format!("{log}: ") };
        say!("error: {of}{words}");
        Ok(Self { log, refused: Some(words), notes: Vec::new(), content: None })
    }
}

impl Counts {
    /// Counts logs by their entries.
    pub(crate) fn of<T>(logs: &[Log<T>]) -> Self {
        let refused = logs.iter().filter(|own| own.refused.is_some()).count();
        Self { logs: logs.len(), refused }
    }

    /// Checks that no log was refused.
    ///
    /// # Errors
    /// Returns an error if a log was refused.
    pub(crate) fn check(self) -> Result<()> {
        match self.refused {
            0 => Ok(()),
            refused => bail!("{refused} of {} logs cannot be processed", self.logs),
        }
    }
}
