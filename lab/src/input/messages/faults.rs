//! The faults of a log, and the notes on them.

use anyhow::{Result, bail};
use std::fmt::Display;

/// Refuses what is damaged, or counts it if that was accepted.
#[derive(Debug)]
pub(super) struct Faults {
    file: String,
    is_accepted: bool,
    skipped: u64,
    /// Messages that are longer than their definition, and where the first is.
    long: u64,
    first_long: u64,
    notes: Vec<String>,
}

impl Faults {
    pub(super) fn new(file: &str, is_accepted: bool) -> Self {
        Self {
            file: file.to_owned(),
            is_accepted,
            skipped: 0,
            long: 0,
            first_long: 0,
            notes: Vec::new(),
        }
    }

    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Whether what is damaged is left out.
    pub(super) fn is_accepted(&self) -> bool {
        self.is_accepted
    }

    /// Something that reading can go on behind.
    ///
    /// # Errors
    /// Returns an error if faults are not accepted.
    pub(super) fn skip(&mut self, at: u64, what: impl Display) -> Result<()> {
        if !self.is_accepted {
            bail!("{}: byte {at}: {what}; `accept_cut` goes on behind it", self.file);
        }
        self.skipped += 1;
        if self.skipped == 1 {
            self.notes.push(format!("skipped at byte {at}: {what}"));
        }
        Ok(())
    }

    /// Something that nothing can be read behind.
    ///
    /// # Errors
    /// Returns an error if faults are not accepted.
    pub(super) fn end(&mut self, at: u64, what: impl Display) -> Result<()> {
        if !self.is_accepted {
            bail!("{}: byte {at}: {what}; `accept_cut` takes what is before", self.file);
        }
        self.note(format!("nothing is read from byte {at} on: {what}"));
        Ok(())
    }

    /// A message that goes on behind its definition.
    pub(super) fn long(&mut self, at: u64) {
        if self.long == 0 {
            self.first_long = at;
        }
        self.long += 1;
    }

    /// Something to know.
    pub(super) fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = self.notes.clone();
        if self.skipped > 1 {
            notes.push(format!("{} damaged places were skipped in all", self.skipped));
        }
        if self.long > 0 {
            let Self { long, first_long, .. } = self;
            notes.push(format!(
                "{long} messages are longer than their definition, the first at byte {first_long}; what is behind it is not read"
            ));
        }
        notes
    }
}
