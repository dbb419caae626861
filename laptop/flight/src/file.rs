//! Reads and writes the flight file, `flight.toml`. It is strict: unknown keys and other versions are errors.
//!
//! | key | value | unless given |
//! |---|---|---|
//! | `version` | 1 | required |
//! | `scheme` | a scheme's short name, such as `sod` | required |
//! | `sample` | `f32`, `i16`, `i32` or fixed point such as `q8.8` | `f32` |
//! | `period` | time from one sample to the next in µs, 30 to 16 777 215 | required |
//! | `keyframe_every` | samples from one keyframe or heartbeat to the next | the number of samples in 50 ms |
//! | `clock_ppm` | tolerance of the time between samples, in millionths of `period`, 0 to 100 000 | 20 000, for a sensor's own oscillator |
//! | `step_bits` | low bits of a channel's step number in a frame, 0 to 4: with 4, step codes heal at the next event after a loss of 7 net steps or fewer | 0 |
//! | `gathering` | longest time that events wait for others in µs, 0 to 1 000 000: fewer frames, later values | 0 |
//! | `full_every` | time from one full frame to the next in µs, 0 to 10 000 000; a receiver that joins waits for one | 524 288 |
//! | `parameters` | parameters that all channels share | none |
//! | `filter` | `kind` (`low-pass`, `first-order`, `notch`), `corner` or `centre` in Hz, a notch's `q` | none |
//! | `[[channel]]` | `name`; `source`, the column or `topic.field` in a recording; `unit`; `counts` in one unit; `parameters` of this channel alone | `source`: the name; `unit`: as the end of a name says, such as `_dps`; `counts`: 1 |
//!
//! Parameters are in units of samples, which are counts if a channel has `counts`. Numbers are written as numbers, not as
//! texts. A path of a parameter, such as that of a file of taps, is relative to the flight file. Frames are those of the
//! link, version 4. `start` among the parameters of `sf`, `sod` and `asf` is the baseline before the first sample: with 0, all baselines are
//! multiples of the threshold. The sender alone decides `step_bits`, `gathering`, `full_every` and `start`, and its frames say
//! what a receiver must know of them, so that none of the four is a part of the fingerprint.

use crate::keys::Keys;
use crate::{Channel, Filter, Flight, FlightError, FlightErrorKind, Parts, escaped};
use catalogue::run::{Asked, SET, SampleType, Value};
use catalogue::{Info, Kind, Parameter};
use serde::Deserialize;
use spikewire::link::Transmitter;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// Version of the file format that is read and written.
const VERSION: u32 = 1;

/// Time between keyframes in µs if `keyframe_every` is missing.
const KEYFRAMES: u32 = 50_000;

/// Value of `clock_ppm` if it is missing, in millionths: the tolerance of a sensor's own oscillator.
const CLOCK_PPM: u32 = 20_000;

/// Parameters by name, with the position of each name in the text.
type Given = BTreeMap<Spanned<String>, toml::Value>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    version: Option<u32>,
    scheme: Option<String>,
    sample: Option<String>,
    period: Option<NonZeroU32>,
    keyframe_every: Option<u32>,
    clock_ppm: Option<u32>,
    #[serde(default)]
    step_bits: u8,
    #[serde(default)]
    gathering: u32,
    full_every: Option<u32>,
    filter: Option<FileFilter>,
    #[serde(default)]
    parameters: Given,
    #[serde(default)]
    channel: Vec<FileChannel>,
}

/// A [`Filter`] with all keys of its kinds, so that the parser tells the place of a wrong one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileFilter {
    kind: Option<String>,
    corner: Option<f32>,
    centre: Option<f32>,
    q: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileChannel {
    name: Option<String>,
    source: Option<String>,
    #[serde(default)]
    unit: String,
    counts: Option<f64>,
    #[serde(default)]
    parameters: Given,
}

