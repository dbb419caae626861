//! Errors of reading a log, as values that a program can match.

use crate::wire;
use std::path::Path;
use std::{error, fmt, io};

/// Result of reading a log.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Error of a log that is damaged or cannot be read.
///
/// The error's text names the file and, if possible, the byte offset of the fault. The text gives no advice;
/// [`ErrorKind::rest`] tells whether [`Damage::Skip`](crate::Damage::Skip) would read more of the log.
#[derive(Debug)]
pub struct Error {
    /// Path of the file, as the caller gave it.
    pub file: String,
    /// Reason for the error, with its details.
    pub kind: ErrorKind,
}

/// Reason that a log cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The file cannot be opened.
    Open(io::Error),
    /// The file cannot be read.
    Read(io::Error),
    /// The file cannot be decompressed.
    Unpack(io::Error),
    /// The file ends within its header.
    ShortHead(io::Error),
    /// The file is empty.
    Empty,
    /// The file is not a log, although its name or its first bytes suggest one. The text tells what is missing.
    NotALog(String),
    /// The file is a log that must not be read by this version of the crate. The text tells why.
    Unsupported(String),
    /// A record or a message cannot be read.
    Fault {
        /// Offset of the fault in the file, in bytes.
        at: u64,
        /// Description of the fault.
        what: String,
        /// Part of the log that can still be read.
        rest: Rest,
    },
    /// A range of bytes of a PX4 log forms no messages.
    Damaged {
        /// Offset of the first damaged byte.
        at: u64,
        /// Length of the file, in bytes.
        length: u64,
        /// Offset of the first message after the damage.
        next: u64,
    },
    /// A PX4 log ends within a message.
    Cut {
        /// Offset of the message's first byte.
        at: u64,
        /// Length of the file, in bytes.
        length: u64,
    },
    /// A message does not contain the value that the caller selected.
    Message {
        /// Offset in the file of the message, or of the chunk that contains the message, in bytes.
        at: u64,
        /// Topic of the message.
        topic: String,
        /// Reason that the value cannot be read from the message.
        fault: MessageFault,
    },
    /// A value was requested before the first message was read, or after the last.
    NoMessage,
}

/// Part of a damaged log that can still be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// Messages before the damage and messages behind it can be read.
    Behind,
    /// Messages before the damage, and messages from this byte on, can be read.
    From(u64),
    /// Only the messages before the damage.
    Before,
}

/// Reason that a message does not contain the selected value.
#[derive(Debug)]
#[non_exhaustive]
pub enum MessageFault {
    /// The message's definition cannot be understood. The text tells why.
    Undefined(String),
    /// The message has no number of this name.
    NoNumber(String),
    /// The message's bytes do not match its definition.
    Bytes(wire::Fault),
}

impl Error {
    pub(crate) fn new(file: impl Into<String>, kind: ErrorKind) -> Self {
        Self { file: file.into(), kind }
    }

    pub(crate) fn of(path: &Path, kind: ErrorKind) -> Self {
        Self::new(path.display().to_string(), kind)
    }

    pub(crate) fn not_a_log(file: impl Into<String>, what: impl Into<String>) -> Self {
        Self::new(file, ErrorKind::NotALog(what.into()))
    }
}

impl ErrorKind {
    /// Returns the part of the log that [`Damage::Skip`](crate::Damage::Skip) would read in spite of this error; `None`
    /// if `Damage::Skip` gives the same error.
    pub fn rest(&self) -> Option<Rest> {
        match *self {
            Self::Fault { rest, .. } => Some(rest),
            Self::Damaged { next, .. } => Some(Rest::From(next)),
            Self::Cut { .. } => Some(Rest::Before),
            _ => None,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, kind } = self;
        match kind {
            ErrorKind::Open(_) => write!(f, "{file}: cannot be opened"),
            ErrorKind::Read(_) => write!(f, "{file}: cannot be read"),
            ErrorKind::Unpack(_) => write!(f, "{file}: cannot be unpacked"),
            ErrorKind::ShortHead(_) => write!(f, "{file}: shorter than its head"),
            ErrorKind::Empty => write!(f, "{file}: empty"),
            ErrorKind::NotALog(what) | ErrorKind::Unsupported(what) => write!(f, "{file}: {what}"),
            ErrorKind::Fault { at, what, .. } => write!(f, "{file}: byte {at}: {what}"),
            ErrorKind::Damaged { at, length, .. } => {
                write!(f, "{file}: damaged at byte {at} of {length}")
            }
            ErrorKind::Cut { at, length } => {
                write!(f, "{file}: cut short within the message at byte {at} of {length}")
            }
            ErrorKind::Message { at, topic, fault } => {
                write!(f, "{file}: byte {at}, a message of topic {topic}: ")?;
                match fault {
                    MessageFault::Undefined(why) => f.write_str(why),
                    MessageFault::NoNumber(field) => write!(f, "it has no number `{field}`"),
                    MessageFault::Bytes(fault) => fault.fmt(f),
                }
            }
            ErrorKind::NoMessage => write!(f, "{file}: there is no message"),
        }
    }
}

impl error::Error for Error {
    fn source(&self) -> Option<&(dyn error::Error + 'static)> {
        match &self.kind {
            ErrorKind::Open(error)
            | ErrorKind::Read(error)
            | ErrorKind::Unpack(error)
            | ErrorKind::ShortHead(error) => Some(error),
            _ => None,
        }
    }
}
