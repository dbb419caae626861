//! Errors of reading a flight file, as values that a program can match.

use crate::visible;
use catalogue::run::SampleType;
use std::path::Path;
use std::{error, fmt, io};

/// Error of a flight file that cannot be read, or whose parts do not fit together.
#[derive(Debug)]
pub struct FlightError {
    /// Key of the wrong value, such as `period` or `threshold`; empty if no single key is wrong.
    pub parameter: String,
    /// Position of the wrong value.
    pub place: Place,
    /// Reason that the value is wrong.
    pub kind: FlightErrorKind,
}

/// Position in a flight file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Path of the file; `None` if the flight was parsed from text.
    pub file: Option<Box<Path>>,
    /// Index of the channel, if the error is in a channel.
    pub channel: Option<usize>,
    /// Number of the line, counted from 1, if the flight was parsed from text: that of the wrong key, or of the channel
    /// that lacks it, or 1.
    pub line: Option<usize>,
}

/// Reason that a flight file is refused.
#[derive(Debug)]
#[non_exhaustive]
pub enum FlightErrorKind {
    /// The file cannot be opened or written.
    File(io::Error),
    /// The text is not TOML, or it has an unknown key, or a value of a wrong type. Holds the parser's message.
    Text(String),
    /// The file's version is unknown to this library.
    Version {
        /// Version of the file.
        given: u32,
        /// Version that this library reads and writes.
        known: u32,
    },
    /// A scheme or a parameter has an unknown name.
    Unknown {
        /// Name in the file.
        given: String,
        /// Names that are allowed.
        known: Vec<String>,
    },
    /// A number is out of its range.
    Range {
        /// Number in the file.
        given: f64,
        /// Smallest number allowed.
        min: f64,
        /// Largest number allowed.
        max: f64,
    },
    /// A parameter that the scheme needs is missing.
    Missing,
    /// The parameter `start` is given, but the scheme has no baseline, and starts from its first samples.
    NoStart,
    /// The setting `step_bits` is given, but the scheme has no steps.
    NoSteps,
    /// Two channels have the same name.
    Twice,
    /// Two channels differ in a parameter that is not a number, such as a count or a filter. A
    /// [`Bank`](spikewire::Bank) cannot hold both.
    NotOneBank,
    /// The scheme cannot be written as a constant in Rust, because it needs a random generator of the user's.
    NoConstant,
    /// A parameter that is a number is given as a text.
    Quoted,
    /// The period is so short that it is likely given in ms.
    Period {
        /// Period in the file.
        given: u32,
        /// Shortest period allowed, in µs.
        min: u32,
        /// Longest period allowed, in µs.
        max: u32,
    },
    /// The unit is written in a way that is not read here.
    Unit {
        /// Unit in the file.
        given: String,
        /// Unit that is meant.
        meant: &'static str,
    },
    /// A channel of a firmware has no unit, so that its samples could be too large or too small by any factor.
    NoUnit {
        /// Name of the channel.
        name: String,
    },
    /// The sample type changes the value by more than a tenth.
    Rounded {
        /// Number in the file.
        given: f64,
        /// Number that the sample type has in its place.
        nearest: f64,
        /// The sample type.
        sample: SampleType,
    },
    /// The scheme or the filter refuses the value, with this error, which names the value.
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
        // The error of a scheme or a filter names its parameter itself.
        if !self.parameter.is_empty() && !matches!(self.kind, FlightErrorKind::Refused(_)) {
            write!(f, "{} ", self.parameter)?;
        }
        self.kind.fmt(f)
    }
}

impl fmt::Display for FlightErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => write!(f, "cannot be opened: {error}"),
            Self::Text(words) => write!(f, "cannot be read: {}", visible(words)),
            Self::Version { given, known } => {
                write!(f, "{given} is not known here, only {known}")
            }
            Self::Unknown { given, known } => {
                write!(f, "`{}` is unknown; there are {}", visible(given), known.join(", "))
            }
            Self::Range { given, min, max } => write!(f, "{given} must be in {min}..={max}"),
            Self::Missing => f.write_str("is missing"),
            Self::NoStart => {
                f.write_str("has no place here: only sf, sod and asf have a baseline to start from")
            }
            Self::NoSteps => {
                f.write_str("has no place here: the scheme has no steps whose number could be sent")
            }
            Self::Twice => f.write_str("names two channels"),
            Self::NotOneBank => f.write_str(
                "differs from the first channel in more than numbers: no bank holds both",
            ),
            Self::Quoted => f.write_str("must be a number, without quotation marks"),
            Self::Period { given, min, max } => write!(
                f,
                "{given} is in µs, {min} to {max}; {given} ms are {}",
                u64::from(*given) * 1000
            ),
            Self::Unit { given, meant } => write!(f, "`{}` is written `{meant}`", visible(given)),
            Self::NoUnit { name } => write!(
                f,
                "is missing for {name:?}: give `unit = \"rad/s\"` or \"deg/s\", \"m/s²\" or \"g\", or let the \
                 name end in _rad_s, _dps, _deg_s, _m_s2 or _g"
            ),
            Self::Rounded { given, nearest, sample } => write!(
                f,
                "{given} would be {nearest} in {sample}, which is off by more than a tenth: take another sample type, \
                 more `counts`, or a value that {sample} has"
            ),
            Self::NoConstant => f.write_str("has no constant: it takes a generator of yours"),
            Self::Refused(error) => {
                write!(f, "{error}")?;
                let mut cause = error.source();
                while let Some(error) = cause {
                    write!(f, ": {error}")?;
                    cause = error.source();
                }
                Ok(())
            }
        }
    }
}

/// The text contains all causes, so [`source`](error::Error::source) returns none.
impl error::Error for FlightError {}