impl Flight {
    /// Reads a flight file.
    ///
    /// # Errors
    /// Returns an error, with path and line, if the file cannot be read or is [not a valid flight](Self::parse).
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FlightError> {
        let path = path.as_ref();
        let directory = path.parent().unwrap_or(Path::new(""));
        let text = fs::read_to_string(path)
            .map_err(|error| FlightError::new("", FlightErrorKind::File(error)));
        text.and_then(|text| Self::parse_in(&text, directory)).map_err(|error| error.in_file(path))
    }

    /// Parses the text of a flight file. The path of a file of taps is relative to the working directory.
    ///
    /// # Errors
    /// Returns an error, with the line of the wrong key, if the text is not TOML, if a key is unknown or missing, or if
    /// the parts of the flight do not [fit together](Self::new).
    pub fn parse(text: &str) -> Result<Self, FlightError> {
        Self::parse_in(text, Path::new(""))
    }

    /// Parses the text of a flight file in this directory.
    fn parse_in(text: &str, directory: &Path) -> Result<Self, FlightError> {
        let keys = Keys::of(text);
        let mut files = Vec::new();
        let parts = parts(text, directory, &keys, &mut files);
        let mut flight = parts.and_then(Self::new).map_err(|error| {
            let line = keys.line_of(error.place.channel, &error.parameter);
            error.at(Some(line))
        })?;
        flight.lines = (0..flight.channels.len()).map(|index| keys.channel_line(index)).collect();
        flight.files = files;
        Ok(flight)
    }

    /// Returns the text of the flight file, with a comment line for each of `comments` at its start.
    pub fn to_toml(&self, comments: &[String]) -> String {
        let mut text = String::new();
        for comment in comments {
            let _ = writeln!(text, "# {}", escaped(comment));
        }
        let _ = writeln!(
            text,
            "version = {VERSION}\nscheme = \"{}\"\nsample = \"{}\"\nperiod = {} # µs\nkeyframe_every = {} # samples\n\
             clock_ppm = {}",
            self.scheme.name, self.sample, self.period, self.keyframe_every, self.clock_ppm
        );
        if self.step_bits > 0 {
            let _ = writeln!(text, "step_bits = {}", self.step_bits);
        }
        if self.gathering > 0 {
            let _ = writeln!(text, "gathering = {} # µs", self.gathering);
        }
        if self.full_every != Transmitter::FULL_EVERY {
            let _ = writeln!(text, "full_every = {} # µs", self.full_every);
        }
        if let Some(filter) = self.filter {
            // Serializing a table of strings and numbers cannot fail.
            let table = toml::Value::try_from(filter).map(|table| table.to_string());
            let _ = writeln!(text, "filter = {}", table.unwrap_or_default());
        }
        if !self.shared.is_empty() {
            let _ = writeln!(text, "parameters = {}", inline(&self.shared));
        }
        for Channel { name, source, unit, counts, asked } in &self.channels {
            let quoted = |text: &str| toml::Value::from(text).to_string();
            let _ = writeln!(text, "\n[[channel]]\nname = {}", quoted(name));
            if source != name {
                let _ = writeln!(text, "source = {}", quoted(source));
            }
            if !unit.is_empty() {
                let _ = writeln!(text, "unit = {}", quoted(unit));
            }
            if (*counts - 1.0).abs() > 0.0 {
                let _ = writeln!(text, "counts = {}", number(*counts));
            }
            if !asked.is_empty() {
                let _ = writeln!(text, "parameters = {}", inline(asked));
            }
        }
        text
    }
}

