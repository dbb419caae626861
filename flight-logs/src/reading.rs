//! Reads a log message by message, and numbers in a message by the names of their fields.

use super::{Damage, Entry, Error, ErrorKind, Kind, Log, MessageFault, Result, Topic, open};
use std::path::Path;

/// A log that is being read, with its current message.
pub struct Reading {
    log: Box<dyn Log>,
    file: String,
    entry: Option<Entry>,
}

impl Reading {
    /// Opens a log of a known format; [`Kind::of`] recognises the format.
    ///
    /// # Errors
    /// Returns an error if the log cannot be opened, or if its start is damaged.
    pub fn open(path: &Path, kind: Kind, damage: Damage) -> Result<Self> {
        let file = path.display().to_string();
        Ok(Self { log: open(path, kind, damage)?, file, entry: None })
    }

    /// Reads the next message; returns false at the end of the log.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, or if it is damaged and was opened with [`Damage::Refuse`].
    pub fn advance(&mut self) -> Result<bool> {
        self.entry = self.log.next()?;
        Ok(self.entry.is_some())
    }

    /// Returns the path of the log.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns the topic of the current message, without a leading slash; an empty text if there is no message.
    pub fn topic(&self) -> &str {
        self.current_topic().map_or("", |topic| topic.name.trim_start_matches('/'))
    }

    /// Returns the type of the current message, such as `sensor_msgs/msg/Imu`; an empty text if the log has no types.
    pub fn kind(&self) -> &str {
        self.current_topic().map_or("", |topic| topic.kind.as_str())
    }

    /// Returns a number in the current message, selected by a name such as `angular_velocity.x` or `gyro_rad[0]`.
    /// Returns `None` if an index is beyond the end of its array.
    ///
    /// # Errors
    /// Returns an error if there is no such field, or if the message does not match its definition.
    pub fn number(&self, field: &str) -> Result<Option<f64>> {
        let topic =
            self.current_topic().ok_or_else(|| Error::new(&self.file, ErrorKind::NoMessage))?;
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

    /// Returns a text in the current message, selected by the name of its field; `None` if there is no such text.
    pub fn text(&self, field: &str) -> Option<String> {
        self.current_topic()?.text(field, self.log.message())
    }

    /// Returns the time of the current message in µs: the time in the message's field `timestamp`, or the time of
    /// recording if there is no such field.
    ///
    /// # Errors
    /// Returns an error if there is no current message, or if its field `timestamp` cannot be decoded.
    pub fn time(&self) -> Result<i64> {
        let (topic, entry) = self
            .current_topic()
            .zip(self.entry)
            .ok_or_else(|| Error::new(&self.file, ErrorKind::NoMessage))?;
        let stamp =
            topic.definition.as_ref().ok().and_then(|definition| definition.stamp("timestamp"));
        let stamped = match stamp {
            Some(stamp) => topic
                .stamp(&stamp, self.log.message())
                .map_err(|fault| self.fault(MessageFault::Bytes(fault)))?,
            None => None,
        };
        Ok(microseconds(stamped.unwrap_or(entry.time)))
    }

    /// Returns the start of an error message about the current message. It names the log's file, and the message's byte
    /// offset and topic.
    pub fn place(&self) -> String {
        let at = self.entry.map_or(0, |entry| entry.at);
        format!("{}: byte {at}, a message of topic {}", self.file, self.topic())
    }

    /// Returns notes on the faults found in the log so far, one sentence each. The notes are complete at the end of the
    /// log.
    pub fn notes(&mut self) -> Vec<String> {
        self.log.faults().notes()
    }

    /// Returns whether the current message has a number in the field `field`, so that [`number`](Self::number) takes it.
    pub fn has_number(&self, field: &str) -> bool {
        let definition = self.current_topic().and_then(|topic| topic.definition.as_ref().ok());
        definition.is_some_and(|definition| definition.number(field).is_ok())
    }

    fn fault(&self, fault: MessageFault) -> Error {
        let at = self.entry.map_or(0, |entry| entry.at);
        let topic = self.topic().to_owned();
        Error::new(&self.file, ErrorKind::Message { at, topic, fault })
    }

    fn current_topic(&self) -> Option<&Topic> {
        self.log.topics().get(self.entry?.topic)
    }
}

/// Converts a time from ns to µs, rounded to the nearest.
pub fn microseconds(nanoseconds: i64) -> i64 {
    nanoseconds.saturating_add(500).div_euclid(1000)
}
