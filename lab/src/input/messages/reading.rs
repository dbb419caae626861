//! A log message by message, with fields by name.

use super::topic::{Topic, microseconds};
use super::{Entry, Kind, Log, open};
use anyhow::{Context, Result, anyhow};
use std::path::Path;

/// A log that is read from its start to its end, and the message that came last.
pub struct Reading {
    log: Box<dyn Log>,
    file: String,
    entry: Option<Entry>,
}

impl Reading {
    /// Opens a log.
    ///
    /// # Errors
    /// Returns an error if the log cannot be opened.
    pub fn open(path: &Path, kind: Kind, accept_cut: bool) -> Result<Self> {
        let file = path.display().to_string();
        Ok(Self { log: open(path, kind, accept_cut)?, file, entry: None })
    }

    /// Goes to the next message, if there is one.
    ///
    /// # Errors
    /// The log is damaged, and that was not accepted.
    pub fn advance(&mut self) -> Result<bool> {
        self.entry = self.log.next()?;
        Ok(self.entry.is_some())
    }

    /// The name of the file that is read.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Its topic, without a slash before it.
    pub fn topic(&self) -> &str {
        self.own().map_or("", |topic| topic.name.trim_start_matches('/'))
    }

    /// The type of the message.
    pub fn kind(&self) -> &str {
        self.own().map_or("", |topic| topic.kind.as_str())
    }

    /// A number of the message; none where an array is shorter.
    ///
    /// # Errors
    /// Returns an error if there is no such field.
    pub fn number(&self, field: &str) -> Result<Option<f64>> {
        let topic = self.own().context("there is no message")?;
        let definition =
            topic.definition.as_ref().map_err(|error| anyhow!("{}: {error}", self.place()))?;
        let path = definition
            .number(field)
            .map_err(|_| anyhow!("{}: it has no number `{field}`", self.place()))?;
        let number = topic.number(&path, self.log.message());
        number.map_err(|fault| anyhow!("{}: {fault}", self.place()))
    }

    /// A neuron's spike: that of the field `spike`, or of its place in the array of that name.
    ///
    /// # Errors
    /// Returns an error if there is no such field.
    pub fn spike(&self, place: usize, of: usize) -> Result<Option<i8>> {
        let is_one = self.own().is_some_and(|topic| {
            topic.definition.as_ref().is_ok_and(|own| own.number("spike").is_ok())
        });
        let number = match (is_one, place, of) {
            (true, 0, 1 | usize::MAX) => self.number("spike")?,
            (true, ..) => None,
            (false, ..) => self.number(&format!("spike[{place}]"))?,
        };
        Ok(number.map(|number| number as i8))
    }

    /// A text of the message.
    pub fn text(&self, field: &str) -> Option<String> {
        self.own()?.text(field, self.log.message())
    }

    /// The time that the message says, or else when it was recorded, in µs.
    ///
    /// # Errors
    /// The message is shorter than that.
    pub fn time(&self) -> Result<i64> {
        let (topic, entry) = self.own().zip(self.entry).context("there is no message")?;
        let stamp = topic.definition.as_ref().ok().and_then(|own| own.stamp("timestamp"));
        let told = match stamp {
            Some(stamp) => topic
                .stamp(&stamp, self.log.message())
                .map_err(|fault| anyhow!("{}: {fault}", self.place()))?,
            None => None,
        };
        Ok(microseconds(told.unwrap_or(entry.time)))
    }

    /// The place of the message, for an error.
    pub fn place(&self) -> String {
        let at = self.entry.map_or(0, |entry| entry.at);
        format!("{}: byte {at}, a message of topic {}", self.file, self.topic())
    }

    /// The notes on the log, complete at its end.
    pub fn notes(&mut self) -> Vec<String> {
        self.log.faults().notes()
    }

    fn own(&self) -> Option<&Topic> {
        self.log.topics().get(self.entry?.topic)
    }
}