/// Reads the parts of a flight, and appends the paths of other files that were read to `files`. An error has a line only
/// if that is not the line of its parameter's key.
fn parts(
    text: &str,
    directory: &Path,
    keys: &Keys,
    files: &mut Vec<PathBuf>,
) -> Result<Parts, FlightError> {
    let missing = |name: &str| FlightError::new(name, FlightErrorKind::Missing);
    let file: File = toml::from_str(text).map_err(|error| {
        let kind = FlightErrorKind::Text(error.message().to_owned());
        let at = error.span().map_or(0, |span| span.start);
        let (name, line) = keys.at(at).unwrap_or(("", keys.line(at)));
        FlightError::new(name, kind).at(Some(line))
    })?;
    let version = file.version.ok_or_else(|| missing("version"))?;
    if version != VERSION {
        let kind = FlightErrorKind::Version { given: version, known: VERSION };
        return Err(FlightError::new("version", kind));
    }
    let scheme = scheme(&file.scheme.ok_or_else(|| missing("scheme"))?)?;
    let sample = match file.sample {
        None => SampleType::default(),
        Some(name) => name.parse().map_err(|error| FlightError::refused("sample", error))?,
    };
    let period = file.period.ok_or_else(|| missing("period"))?;
    let usual = (KEYFRAMES / period.get()).max(1);
    let shared = asked(scheme, file.parameters, directory, keys, files)?;
    let mut channels = Vec::new();
    for (index, channel) in file.channel.into_iter().enumerate() {
        let FileChannel { name, source, unit, counts, parameters } = channel;
        let name = name.ok_or_else(|| missing("name").of_channel(index))?;
        let asked = asked(scheme, parameters, directory, keys, files)
            .map_err(|error| error.of_channel(index))?;
        let source = source.unwrap_or_else(|| name.clone());
        channels.push(Channel { name, source, unit, counts: counts.unwrap_or(1.0), asked });
    }
    let filter = file.filter.map(|file| filter(file, keys));
    Ok(Parts {
        scheme,
        sample,
        period,
        keyframe_every: file.keyframe_every.unwrap_or(usual),
        clock_ppm: file.clock_ppm.unwrap_or(CLOCK_PPM),
        step_bits: file.step_bits,
        gathering: file.gathering,
        full_every: file.full_every.unwrap_or(Transmitter::FULL_EVERY),
        filter: filter.transpose()?,
        shared,
        channels,
    })
}

/// Returns the filter, whose kind says which numbers it has.
///
/// # Errors
/// Returns an error if the kind is unknown, or if a number is missing or belongs to another kind.
fn filter(file: FileFilter, keys: &Keys) -> Result<Filter, FlightError> {
    /// Kinds of filters, each with the numbers that it has.
    const KINDS: [(&str, &[&str]); 3] =
        [("first-order", &["corner"]), ("low-pass", &["corner"]), ("notch", &["centre", "q"])];
    let error = |name: &str, kind| Err(FlightError::new(name, kind));
    let missing = |name: &str| {
        let line = keys.line_of(None, "filter");
        Err(FlightError::new(name, FlightErrorKind::Missing).at(Some(line)))
    };
    let unknown = |given: &str, known: &[&str]| {
        let known = known.iter().map(|name| (*name).to_owned()).collect();
        FlightErrorKind::Unknown { given: given.to_owned(), known }
    };
    let FileFilter { kind, corner, centre, q } = file;
    let Some(kind) = kind else { return missing("kind") };
    let Some((_, numbers)) = KINDS.iter().find(|(name, _)| *name == kind) else {
        return error("kind", unknown(&kind, &KINDS.map(|(name, _)| name)));
    };
    for (name, number) in [("corner", corner), ("centre", centre), ("q", q)] {
        match (number, numbers.contains(&name)) {
            (None, true) => return missing(name),
            (Some(_), false) => return error(name, unknown(name, numbers)),
            _ => {}
        }
    }
    let [corner, centre, q] = [corner, centre, q].map(Option::unwrap_or_default);
    Ok(match kind.as_str() {
        "first-order" => Filter::FirstOrder { corner },
        "low-pass" => Filter::LowPass { corner },
        _ => Filter::Notch { centre, q },
    })
}

