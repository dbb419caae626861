//! Errors of settings, as values on which a program can act.

use std::borrow::Cow;
use std::{error, fmt, io};

use spikewire::ConfigError;

use super::words::{Given, Spell, Worded, joined, quoted};
use super::{Needs, SampleType};
use crate::{Info, Kind, kinds};

/// The result of a function that uses settings.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The error of a setting, or of settings that contradict each other.
#[derive(Debug)]
pub struct Error {
    /// The setting at fault, if it is a single one.
    pub parameter: Option<Given>,
    /// The kind of fault, with its details.
    pub kind: ErrorKind,
}

kinds! {
    /// The reason that settings are invalid.
    pub enum ErrorKind by spell of subject {
        // A value that is none of its parameter.
        NotANumber => ("{subject} is not a number"),
        NotAList => ("{subject} is no list of numbers"),
        NotFinite { number: f64 } => ("{subject} must be finite, not {number}"),
        NotWhole { min: usize, max: Option<usize> } => ("{subject} must be a whole number{}", whole(*min, *max)),
        NotOneOf { words: &'static [&'static str] } => ("{subject}: there are {}", words.join(", ")),
        NotOfKind { kind: Kind } => ("{subject} must be {}", kind.words()),
        NeitherListNorWord { part: String, words: String } =>
            ("{subject}: `{part}` is neither a finite number, nor is the whole {words}"),
        NeitherNumberNorThresholds => ("{subject} is neither a number nor one of thresholds, `2x`"),
        Empty => ("{subject} must not be empty"),
        OutOfRange { error: ConfigError } => ("{error}"),
        NotBelow { end: End } => ("{subject} must be {}", end.words(spell)),
        Vanishes { sample: SampleType } => (
            "{subject} is 0 in {sample}, whose step is {}; a type with more bits after the point, or f32, would hold it",
            sample.step()
        ),
        // Filters.
        NoShape => ("{subject}: there is no such shape; there are {SHAPES}"),
        NoTaps { error: io::Error } =>
            ("{subject}: neither {SHAPES}, nor taps such as 0.5,1,0.5, nor a file that can be read: {error}"),
        LengthOfShape { length: String, most: usize } => ("{subject}: the length `{length}` must be 1 to {most}"),
        PartOfShape { part: &'static str, text: String } => ("{subject}: {part}: `{text}` must be a number above 0"),
        ScaleOfShape => ("{subject}: what is after the comma must be peak=NUMBER or sum=NUMBER"),
        BadTap { file: String, line: usize, number: usize, word: String } =>
            ("{subject}: {file}: line {line}, number {number}: `{word}` is not a finite number"),
        NoTap { file: String } => ("{subject}: {file}: empty; a filter needs a tap at least"),
        // Several channels.
        OneAChannel { values: usize, channels: usize } => (
            "{subject} has {values} values, one a channel, for {channels} channel{}",
            if *channels == 1 { "" } else { "s" }
        ),
        OtherChannels { values: usize, other: &'static str, count: usize } =>
            ("{subject} has {values} values, one a channel, and {} {count}", spell(other)),
        TakesOne { values: usize } => ("{subject} has {values} values, one a channel, where it takes one"),
        // Settings that are missing, unknown, or contradict each other.
        NoScheme => ("there is no scheme {subject}; there are {}", schemes()),
        NoSampleType { name: String } =>
            ("no sample type `{name}`; there are f32, i16, i32, and qI.F with I + F = 16 or 32"),
        TakesNo { scheme: &'static Info } => ("{} takes no {subject}; it takes {}", scheme.name, taken(scheme, spell)),
        Missing { scheme: &'static Info, or: Vec<&'static str>, can_be_papers: bool } => (
            "{} needs {}{}",
            scheme.name,
            joined(or, spell, " or "),
            if *can_be_papers {
                format!(" (or {}, for the paper's settings scaled to the signal)", spell("paper"))
            } else {
                String::new()
            }
        ),
        NeedsSignal { scheme: &'static Info, needs: Needs } =>
            ("{} needs {}, which a signal tells", scheme.name, needs.spelled(spell)),
        SaysItAll { by: Given } => ("{} says it all; {subject} contradicts it", by.subject(spell)),
        ListSaysItAll { by: &'static str } => ("{} is a list, which says it all; {subject} contradicts it", spell(by)),
        TakesNoOther { other: &'static str } => ("{subject} takes no {}", spell(other)),
        NotBoth { scheme: &'static Info, other: &'static str } =>
            ("{} takes {subject} or {}, not both", scheme.name, spell(other)),
        GoesWith { other: &'static str } => ("{subject} goes with {}", spell(other)),
        ComparesOnlyBy { other: Given } => ("{subject} compares by {} only", other.subject(spell)),
        NoSuchForm { criterion: &'static str } =>
            ("{subject} with criterion {criterion}: there are aligned with sub or mul, and toolbox with mul"),
        NoSuchEdges => ("{subject}: there are linear, log, and lists of numbers"),
        // A signal that does not tell what it should.
        NoSample => ("there is no sample"),
        NeverLeaves { value: f64 } => ("{subject}: the signal never leaves {value}"),
        NotCalibrated => ("{subject}: no signal is known"),
        NoThreshold { error: ConfigError, takes_magnitudes: bool } => (
            "{subject} gives no threshold{}: {error}",
            if *takes_magnitudes {
                String::new()
            } else {
                format!(" ({} takes that of the differences' magnitudes)", spell("magnitudes"))
            }
        ),
        // Files of spikes.
        Lacking { or: Option<&'static str> } => (
            "the header lacks `# {subject}=`{}; is it a file of spikes?",
            or.map_or(String::new(), |name| format!(" or `# {name}=`"))
        ),
        // What a scheme does not have.
        MemoryUnknown { scheme: &'static Info } => ("the memory of {} is not known here", scheme.name),
        NotMeasured { scheme: &'static Info } => ("{} is not among the codecs that were measured", scheme.name),
        NoConstant { scheme: &'static Info } => ("{} has no constant", scheme.name),
        NoConstantOfWidths => ("companded centres with widths of their own have no constant; list the centres"),
        NoNameInRust { sample: SampleType } => ("{sample} has no name in Rust"),
        DamagedState => ("the state is damaged, or another scheme's"),
        UnwrittenState => ("the state cannot be written"),
    }
}

/// The other end of a range, which the faulty one must be below or above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// An upper end that was given.
    Max(f64),
    /// The maximum of the signal.
    SignalMax(f64),
    /// The minimum of the signal.
    SignalMin(f64),
}

impl End {
    fn words(self, spell: Spell) -> String {
        match self {
            Self::Max(max) => format!("below {} {max}", spell("max")),
            Self::SignalMax(max) => format!("below {max}, the signal's maximum"),
            Self::SignalMin(min) => format!("above {min}, the signal's minimum"),
        }
    }
}

pub(super) const SHAPES: &str = "triang:N, hann:N, gauss:N or gauss:N:ALPHA";

fn whole(min: usize, max: Option<usize>) -> String {
    match max {
        None => format!(", {min} or more"),
        Some(max) => format!(" in {min}..={max}"),
    }
}

fn schemes() -> String {
    crate::INFO.iter().map(|info| info.name).collect::<Vec<_>>().join(", ")
}

fn taken(scheme: &Info, spell: Spell) -> String {
    let names: Vec<&str> = scheme.parameters.iter().map(|own| own.name).collect();
    joined(&names, spell, " ")
}

impl Error {
    /// Makes the error of a setting.
    pub fn of(parameter: Given, kind: ErrorKind) -> Self {
        Self { parameter: Some(parameter), kind }
    }

    /// Makes the error for a name of which there is no scheme.
    pub fn no_scheme(name: &str) -> Self {
        Self::of(Given::listed(&quoted(name), None::<&str>), ErrorKind::NoScheme)
    }

    /// Makes the error for a parameter that a scheme does not have.
    pub fn takes_no(scheme: &'static Info, name: impl Into<Cow<'static, str>>) -> Self {
        Self::of(Given::named(name), ErrorKind::TakesNo { scheme })
    }

    /// Removes the setting and its value, for a front end that has named them already.
    #[must_use]
    pub fn without_subject(self) -> Self {
        Self { parameter: None, ..self }
    }
}

impl From<ErrorKind> for Error {
    fn from(kind: ErrorKind) -> Self {
        Self { parameter: None, kind }
    }
}

impl From<ConfigError> for Error {
    fn from(error: ConfigError) -> Self {
        let parameter = match error {
            ConfigError::NotPositive { parameter, value }
            | ConfigError::Negative { parameter, value }
            | ConfigError::NotFinite { parameter, value }
            | ConfigError::OutOfRange { parameter, value, .. }
            | ConfigError::NotRising { parameter, value, .. } => {
                Some(Given::listed(parameter, Some(value)))
            }
            ConfigError::AllZero { parameter } => Some(Given::listed(parameter, None::<&str>)),
            _ => None,
        };
        Self { parameter, kind: ErrorKind::OutOfRange { error } }
    }
}

impl Worded for Error {
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result {
        self.kind.word_about(f, spell, self.parameter.as_ref())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.word(f, quoted)
    }
}

impl error::Error for Error {
    fn source(&self) -> Option<&(dyn error::Error + 'static)> {
        match &self.kind {
            ErrorKind::NoTaps { error } => Some(error),
            ErrorKind::OutOfRange { error } | ErrorKind::NoThreshold { error, .. } => Some(error),
            _ => None,
        }
    }
}
