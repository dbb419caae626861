//! Completes the parameters that a user gave by values from the paper and the signal.

use super::error::{End, Error, ErrorKind, Result};
use super::words::Given;
use super::{Asked, Calibrated, Needs, Settings, Value, filter};
use crate::{Found, Info, Kind, Paper, Parameter, Scaled};

/// The figures of the signal that are known.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// Calibration over the whole signal, if it was needed.
    pub calibrated: Option<&'a Calibrated>,
    /// First samples, all finite: as many as the encoder starts from, or all there are.
    pub first: &'a [f64],
    /// Whether the whole signal can be read in advance, as the paper's values require.
    pub can_calibrate: bool,
}

/// Returns the parameters that a calibration would replace, if one of them is missing. A list of centres needs none.
pub fn missing(info: &Info, asked: &Asked) -> Option<Needs> {
    if let Some(Value::Numbers(_)) = asked.get("centres") {
        return None;
    }
    let of_range = |own: &&Parameter| matches!(own.found, Some(Found::Min | Found::Max));
    let found: Vec<&Parameter> = info.parameters.iter().filter(of_range).collect();
    if found.iter().all(|own| asked.get(own.name).is_some()) {
        return None;
    }
    Some(Needs::All(found.iter().map(|own| own.name).collect()))
}

/// The parameters that a user gave to a scheme, and everything that may replace missing ones.
pub struct Resolve<'a> {
    info: &'static Info,
    /// The parameters given.
    pub asked: &'a Asked,
    /// The figures of the signal that are known.
    pub known: &'a Known<'a>,
    /// Ratio of the signal's range to that of the paper's signal, if the paper's values are wanted.
    scale: Option<f64>,
}

