//! The library's errors, as values. A program matches on an error's kind. The text of an error names settings as the
//! front end (command line, Python, web page) spells them.

use crate::events::EventsKind;
#[cfg(feature = "frames")]
use crate::frames::FramesKind;
use crate::input::{LogKind, TableKind};
#[cfg(feature = "networks")]
use crate::network::{FitKind, LayerKind, ModelKind, NetworkKind, NirKind};
use crate::output::OutputKind;
use crate::spikes::SpikesKind;
use crate::tune::RequestKind;
use catalogue::run::{Given, Spell, Worded, quoted};
use spikewire::ConfigError;
use std::{error, fmt, io};

/// The result of a function of this library.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An error in a request to this library, or in a file that the request names.
#[derive(Debug)]
pub struct Error {
    /// The setting at fault. `None` if no single setting is at fault.
    pub parameter: Option<Given>,
    /// The place at which the fault was found.
    pub place: Place,
    /// The kind of fault, with its details.
    pub kind: Box<ErrorKind>,
}

/// The place of a fault: a file and a spot in that file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Name of the file as the user gave it, or `standard input`.
    pub file: Option<String>,
    /// The line or other spot in the file. `None` if the fault is not tied to one spot.
    pub spot: Option<Spot>,
}

/// A spot in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Spot {
    /// A line, counted from 1.
    Line(u64),
    /// An entry of a settings file, given by its line, counted from 1.
    Entry(u64),
    /// A field of a table: the number of its line, counted from 1, and the name of its column.
    Column(u64, String),
    /// A byte, counted from 0.
    Byte(u64),
    /// A frame of a video, counted from 0.
    Frame(u64),
    /// A named part, such as a layer of a network.
    Part(String),
}

/// The kind of an error, grouped by the part of the library that found it.
#[derive(Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A setting of a scheme is invalid.
    Setting(catalogue::run::ErrorKind),
    /// A request cannot be met.
    Request(RequestKind),
    /// A table of samples cannot be read.
    Table(TableKind),
    /// A flight log cannot be read.
    Log(LogKind),
    /// A stream of events cannot be read or written.
    Events(EventsKind),
    /// A file of spikes cannot be read or written.
    Spikes(SpikesKind),
    /// An output file cannot be written.
    Output(OutputKind),
    /// A data set cannot be made or read.
    #[cfg(all(feature = "datasets", not(target_family = "wasm")))]
    Dataset(crate::dataset::DatasetKind),
    /// A video, or a picture of it, cannot be read or written.
    #[cfg(feature = "frames")]
    Frames(FramesKind),
    /// A trained network cannot be used, or a setting or spikes do not fit the network.
    #[cfg(feature = "networks")]
    Network(NetworkKind),
    /// A NIR file (a network as a graph) cannot be read, or its graph is not supported.
    #[cfg(feature = "networks")]
    Nir(NirKind),
    /// The parameters of a layer of a network are invalid.
    #[cfg(feature = "networks")]
    Layer(LayerKind),
    /// A trained network does not fit a chip or the controller.
    #[cfg(feature = "networks")]
    Fit(FitKind),
    /// The software model of a chip fails when it runs a network.
    #[cfg(feature = "networks")]
    Model(ModelKind),
    /// A serial port cannot be read.
    #[cfg(all(feature = "ports", not(target_family = "wasm")))]
    Port(crate::port::PortKind),
    /// A board at a debug probe cannot be read.
    #[cfg(any(test, feature = "capture"))]
    Capture(crate::rtt::CaptureKind),
    /// A file cannot be opened.
    Open(io::Error),
    /// A file, stream or device cannot be read or written.
    Io(io::Error),
    /// An error of another library that this library uses, with the other library's message.
    Other(Box<dyn error::Error + Send + Sync>),
}

/// Implements the conversions from `$kinds`, the error kinds of one module, to [`Error`]. The kind becomes the variant
/// `$variant` of [`ErrorKind`].
macro_rules! room {
    ($kinds:ty, $variant:ident) => {
        impl From<$kinds> for $crate::Error {
            fn from(kind: $kinds) -> Self {
                Self {
                    parameter: None,
                    place: $crate::Place::default(),
                    kind: Box::new($crate::ErrorKind::$variant(kind)),
                }
            }
        }

        impl $kinds {
            /// Makes an error of this kind about the setting `parameter`.
            #[allow(dead_code)]
            pub(crate) fn of(self, parameter: catalogue::run::Given) -> $crate::Error {
                $crate::Error { parameter: Some(parameter), ..self.into() }
            }

            /// Makes an error of this kind, found at `place`.
            #[allow(dead_code)]
            pub(crate) fn at(self, place: impl Into<$crate::Place>) -> $crate::Error {
                $crate::Error { place: place.into(), ..self.into() }
            }
        }
    };
}
pub(crate) use room;

