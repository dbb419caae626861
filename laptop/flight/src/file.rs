//! Reads and writes the flight file, `flight.toml`. It is strict: unknown keys and other versions are errors.
//!
//! | key | value | unless given |
//! |---|---|---|
//! | `version` | 1 | required |
//! | `scheme` | a scheme's short name, such as `sod` | required |
//! | `sample` | `f32`, `i16`, `i32` or fixed point such as `q8.8` | `f32` |
//! | `period` | time from one sample to the next in µs, 1 to 65 535 | required |
//! | `keyframe_every` | samples from one keyframe or heartbeat to the next | the number of samples in 50 ms |
//! | `clock_ppm` | tolerance of the time between samples, in millionths of `period`, 0 to 100 000 | 20 000, for a sensor's own oscillator |
//! | `parameters` | parameters that all channels share | none |
//! | `filter` | `kind` (`low-pass`, `first-order`, `notch`), `corner` or `centre` in Hz, a notch's `q` | none |
//! | `[[channel]]` | `name`; `source`, the column or `topic.field` in a recording; `unit`; `counts` in one unit; `parameters` of this channel alone | `source`: the name; `counts`: 1 |
//!
//! Parameters are in units of samples, which are counts if a channel has `counts`. Frames are those of the link, version 3.

use crate::{Channel, Filter, Flight, FlightError, FlightErrorKind, Parts};
use catalogue::run::{Asked, SET, SampleType, Value};
use catalogue::{Info, Parameter};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::num::NonZeroU16;
use std::path::Path;
use toml::Spanned;

/// Version of the file format that is read and written.
const VERSION: u32 = 1;

/// Time between keyframes in µs if `keyframe_every` is missing.
const KEYFRAMES: u32 = 50_000;

/// Value of `clock_ppm` if it is missing, in millionths: the tolerance of a sensor's own oscillator.
const CLOCK_PPM: u32 = 20_000;

/// Parameters by name, with the position of each name and value in the text.
type Given = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    version: Spanned<u32>,
    scheme: Spanned<String>,
    sample: Option<Spanned<String>>,
    period: Spanned<NonZeroU16>,
    keyframe_every: Option<Spanned<u32>>,
    clock_ppm: Option<Spanned<u32>>,
    filter: Option<Spanned<Filter>>,
    #[serde(default)]
    parameters: Given,
    #[serde(default)]
    channel: Vec<Spanned<FileChannel>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileChannel {
    name: String,
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
        let text = fs::read_to_string(path)
            .map_err(|error| FlightError::new("", FlightErrorKind::File(error)));
        text.and_then(|text| Self::parse(&text)).map_err(|error| error.in_file(path))
    }

    /// Parses the text of a flight file.
    ///
    /// # Errors
    /// Returns an error, with its line, if the text is not TOML, if a key is unknown or missing, or if the parts of the
    /// flight do not [fit together](Self::new).
    pub fn parse(text: &str) -> Result<Self, FlightError> {
        let line =
            |at: usize| Some(1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count());
        let file: File = toml::from_str(text).map_err(|error| {
            let span = error.span();
            let key = span.clone().and_then(|span| text.get(span)).unwrap_or_default();
            let is_key = !key.is_empty()
                && key.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
            let kind = FlightErrorKind::Text(error.message().to_owned());
            FlightError::new(if is_key { key } else { "" }, kind)
                .at(span.and_then(|span| line(span.start)))
        })?;
        let version = *file.version.get_ref();
        if version != VERSION {
            let kind = FlightErrorKind::Version { given: version, known: VERSION };
            return Err(FlightError::new("version", kind).at(line(file.version.span().start)));
        }
        let scheme = scheme(file.scheme.get_ref())
            .map_err(|error| error.at(line(file.scheme.span().start)))?;
        let sample = match &file.sample {
            None => Ok(SampleType::default()),
            Some(name) => name
                .get_ref()
                .parse()
                .map_err(|error| FlightError::refused("sample", error).at(line(name.span().start))),
        }?;
        let period = *file.period.get_ref();
        let usual = (KEYFRAMES / u32::from(period.get())).max(1);
        // Byte offset of each key in the text: of a channel, or without one of the whole flight.
        let mut offsets: BTreeMap<(Option<usize>, String), usize> = BTreeMap::new();
        for (name, span) in [
            ("keyframe_every", file.keyframe_every.as_ref().map(Spanned::span)),
            ("clock_ppm", file.clock_ppm.as_ref().map(Spanned::span)),
            ("filter", file.filter.as_ref().map(Spanned::span)),
        ] {
            if let Some(span) = span {
                offsets.insert((None, name.to_owned()), span.start);
            }
        }
        let mut asked = |given: Given, channel: Option<usize>| -> Result<Asked, FlightError> {
            let mut asked = Asked::default();
            for (name, value) in given {
                let at = name.span().start;
                let read = parameter(scheme, name.get_ref())
                    .and_then(|parameter| Ok((parameter.name, read(parameter, value.get_ref())?)));
                let (name, value) = read.map_err(|error| error.at(line(at)))?;
                if let Some(value) = value {
                    asked.set(name, value);
                    offsets.insert((channel, name.to_owned()), at);
                }
            }
            Ok(asked)
        };
        let shared = asked(file.parameters, None)?;
        let (mut channels, mut starts) = (Vec::new(), Vec::new());
        for (index, channel) in file.channel.into_iter().enumerate() {
            starts.push(channel.span().start);
            let FileChannel { name, source, unit, counts, parameters } = channel.into_inner();
            let asked = asked(parameters, Some(index))?;
            let source = source.unwrap_or_else(|| name.clone());
            channels.push(Channel { name, source, unit, counts: counts.unwrap_or(1.0), asked });
        }
        let parts = Parts {
            scheme,
            sample,
            period,
            keyframe_every: file.keyframe_every.map_or(usual, Spanned::into_inner),
            clock_ppm: file.clock_ppm.map_or(CLOCK_PPM, Spanned::into_inner),
            filter: file.filter.map(Spanned::into_inner),
            shared,
            channels,
        };
        Self::new(parts).map_err(|error| {
            let channel = error.place.channel;
            let key = offsets.get(&(channel, error.parameter.clone()));
            let start = channel.and_then(|channel| starts.get(channel));
            error.at(key.or(start).and_then(|at| line(*at)))
        })
    }

    /// Returns the text of the flight file, with a comment line for each of `comments` at its start.
    pub fn to_toml(&self, comments: &[String]) -> String {
        let mut text = String::new();
        for comment in comments {
            let _ = writeln!(text, "# {comment}");
        }
        let _ = writeln!(
            text,
            "version = {VERSION}\nscheme = \"{}\"\nsample = \"{}\"\nperiod = {} # µs\nkeyframe_every = {} # samples\n\
             clock_ppm = {}",
            self.scheme.name, self.sample, self.period, self.keyframe_every, self.clock_ppm
        );
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

/// Converts a TOML value to the value of a parameter; returns `None` for a flag that is `false`.
///
/// # Errors
/// Returns an error if the value's type or range is wrong for the parameter.
fn read(parameter: &Parameter, value: &toml::Value) -> Result<Option<Value>, FlightError> {
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
        toml::Value::String(text) => return parameter.read(text).map(Some).map_err(refused),
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
