//! Topics of a log, and access to numbers and texts in their messages.

use super::definition::{Definition, Dialect, Path, Stamp};
use super::wire::{self, Fault, Wire};

/// A topic: its name, and the definition of its messages.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Name, as in the log.
    pub name: String,
    /// Type of its messages.
    pub kind: String,
    /// Encoding of its messages.
    pub wire: Wire,
    /// Definition of its messages, or the reason that they cannot be read.
    pub definition: Result<Definition, String>,
}

impl Topic {
    /// Makes a topic from the text of a definition.
    pub(crate) fn new(name: String, kind: String, dialect: Dialect, text: &str) -> Self {
        let wire = match dialect {
            Dialect::Ros1 | Dialect::Px4 => Wire::Ros1,
            Dialect::Ros2 => Wire::Cdr,
        };
        let definition = Definition::parse(&kind, text, dialect);
        Self { name, kind, wire, definition }
    }

    /// Makes a topic whose messages cannot be read; `why` is the reason.
    pub(crate) fn unread(name: String, kind: String, why: String) -> Self {
        Self { name, kind, wire: Wire::Ros1, definition: Err(why) }
    }

    /// Returns the index of the topic in `topics`; adds it if it is new.
    pub(crate) fn place_in(self, topics: &mut Vec<Self>) -> usize {
        let known = topics.iter().position(|own| *own == self);
        known.unwrap_or_else(|| {
            topics.push(self);
            topics.len() - 1
        })
    }

    /// Reads a number of a message; `None` if it lies beyond the end of an array.
    ///
    /// # Errors
    /// Returns an error if the message does not match its definition.
    pub fn number(&self, path: &Path, message: &[u8]) -> Result<Option<f64>, Fault> {
        match &self.definition {
            Ok(definition) => wire::number(self.wire, definition, path, message),
            Err(_) => Ok(None),
        }
    }

    /// Returns whether a message is longer than its definition.
    pub fn is_longer(&self, message: &[u8]) -> bool {
        self.definition.as_ref().is_ok_and(|own| wire::is_longer(self.wire, own, message))
    }

    /// Reads a text of a message.
    pub fn text(&self, field: &str, message: &[u8]) -> Option<String> {
        let definition = self.definition.as_ref().ok()?;
        wire::text(self.wire, definition, &definition.text(field)?, message)
    }

    /// Reads a time in a message, in ns; `None` if it lies beyond the end of an array.
    ///
    /// # Errors
    /// Returns an error if the message does not match its definition.
    pub fn stamp(&self, stamp: &Stamp, message: &[u8]) -> Result<Option<i64>, Fault> {
        let read = |path| self.number(path, message);
        let parts = read(&stamp.seconds)?.zip(read(&stamp.nanoseconds)?);
        Ok(parts.map(|(seconds, nanoseconds)| seconds as i64 * 1_000_000_000 + nanoseconds as i64))
    }
}