/// Adds the place of the fault, a file and a spot in it, to the error of a result.
pub(crate) trait At<T> {
    /// Adds the place, unless the error already has a more precise one.
    fn at<P: Into<Place>>(self, place: impl FnOnce() -> P) -> Result<T>;
}

impl<T, E: Into<Error>> At<T> for Result<T, E> {
    fn at<P: Into<Place>>(self, place: impl FnOnce() -> P) -> Result<T> {
        self.map_err(|error| error.into().at(place()))
    }
}

impl Error {
    /// Adds the place, unless the error already has a more precise one.
    #[must_use]
    pub fn at(mut self, place: impl Into<Place>) -> Self {
        let Place { file, spot } = place.into();
        self.place.file = self.place.file.or(file);
        self.place.spot = match (spot, self.place.spot) {
            (Some(Spot::Part(outer)), Some(Spot::Part(inner))) => {
                Some(Spot::Part(format!("{outer}: {inner}")))
            }
            (outer, inner) => inner.or(outer),
        };
        self
    }

    /// Adds `parameter` to the error, as the setting at fault. Replaces an earlier one.
    #[must_use]
    pub fn about(self, parameter: Given) -> Self {
        Self { parameter: Some(parameter), ..self }
    }

    /// Makes the error for a file that cannot be opened.
    pub(crate) fn open(file: impl Into<String>, error: io::Error) -> Self {
        Self { parameter: None, place: Place::of(file), kind: Box::new(ErrorKind::Open(error)) }
    }

    /// Wraps an error of another library.
    pub(crate) fn other(error: impl Into<Box<dyn error::Error + Send + Sync>>) -> Self {
        Self {
            parameter: None,
            place: Place::default(),
            kind: Box::new(ErrorKind::Other(error.into())),
        }
    }

    /// Removes the setting at fault from the error, for a front end that has already named the setting and its value.
    #[must_use]
    pub fn without_subject(self) -> Self {
        Self { parameter: None, ..self }
    }

    /// Returns the file at fault, by the name that the user gave it.
    pub fn file(&self) -> Option<&str> {
        match &*self.kind {
            ErrorKind::Log(LogKind::Unread { error }) => Some(&error.file),
            _ => self.place.file.as_deref(),
        }
    }

    /// Returns the setting that would let the work go on despite the fault, if there is one.
    pub fn remedy(&self) -> Option<&'static str> {
        match &*self.kind {
            ErrorKind::Table(TableKind::Missing { .. } | TableKind::NotFinite { .. })
            | ErrorKind::Log(LogKind::NotFinite { .. }) => Some("skip_non_finite"),
            ErrorKind::Log(LogKind::Unread { error }) => error.kind.rest().map(|_| "accept_cut"),
            ErrorKind::Events(EventsKind::NoWord { .. } | EventsKind::NoDirection { .. }) => {
                Some("drop")
            }
            ErrorKind::Spikes(SpikesKind::Untimed)
            | ErrorKind::Table(TableKind::UnevenRate { .. }) => Some("rate"),
            ErrorKind::Table(TableKind::WhichUnit { .. }) => Some("time_unit"),
            ErrorKind::Request(RequestKind::TooShort { .. }) => Some("hold_out"),
            ErrorKind::Request(RequestKind::NothingToSearch { .. }) => Some("anyway"),
            _ => None,
        }
    }

    /// Returns whether the error is a broken pipe: the program that reads the output has closed the pipe.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(&*self.kind, ErrorKind::Io(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

impl ErrorKind {
    /// Returns the variant's name, for programs that tell errors apart by text.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Setting(kind) => kind.name(),
            Self::Request(kind) => kind.name(),
            Self::Table(kind) => kind.name(),
            Self::Log(kind) => kind.name(),
            Self::Events(kind) => kind.name(),
            Self::Spikes(kind) => kind.name(),
            Self::Output(kind) => kind.name(),
            #[cfg(all(feature = "datasets", not(target_family = "wasm")))]
            Self::Dataset(kind) => kind.name(),
            #[cfg(feature = "frames")]
            Self::Frames(kind) => kind.name(),
            #[cfg(feature = "networks")]
            Self::Network(kind) => kind.name(),
            #[cfg(feature = "networks")]
            Self::Nir(kind) => kind.name(),
            #[cfg(feature = "networks")]
            Self::Layer(kind) => kind.name(),
            #[cfg(feature = "networks")]
            Self::Fit(kind) => kind.name(),
            #[cfg(feature = "networks")]
            Self::Model(kind) => kind.name(),
            #[cfg(all(feature = "ports", not(target_family = "wasm")))]
            Self::Port(kind) => kind.name(),
            #[cfg(any(test, feature = "capture"))]
            Self::Capture(kind) => kind.name(),
            Self::Open(_) => "Open",
            Self::Io(_) => "Io",
            Self::Other(_) => "Other",
        }
    }
}