/// Reads the parameters of a scheme, and appends the paths of their files to `files`.
///
/// # Errors
/// Returns an error if the scheme has no parameter of a name, or if a value is wrong for its parameter.
fn asked(
    scheme: &'static Info,
    given: Given,
    directory: &Path,
    keys: &Keys,
    files: &mut Vec<PathBuf>,
) -> Result<Asked, FlightError> {
    let mut asked = Asked::default();
    for (name, value) in given {
        let line = Some(keys.line(name.span().start));
        let parameter = parameter(scheme, name.get_ref()).map_err(|error| error.at(line))?;
        if let Some(value) = read(parameter, &value, directory).map_err(|error| error.at(line))? {
            asked.set(parameter.name, value);
        }
        if let (Kind::Filter, Some(text)) = (parameter.kind, value.as_str()) {
            // A shape or a list is no file.
            files.extend(Some(directory.join(text)).filter(|path| path.is_file()));
        }
    }
    Ok(asked)
}

/// Returns the scheme of this name.
///
/// # Errors
/// Returns an error, with all names, if there is no such scheme.
fn scheme(name: &str) -> Result<&'static Info, FlightError> {
    catalogue::INFO.iter().find(|info| info.name == name).ok_or_else(|| {
        let known = catalogue::INFO.iter().map(|info| info.name.to_owned()).collect();
        FlightError::new("scheme", FlightErrorKind::Unknown { given: name.to_owned(), known })
    })
}

/// Returns the scheme's parameter of this name.
///
/// # Errors
/// Returns an error, with all names, if the scheme has no such parameter.
fn parameter(scheme: &'static Info, name: &str) -> Result<&'static Parameter, FlightError> {
    scheme.parameter(name).ok_or_else(|| {
        let known = scheme.parameters.iter().map(|parameter| parameter.name.to_owned()).collect();
        FlightError::new("parameters", FlightErrorKind::Unknown { given: name.to_owned(), known })
    })
}

/// Converts a TOML value to the value of a parameter; returns `None` for a flag that is `false`. The path of a file of
/// taps is relative to `directory`.
///
/// # Errors
/// Returns an error if the value's type or range is wrong for the parameter.
fn read(
    parameter: &Parameter,
    value: &toml::Value,
    directory: &Path,
) -> Result<Option<Value>, FlightError> {
    let of_another_type = || {
        let kind = FlightErrorKind::Text("must be a number, a list of them or a text".to_owned());
        FlightError::new(parameter.name, kind)
    };
    let number = |value: &toml::Value| match value {
        toml::Value::Integer(whole) => Some(*whole as f64),
        toml::Value::Float(number) => Some(*number),
        _ => None,
    };
    let refused = |error| FlightError::refused(parameter.name, error);
    let value = match value {
        toml::Value::Boolean(false) => return Ok(None),
        toml::Value::Boolean(true) => SET,
        toml::Value::String(_) if matches!(parameter.kind, Kind::Number | Kind::Count) => {
            return Err(FlightError::new(parameter.name, FlightErrorKind::Quoted));
        }
        toml::Value::String(text) => {
            return parameter.read_in(text, directory).map(Some).map_err(refused);
        }
        toml::Value::Array(all) => {
            let all: Option<Vec<f64>> = all.iter().map(number).collect();
            Value::Numbers(all.ok_or_else(of_another_type)?)
        }
        value => Value::Number(number(value).ok_or_else(of_another_type)?),
    };
    parameter.check(value).map(Some).map_err(refused)
}

/// Returns parameters as an inline table, `{ name = value, name = value }`.
fn inline(asked: &Asked) -> String {
    let all = asked.iter().map(|(name, value)| {
        let value = match value {
            value if *value == SET => true.into(),
            Value::Number(value) => number(*value),
            Value::Count(count) => toml::Value::from(count.cast_signed()),
            Value::Word(word) => word.as_ref().into(),
            Value::Numbers(all) => {
                all.iter().map(|value| number(*value)).collect::<Vec<_>>().into()
            }
        };
        format!("{name} = {value}")
    });
    format!("{{ {} }}", all.collect::<Vec<_>>().join(", "))
}

/// Returns a number as a TOML integer if it is whole, otherwise as a float.
fn number(value: f64) -> toml::Value {
    match value.to_string().parse::<i64>() {
        Ok(whole) => whole.into(),
        Err(_) => value.into(),
    }
}
