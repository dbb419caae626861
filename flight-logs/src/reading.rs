//! Reads a log message by message, and its fields by name.

use super::{Damage, Entry, Error, ErrorKind, Kind, Log, MessageFault, Result, Topic, open};
use std::path::Path;

/// A log that is being read, and its current message.
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
    pub fn open(path: &Path, kind: Kind, damage: Damage) -> Result<Self> {
        let file = path.display().to_string();
        Ok(Self { log: open(path, kind, damage)?, file, entry: None })
    }

    /// Goes to the next message; returns whether there is one.
    ///
    /// # Errors
    /// Returns an error if the log is damaged and [`Damage::Refuse`] was asked for.
    pub fn advance(&mut self) -> Result<bool> {
        self.entry = self.log.next()?;
        Ok(self.entry.is_some())
    }

    /// Returns the path of the file that is read.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns the topic of the current message, without a leading slash.
    pub fn topic(&self) -> &str {
        self.own().map_or("", |topic| topic.name.trim_start_matches('/'))
    }

    /// Returns the type of the current message.
    pub fn kind(&self) -> &str {
        self.own().map_or("", |topic| topic.kind.as_str())
    }

    /// Reads a number of the current message, such as `angular_velocity.x` or `gyro_rad[0]`; `None` if it lies beyond
    /// the end of an array.
    ///
    /// # Errors
    /// Returns an error if there is no such field, or if the message does not match its definition.
    pub fn number(&self, field: &str) -> Result<Option<f64>> {
        let topic = self.own().ok_or_else(|| Error::new(&self.file, ErrorKind::NoMessage))?;
        let definition = topic
            .definition
            .as_ref()
            .map_err(|why| self.fault(MessageFault::Undefined(why.clone())))?;
        let path = definition
            .number(field)
            .map_err(|_| self.fault(MessageFault::NoNumber(field.to_owned())))?;
        let number = topic.number(&path, self.log.message());
        number.map_err(|fault| self.fault(MessageFault::Bytes(fault)))
    }

    /// Reads a text of the current message; `None` if there is none of this name.
    pub fn text(&self, field: &str) -> Option<String> {
        self.own()?.text(field, self.log.message())
    }

    /// Returns the time of the current message in µs: the one that it contains, or else that at which it was recorded.
    ///
    /// # Errors
    /// Returns an error if the message ends before its time.
    pub fn time(&self) -> Result<i64> {
        let (topic, entry) = self
            .own()
            .zip(self.entry)
            .ok_or_else(|| Error::new(&self.file, ErrorKind::NoMessage))?;
        let stamp = topic.definition.as_ref().ok().and_then(|own| own.stamp("timestamp"));
        let told = match stamp {
            Some(stamp) => topic
                .stamp(&stamp, self.log.message())
                .map_err(|fault| self.fault(MessageFault::Bytes(fault)))?,
            None => None,
        };
        Ok(microseconds(told.unwrap_or(entry.time)))
    }

    /// Describes the place of the current message for an error: file, byte, topic.
    pub fn place(&self) -> String {
        let at = self.entry.map_or(0, |entry| entry.at);
        format!("{}: byte {at}, a message of topic {}", self.file, self.topic())
    }

    /// Returns notes on the log; they are complete at its end.
    pub fn notes(&mut self) -> Vec<String> {
        self.log.faults().notes()
    }

    /// Returns whether the current message has a number of this name.
    pub fn has_number(&self, field: &str) -> bool {
        let definition = self.own().and_then(|topic| topic.definition.as_ref().ok());
        definition.is_some_and(|own| own.number(field).is_ok())
    }

    fn fault(&self, fault: MessageFault) -> Error {
        let at = self.entry.map_or(0, |entry| entry.at);
        let topic = self.topic().to_owned();
        Error::new(&self.file, ErrorKind::Message { at, topic, fault })
    }

    fn own(&self) -> Option<&Topic> {
        self.log.topics().get(self.entry?.topic)
    }
}

/// Rounds a time in ns to whole µs.
pub fn microseconds(nanoseconds: i64) -> i64 {
    nanoseconds.saturating_add(500).div_euclid(1000)
}