impl Place {
    /// Returns the place of a fault that concerns a whole file, not a spot in the file.
    pub fn of(file: impl Into<String>) -> Self {
        Self { file: Some(file.into()), spot: None }
    }

    /// Returns the place of a fault: a file, and the line or other spot in the file.
    pub fn spot(file: impl Into<String>, spot: Spot) -> Self {
        Self { file: Some(file.into()), spot: Some(spot) }
    }

    /// Returns the place of a fault in a line of a file. Lines are counted from 1.
    pub fn line(file: impl Into<String>, line: u64) -> Self {
        Self::spot(file, Spot::Line(line))
    }
}

impl From<&str> for Place {
    fn from(file: &str) -> Self {
        Self::of(file)
    }
}

impl From<&String> for Place {
    fn from(file: &String) -> Self {
        Self::of(file)
    }
}

impl From<String> for Place {
    fn from(file: String) -> Self {
        Self::of(file)
    }
}

impl From<&std::path::Path> for Place {
    fn from(file: &std::path::Path) -> Self {
        Self::of(file.display().to_string())
    }
}

impl From<Spot> for Place {
    fn from(spot: Spot) -> Self {
        Self { file: None, spot: Some(spot) }
    }
}

/// Writes the place with the punctuation that follows it in a message, such as `a.csv: line 3: `.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            f.write_str(file)?;
            f.write_str(if matches!(self.spot, Some(Spot::Entry(_))) { ":" } else { ": " })?;
        }
        match &self.spot {
            None => Ok(()),
            Some(Spot::Entry(line)) => write!(f, "{line}: "),
            Some(Spot::Line(line)) => write!(f, "line {line}: "),
            Some(Spot::Column(line, column)) => write!(f, "line {line}, column {column}: "),
            Some(Spot::Byte(byte)) => write!(f, "byte {byte}: "),
            Some(Spot::Frame(frame)) => write!(f, "frame {frame}: "),
            Some(Spot::Part(part)) => write!(f, "{part}: "),
        }
    }
}

