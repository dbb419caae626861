//! Errors, as values that a program can act on.

use std::path::Path;
use std::{error, fmt, io};

/// The error of a flight that cannot be read, or whose parts do not fit together.
#[derive(Debug)]
pub struct FlightError {
    /// The key at fault, such as `period` or `threshold`; empty where the whole file is.
    pub parameter: String,
    /// The place of that key.
    pub place: Place,
    /// The reason.
    pub kind: FlightErrorKind,
}

/// A place in a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file, if the flight was read from one.
    pub file: Option<Box<Path>>,
    /// The channel, from 0, if one of them is at fault.
    pub channel: Option<usize>,
    /// The line, from 1, where there is one.
    pub line: Option<usize>,
}

/// The reason that a flight is refused.
#[derive(Debug)]
#[non_exhaustive]
pub enum FlightErrorKind {
    /// The file cannot be opened or written.
    File(io::Error),
    /// The text is not TOML, or has a key that no flight has, or a value of another type. The parser says which.
    Text(String),
    /// The file is of a version that this library does not know.
    Version {
        /// The file's version.
        given: u32,
        /// The version that this library reads and writes.
        known: u32,
    },
    /// A name that is none of these.
    Unknown {
        /// The name.
        given: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A number out of its range.
    Range {
        /// The number.
        given: f64,
        /// The least that is allowed.
        min: f64,
        /// The most that is allowed.
        max: f64,
    },
    /// A parameter that the scheme needs is missing.
    Missing,
    /// A bank starts from its first samples, so that a flight has no `start`.
    NoStart,
    /// Two channels have this name.
    Twice,
    /// The channels differ in more than numbers: in words, filters or counts, so that no bank holds them.
    NotOneBank,
    /// The scheme has no constant in Rust, as it takes the user's generator.
    NoConstant,
    /// The scheme or the filter refuses the value.
    Refused(Box<dyn error::Error + Send + Sync>),
}

impl FlightError {
    pub(crate) fn new(parameter: impl Into<String>, kind: FlightErrorKind) -> Self {
        Self { parameter: parameter.into(), place: Place::default(), kind }
    }

    pub(crate) fn refused(
        parameter: impl Into<String>,
        error: impl Into<Box<dyn error::Error + Send + Sync>>,
    ) -> Self {
        Self::new(parameter, FlightErrorKind::Refused(error.into()))
    }

    pub(crate) fn at(mut self, line: Option<usize>) -> Self {
        self.place.line = self.place.line.or(line);
        self
    }

    pub(crate) fn of_channel(mut self, channel: usize) -> Self {
        self.place.channel = Some(channel);
        self
    }

    pub(crate) fn in_file(mut self, file: &Path) -> Self {
        self.place.file = Some(file.into());
        self
    }
}

impl fmt::Display for FlightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { file, channel, line } = &self.place;
        match (file, line) {
            (Some(file), Some(line)) => write!(f, "{}:{line}: ", file.display())?,
            (Some(file), None) => write!(f, "{}: ", file.display())?,
            (None, Some(line)) => write!(f, "line {line}: ")?,
            (None, None) => {}
        }
        if let Some(channel) = channel {
            write!(f, "channel {channel}: ")?;
        }
        if !self.parameter.is_empty() {
            write!(f, "{} ", self.parameter)?;
        }
        self.kind.fmt(f)
    }
}

impl fmt::Display for FlightErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => write!(f, "cannot be opened: {error}"),
            Self::Text(words) => write!(f, "cannot be read: {words}"),
            Self::Version { given, known } => {
                write!(f, "{given} is not known here, only {known}")
            }
            Self::Unknown { given, known } => {
                write!(f, "`{given}` is unknown; there are {}", known.join(", "))
            }
            Self::Range { given, min, max } => write!(f, "{given} must be in {min}..={max}"),
            Self::Missing => f.write_str("is missing"),
            Self::NoStart => f.write_str("has no place here: a bank starts from its first samples"),
            Self::Twice => f.write_str("names two channels"),
            Self::NotOneBank => f.write_str(
                "differs from the first channel in more than numbers: no bank holds both",
            ),
            Self::NoConstant => f.write_str("has no constant: it takes a generator of yours"),
            Self::Refused(error) => {
                write!(f, "is refused: {error}")?;
                let mut cause = error.source();
                while let Some(own) = cause {
                    write!(f, ": {own}")?;
                    cause = own.source();
                }
                Ok(())
            }
        }
    }
}

/// Its text says all that led to it.
impl error::Error for FlightError {}
