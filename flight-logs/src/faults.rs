//! Counts the damage and other faults in a log, or returns them as errors.

use crate::{Damage, Error, ErrorKind, Rest, Result};
use std::fmt::Display;

/// Faults found in a log so far. Depending on [`Damage`], damage is returned as an error, or counted and described in
/// notes.
#[derive(Debug)]
pub struct Faults {
    file: String,
    damage: Damage,
    skipped: u64,
    /// Number of messages that are longer than their definition.
    long: u64,
    /// Offset in the file of the first message that is longer than its definition.
    first_long: u64,
    notes: Vec<String>,
}

impl Faults {
    pub(crate) fn new(file: &str, damage: Damage) -> Self {
        Self {
            file: file.to_owned(),
            damage,
            skipped: 0,
            long: 0,
            first_long: 0,
            notes: Vec::new(),
        }
    }

    pub(crate) fn file(&self) -> &str {
        &self.file
    }

    /// Returns whether damage is refused or skipped.
    pub(crate) fn damage(&self) -> Damage {
        self.damage
    }

    /// Returns the fault as an error if damage is refused, and does nothing otherwise.
    fn refuse(&self, at: u64, what: &impl Display, rest: Rest) -> Result<()> {
        match self.damage {
            Damage::Skip => Ok(()),
            Damage::Refuse => {
                let what = what.to_string();
                Err(Error::new(&self.file, ErrorKind::Fault { at, what, rest }))
            }
        }
    }

    /// Counts damage after which reading continues. `at` is the offset of the damage in the file, in bytes; `what`
    /// describes the damage. The notes describe only the first damage of a log.
    ///
    /// # Errors
    /// Returns an error if damage is refused.
    pub fn skip(&mut self, at: u64, what: impl Display) -> Result<()> {
        self.refuse(at, &what, Rest::Behind)?;
        self.lose(at, what);
        Ok(())
    }

    /// Counts a fault that is never returned as an error, because undamaged logs of this kind often have such faults.
    pub(crate) fn lose(&mut self, at: u64, what: impl Display) {
        self.skipped += 1;
        if self.skipped == 1 {
            self.notes.push(format!("skipped at byte {at}: {what}"));
        }
    }

    /// Notes `count` bytes at the end of a log that are blank: erased flash, or zeros of a file that was made longer than
    /// its log in advance. They are no damage.
    pub(crate) fn blank(&mut self, at: u64, count: u64) {
        self.note(format!(
            "the last {count} bytes, from byte {at} on, are blank, as erased flash is"
        ));
    }

    /// Notes damage after which nothing can be read. `at` is the offset of the damage in the file, in bytes; `what`
    /// describes the damage.
    ///
    /// # Errors
    /// Returns an error if damage is refused.
    pub(crate) fn end(&mut self, at: u64, what: impl Display) -> Result<()> {
        self.refuse(at, &what, Rest::Before)?;
        self.note(format!("nothing is read from byte {at} on: {what}"));
        Ok(())
    }

    /// Counts a message that is longer than its definition; `at` is the message's offset in the file, in bytes.
    pub fn long(&mut self, at: u64) {
        if self.long == 0 {
            self.first_long = at;
        }
        self.long += 1;
    }

    /// Adds a note on something other than damage.
    pub(crate) fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// Returns notes on the log, one sentence each. They contain the remarks of the log's reader, a description of the
    /// first damage, the number of damaged places, and the number of messages that are too long.
    pub fn notes(&self) -> Vec<String> {
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