impl Worded for Error {
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result {
        write!(f, "{}", self.place)?;
        let about = self.parameter.as_ref();
        match &*self.kind {
            ErrorKind::Setting(kind) => kind.word_about(f, spell, about),
            ErrorKind::Request(kind) => kind.word_about(f, spell, about),
            ErrorKind::Table(kind) => kind.word_about(f, spell, about),
            ErrorKind::Log(kind) => kind.word_about(f, spell, about),
            ErrorKind::Events(kind) => kind.word_about(f, spell, about),
            ErrorKind::Spikes(kind) => kind.word_about(f, spell, about),
            ErrorKind::Output(kind) => kind.word_about(f, spell, about),
            #[cfg(all(feature = "datasets", not(target_family = "wasm")))]
            ErrorKind::Dataset(kind) => kind.word_about(f, spell, about),
            #[cfg(feature = "frames")]
            ErrorKind::Frames(kind) => kind.word_about(f, spell, about),
            #[cfg(feature = "networks")]
            ErrorKind::Network(kind) => kind.word_about(f, spell, about),
            #[cfg(feature = "networks")]
            ErrorKind::Nir(kind) => kind.word_about(f, spell, about),
            #[cfg(feature = "networks")]
            ErrorKind::Layer(kind) => kind.word_about(f, spell, about),
            #[cfg(feature = "networks")]
            ErrorKind::Fit(kind) => kind.word_about(f, spell, about),
            #[cfg(feature = "networks")]
            ErrorKind::Model(kind) => kind.word_about(f, spell, about),
            #[cfg(all(feature = "ports", not(target_family = "wasm")))]
            ErrorKind::Port(kind) => kind.word_about(f, spell, about),
            #[cfg(any(test, feature = "capture"))]
            ErrorKind::Capture(kind) => kind.word_about(f, spell, about),
            ErrorKind::Open(error) => write!(f, "cannot be opened: {error}"),
            ErrorKind::Io(error) => write!(f, "{error}"),
            ErrorKind::Other(error) => write!(f, "{error}"),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.word(f, quoted)
    }
}

impl error::Error for Error {
    fn source(&self) -> Option<&(dyn error::Error + 'static)> {
        match &*self.kind {
            ErrorKind::Open(error) | ErrorKind::Io(error) => Some(error),
            ErrorKind::Other(error) => Some(&**error),
            ErrorKind::Log(LogKind::Unread { error }) => Some(error),
            _ => None,
        }
    }
}

impl From<catalogue::run::Error> for Error {
    fn from(error: catalogue::run::Error) -> Self {
        let catalogue::run::Error { parameter, kind } = error;
        Self { parameter, place: Place::default(), kind: Box::new(ErrorKind::Setting(kind)) }
    }
}

impl From<ConfigError> for Error {
    fn from(error: ConfigError) -> Self {
        catalogue::run::Error::from(error).into()
    }
}

impl From<flight_logs::Error> for Error {
    fn from(error: flight_logs::Error) -> Self {
        let flight_logs::Error { file, kind } = error;
        match kind {
            flight_logs::ErrorKind::Open(error) => Self::open(file, error),
            kind => LogKind::Unread { error: flight_logs::Error { file, kind } }.into(),
        }
    }
}

impl From<io::Error> for Error {
    fn from(error: io::Error) -> Self {
        Self { parameter: None, place: Place::default(), kind: Box::new(ErrorKind::Io(error)) }
    }
}

/// Implements the conversions from other libraries' errors to [`ErrorKind::Other`]. The messages are kept.
macro_rules! foreign {
    ($($(#[$when:meta])* $error:ty),* $(,)?) => {$(
        $(#[$when])*
        impl From<$error> for Error {
            fn from(error: $error) -> Self {
                Self::other(error)
            }
        }
    )*};
}

foreign! {
    fmt::Error,
    serde_json::Error,
    spikewire_cameras::format::FormatError,
    spikewire::link::LinkError,
    #[cfg(feature = "frames")]
    gif::EncodingError,
    #[cfg(feature = "frames")]
    image::ImageError,
    #[cfg(feature = "frames")]
    spikewire_cameras::frame::FrameSize,
    #[cfg(feature = "networks")]
    hdf5_reader::error::Error,
    #[cfg(feature = "networks")]
    toml::ser::Error,
    #[cfg(feature = "networks")]
    spikewire_chips::FormatError,
}

#[cfg(test)]
mod tests {
    use super::{At, Error, Place, Result, Spot};
    use crate::input::TableKind;
    use crate::spikes::SpikesKind;
    use catalogue::run::{Given, Worded};

    fn option(name: &str) -> String {
        format!("--{}", name.replace('_', "-"))
    }

    #[test]
    fn a_front_words_place_setting_and_kind() {
        let column = Place::spot("a.csv", Spot::Column(3, "`rate`".to_owned()));
        let missing = TableKind::Missing { value: "NA".to_owned() };
        for (error, words, remedy) in [
            (
                missing.at(column),
                "a.csv: line 3, column `rate`: value `NA` is missing; --skip-non-finite goes on over such values",
                Some("skip_non_finite"),
            ),
            (
                TableKind::TakesNo { what: "a log" }.of(Given::named("rate")).at("a.ulg"),
                "a.ulg: a log takes no --rate",
                None,
            ),
            (
                TableKind::NotAboveZero.of(Given::listed("rate", Some("x"))).at(Spot::Entry(2)),
                "2: rate x must be a number above 0 and finite",
                None,
            ),
            (TableKind::NotAboveZero.into(), "must be a number above 0 and finite", None),
            (
                SpikesKind::Untimed.into(),
                "messages have times, and these samples none; --rate says how many there are a second",
                Some("rate"),
            ),
        ] {
            assert_eq!(error.spelled(option).to_string(), words);
            assert_eq!(error.remedy(), remedy, "{words}");
        }
    }

    #[test]
    fn the_closest_place_stays() {
        let error = |place| -> Result<()> { Err(TableKind::NoSamples.at(place)) };
        let part = |name: &str| Place::from(Spot::Part(name.to_owned()));
        for (inner, outer, place) in [
            (Place::line("a", 2), Place::of("b"), Place::line("a", 2)),
            (Place::from(Spot::Line(2)), Place::of("b"), Place::line("b", 2)),
            (part("inner"), part("outer"), part("outer: inner")),
        ] {
            let found: Error = error(inner).at(|| outer).unwrap_err();
            assert_eq!(found.place, place);
        }
    }
}
