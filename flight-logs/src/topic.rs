//! Topics of a log, with the definition of their messages.

use super::definition::{Definition, Dialect, Path, Stamp};
use super::wire::{self, Fault, Wire};

/// A topic: its name, and the type and definition of its messages.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Name, as it is written in the log.
    pub name: String,
    /// Name of the messages' type; empty if the log has no types.
    pub kind: String,
    /// Encoding of the messages' bytes.
    pub wire: Wire,
    /// Definition of the messages, or the reason that they cannot be read.
    pub definition: Result<Definition, String>,
}

impl Topic {
    /// Creates a topic of messages of type `kind`; `text` is the definition of their type.
    pub(crate) fn new(name: String, kind: String, dialect: Dialect, text: &str) -> Self {
        let wire = match dialect {
            Dialect::Ros1 | Dialect::Px4 => Wire::Ros1,
            Dialect::Ros2 => Wire::Cdr,
        };
        let definition = Definition::parse(&kind, text, dialect);
        Self { name, kind, wire, definition }
    }

    /// Creates a topic whose messages cannot be read; `why` is the reason.
    pub(crate) fn unread(name: String, kind: String, why: String) -> Self {
        Self { name, kind, wire: Wire::Ros1, definition: Err(why) }
    }

    /// Returns the topic's index in `topics`. If the list has no equal topic, appends this topic first.
    pub(crate) fn index_in(self, topics: &mut Vec<Self>) -> usize {
        let known = topics.iter().position(|topic| *topic == self);
        known.unwrap_or_else(|| {
            topics.push(self);
            topics.len() - 1
        })
    }

    /// Returns the number at a path in a message, or `None` if the path leads beyond the end of an array.
    ///
    /// # Errors
    /// Returns an error if the message does not match its definition.
    pub fn number(&self, path: &Path, message: &[u8]) -> Result<Option<f64>, Fault> {
        match &self.definition {
            Ok(definition) => wire::number(self.wire, definition, path, message),
            Err(_) => Ok(None),
        }
    }

    /// Returns whether a message has bytes after the fields of its definition.
    pub fn is_longer(&self, message: &[u8]) -> bool {
        self.definition
            .as_ref()
            .is_ok_and(|definition| wire::is_longer(self.wire, definition, message))
    }

    /// Returns the text in the field `field` of a message; `None` if there is no such text.
    pub fn text(&self, field: &str, message: &[u8]) -> Option<String> {
        let definition = self.definition.as_ref().ok()?;
        wire::text(self.wire, definition, &definition.text(field)?, message)
    }

    /// Returns a time in a message, in ns, or `None` if a path in `stamp` leads beyond the end of an array.
    ///
    /// # Errors
    /// Returns an error if the message does not match its definition.
    pub fn stamp(&self, stamp: &Stamp, message: &[u8]) -> Result<Option<i64>, Fault> {
        let read = |path| self.number(path, message);
        let parts = read(&stamp.seconds)?.zip(read(&stamp.nanoseconds)?);
        Ok(parts.map(|(seconds, nanoseconds)| seconds as i64 * 1_000_000_000 + nanoseconds as i64))
    }
}