impl<'a> Resolve<'a> {
    pub(super) fn new(info: &'static Info, asked: &'a Asked, known: &'a Known<'a>) -> Result<Self> {
        asked.check(info)?;
        let mut resolve = Self { info, asked, known, scale: None };
        if asked.paper {
            let end = |name: &'static str, found| match asked.get(name) {
                Some(_) => resolve.number(name),
                None => resolve.found(found),
            };
            let (min, max) = (end("min", Found::Min)?, end("max", Found::Max)?);
            if min >= max {
                let kind = ErrorKind::NeverLeaves { value: min };
                return Err(Error::of(Given::named("paper"), kind));
            }
            resolve.scale = Some((max - min) / Scaled::<f32>::PAPER_RANGE);
        }
        Ok(resolve)
    }

    /// Makes settings with all parameters that a file records.
    ///
    /// # Errors
    /// Returns an error if a parameter is missing or invalid.
    pub fn all(&self) -> Result<Settings> {
        let mut settings = Settings::default();
        for parameter in self.info.parameters.iter().filter(|parameter| parameter.is_recorded) {
            self.settle(parameter.name, &mut settings)?;
        }
        Ok(settings)
    }

    /// Checks that the lower end of a range is below the upper one. Both come from the user, or one of them from the
    /// signal.
    pub(super) fn check_range(&self, settings: &Settings) -> Result<()> {
        let ends = ["min", "max"].map(|name| settings.get(name).and_then(Value::number));
        let [Some(min), Some(max)] = ends else { return Ok(()) };
        let is_given = ["min", "max"].map(|name| self.user(name).is_some());
        let (given, end) = match is_given {
            _ if min < max => return Ok(()),
            [false, false] => return Ok(()),
            [true, true] => (Given::new("min", min), End::Max(max)),
            [true, false] => (Given::new("min", min), End::SignalMax(max)),
            [false, true] => (Given::new("max", max), End::SignalMin(min)),
        };
        Err(Error::of(given, ErrorKind::NotBelow { end }))
    }

    /// Makes settings of a population whose `centres` are a list, which also determines its neurons and its range;
    /// `None` if `centres` is one of these words.
    ///
    /// # Errors
    /// Returns an error if it is neither, or if neurons or range are given too.
    pub fn own_centres(&self, words: &[&str]) -> Result<Option<Settings>> {
        let Some(centres) = self.list("centres", words)? else { return Ok(None) };
        if let Some(option) =
            ["neurons", "min", "max"].iter().find(|name| self.user(name).is_some())
        {
            let by = Given::new("centres", Value::from(centres));
            return Err(Error::of(Given::named(*option), ErrorKind::SaysItAll { by }));
        }
        let mut settings = Settings::default();
        settings.set("centres", centres);
        Ok(Some(settings))
    }

    /// Sets one parameter: to the value given, or that of the paper, the default, or a figure of the signal.
    ///
    /// # Errors
    /// Returns an error if the value is missing or invalid.
    pub fn settle(&self, name: &'static str, settings: &mut Settings) -> Result<()> {
        let parameter = self.parameter(name)?;
        let value = match (self.value(name)?, parameter.found) {
            (None, Some(Found::First)) => {
                settings.set_first(self.found(Found::First)?);
                return Ok(());
            }
            (None, Some(found)) => self.found(found)?.into(),
            (None, None) => return Err(self.needs(&[name])),
            (Some(Value::Numbers(all)), _) if parameter.kind == Kind::Number => {
                let kind = ErrorKind::TakesOne { values: all.len() };
                return Err(Error::of(Given::named(name), kind));
            }
            (Some(Value::Word(filter)), _) if parameter.kind == Kind::Filter => {
                let wrong = |error: Error| Error::of(Given::new(name, &filter), error.kind);
                filter::taps(&filter).map_err(wrong)?.into()
            }
            (Some(value), _) => value,
        };
        settings.set(parameter.key(), value);
        Ok(())
    }

    /// Returns a number: the value given, or that of the paper, or the default.
    ///
    /// # Errors
    /// Returns an error if the value is missing or not a finite number.
    pub fn number(&self, name: &'static str) -> Result<f64> {
        let value = self.needed(name)?;
        let wrong = || Error::of(Given::new(name, &value), ErrorKind::NotANumber);
        value.number().ok_or_else(wrong)
    }

    /// Returns a value: the one given, or that of the paper, or the default.
    ///
    /// # Errors
    /// Returns an error if the value is missing, or is not of the parameter's kind.
    pub fn needed(&self, name: &'static str) -> Result<Value> {
        let value = self.value(name)?;
        value.ok_or_else(|| self.needs(&[name]))
    }

    /// Returns a list of finite numbers; `None` if the value is one of these words.
    ///
    /// # Errors
    /// Returns an error if the value is missing, or is neither a list nor one of the words.
    pub fn list(&self, name: &'static str, words: &[&str]) -> Result<Option<Vec<f64>>> {
        let value = self.needed(name)?;
        match value.word() {
            Some(word) if words.contains(&word) => Ok(None),
            Some(word) => {
                let is_none = |part: &&str| part.trim().parse::<f64>().is_err();
                let part = word.split(',').find(is_none).unwrap_or(word);
                let (part, words) = (part.to_owned(), words.join(" or "));
                let kind = ErrorKind::NeitherListNorWord { part, words };
                Err(Error::of(Given::new(name, word), kind))
            }
            None => Ok(value.numbers().map(<[f64]>::to_vec)),
        }
    }

    /// Returns the value that the user gave.
    pub fn user(&self, name: &str) -> Option<&Value> {
        self.asked.get(name)
    }

    /// Returns the value that the user gave, or the paper's if that is wanted, or the default.
    ///
    /// # Errors
    /// Returns an error if the scheme has no such parameter, or if the value is not of its kind.
    pub fn value(&self, name: &'static str) -> Result<Option<Value>> {
        let parameter = self.parameter(name)?;
        if let Some(value) = self.user(name) {
            return parameter.check(value.clone()).map(Some);
        }
        let default = || parameter.default.map(|text| parameter.read_own(text));
        self.paper(parameter).or_else(default).transpose()
    }

    /// Makes the error that one of these parameters must be given.
    pub fn needs(&self, or: &[&'static str]) -> Error {
        let or = or.to_vec();
        let can_be_papers = self.known.can_calibrate;
        ErrorKind::Missing { scheme: self.info, or, can_be_papers }.into()
    }

    /// Returns the samples from which an encoder starts: the value before the first, repeated, or the first samples.
    pub(super) fn first_window(&self, count: usize) -> Result<Vec<f64>> {
        Ok(match self.user("start") {
            Some(_) => vec![self.number("start")?; count],
            None => self.known.first.iter().copied().take(count).collect(),
        })
    }

    fn paper(&self, parameter: &Parameter) -> Option<Result<Value>> {
        let scale = self.scale?;
        match parameter.paper {
            Paper::None => None,
            Paper::Text(text) => Some(parameter.read_own(text)),
            Paper::Signal(value) => Some(Ok((value * scale).into())),
            Paper::Filter(shape) => Some(Ok(format!("{shape},peak={scale}").into())),
        }
    }

    fn found(&self, found: Found) -> Result<f64> {
        let range = || self.known.calibrated.and_then(Calibrated::range);
        let value = match found {
            Found::First => self.known.first.first().copied(),
            Found::Min => range().map(|(min, _)| min),
            Found::Max => range().map(|(_, max)| max),
        };
        value.ok_or_else(|| ErrorKind::NoSample.into())
    }

    fn parameter(&self, name: &'static str) -> Result<&'static Parameter> {
        self.info.parameter(name).ok_or_else(|| Error::takes_no(self.info, name))
    }
}
