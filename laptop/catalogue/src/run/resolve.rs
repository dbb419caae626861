//! From what a user asks for, and from the paper and the signal where that leaves something open, to complete settings.

use anyhow::{Context, Error, Result, anyhow, bail};

use super::{Asked, Calibrated, Settings, Value, filter};
use crate::{Found, Info, Kind, Paper, Parameter, Scaled};

/// The known figures of the signal.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// A calibration over the whole of it, where one was needed.
    pub calibrated: Option<&'a Calibrated>,
    /// The first samples, finite: as many as the encoder starts from, or all there are.
    pub first: &'a [f64],
    /// Whether the whole of it could be read before, as the paper's settings need.
    pub can_calibrate: bool,
}

/// The parameters in whose place a calibration stands, if one of them is not given. A list of centres needs none.
pub fn missing(info: &Info, asked: &Asked) -> Option<String> {
    if let Some(Value::Numbers(_)) = asked.get("centres") {
        return None;
    }
    let of_range = |own: &&Parameter| matches!(own.found, Some(Found::Min | Found::Max));
    let found: Vec<&Parameter> = info.parameters.iter().filter(of_range).collect();
    if found.iter().all(|own| asked.get(own.name).is_some()) {
        return None;
    }
    let names: Vec<String> = found.iter().map(|own| format!("`{}`", own.name)).collect();
    Some(names.join(" and "))
}

/// The parameters that a user asks of a scheme, and all that may stand in for those not given.
pub struct Resolve<'a> {
    info: &'static Info,
    /// The parameters given.
    pub asked: &'a Asked,
    /// The known figures of the signal.
    pub known: &'a Known<'a>,
    /// The range of the signal over that of the paper's, if the paper's settings are wanted.
    scale: Option<f64>,
}

impl<'a> Resolve<'a> {
    pub(super) fn new(info: &'static Info, asked: &'a Asked, known: &'a Known<'a>) -> Result<Self> {
        asked.check(info)?;
        let mut resolve = Self { info, asked, known, scale: None };
        if asked.paper {
            let end = |name: &str, found| match asked.get(name) {
                Some(_) => resolve.number(name),
                None => resolve.found(found),
            };
            let (min, max) = (end("min", Found::Min)?, end("max", Found::Max)?);
            if min >= max {
                bail!("`paper`: the signal never leaves {min}");
            }
            resolve.scale = Some((max - min) / Scaled::<f32>::PAPER_RANGE);
        }
        Ok(resolve)
    }

    /// Settings with all parameters that a file records.
    ///
    /// # Errors
    /// One is missing or makes no sense.
    pub fn all(&self) -> Result<Settings> {
        let mut settings = Settings::default();
        for parameter in self.info.parameters.iter().filter(|parameter| parameter.is_recorded) {
            self.settle(parameter.name, &mut settings)?;
        }
        Ok(settings)
    }

    /// Checks that the lower end of a range is below the upper one, which the user, or one of them the signal, has given.
    pub(super) fn check_range(&self, settings: &Settings) -> Result<()> {
        let ends = ["min", "max"].map(|name| settings.get(name).and_then(Value::number));
        let [Some(min), Some(max)] = ends else { return Ok(()) };
        let is_given = ["min", "max"].map(|name| self.user(name).is_some());
        match is_given {
            _ if min < max => Ok(()),
            [false, false] => Ok(()),
            [true, true] => bail!("`min` {min} must be below `max` {max}"),
            [true, false] => bail!("`min` {min} must be below {max}, the signal's maximum"),
            [false, true] => bail!("`max` {max} must be above {min}, the signal's minimum"),
        }
    }

    /// Settings of a population whose `centres` are a list, which says what its neurons and its range would; `None` if
    /// they are one of these words.
    ///
    /// # Errors
    /// It is neither, or one of those is given, too.
    pub fn own_centres(&self, words: &[&str]) -> Result<Option<Settings>> {
        let Some(centres) = self.list("centres", words)? else { return Ok(None) };
        if let Some(option) =
            ["neurons", "min", "max"].iter().find(|name| self.user(name).is_some())
        {
            bail!("`centres` {} says it all; `{option}` contradicts it", Value::from(centres));
        }
        let mut settings = Settings::default();
        settings.set("centres", centres);
        Ok(Some(settings))
    }

    /// Sets one parameter as given, as in the paper, by default, or as the signal tells.
    ///
    /// # Errors
    /// Returns an error if the value is missing or makes no sense.
    pub fn settle(&self, name: &str, settings: &mut Settings) -> Result<()> {
        let parameter = self.parameter(name)?;
        let value = match (self.value(name)?, parameter.found) {
            (None, Some(Found::First)) => {
                settings.set_first(self.found(Found::First)?);
                return Ok(());
            }
            (None, Some(found)) => self.found(found)?.into(),
            (None, None) => return Err(self.needs(name)),
            (Some(Value::Numbers(all)), _) if parameter.kind == Kind::Number => {
                bail!("`{name}` has {} values, one a channel, where it takes one", all.len())
            }
            (Some(Value::Word(filter)), _) if parameter.kind == Kind::Filter => {
                filter::taps(&filter).with_context(|| format!("`{name}` {filter}"))?.into()
            }
            (Some(value), _) => value,
        };
        settings.set(parameter.key(), value);
        Ok(())
    }

    /// A number as given, as in the paper or by default.
    ///
    /// # Errors
    /// Returns an error if the value is missing or not a finite number.
    pub fn number(&self, name: &str) -> Result<f64> {
        let value = self.value(name)?.ok_or_else(|| self.needs(name))?;
        value.number().with_context(|| format!("`{name}` {value} is not a number"))
    }

    /// A value as given, as in the paper or by default.
    ///
    /// # Errors
    /// Returns an error if the value is missing or not one of this parameter.
    pub fn needed(&self, name: &str) -> Result<Value> {
        let value = self.value(name)?;
        value.ok_or_else(|| self.needs(name))
    }

    /// A list of finite numbers; `None` if it is one of these words instead.
    ///
    /// # Errors
    /// Returns an error if the value is missing, or neither a list nor one of the words.
    pub fn list(&self, name: &str, words: &[&str]) -> Result<Option<Vec<f64>>> {
        let value = self.value(name)?.ok_or_else(|| self.needs(name))?;
        match value.word() {
            Some(word) if words.contains(&word) => Ok(None),
            Some(word) => {
                let is_none = |part: &&str| part.trim().parse::<f64>().is_err();
                let part = word.split(',').find(is_none).unwrap_or(word);
                bail!(
                    "`{name}` {word}: `{part}` is neither a finite number, nor is the whole {}",
                    words.join(" or ")
                )
            }
            None => Ok(value.numbers().map(<[f64]>::to_vec)),
        }
    }

    /// The value that the user gave.
    pub fn user(&self, name: &str) -> Option<&Value> {
        self.asked.get(name)
    }

    /// The value that the user gave, else the paper's if that is wanted, else the default.
    ///
    /// # Errors
    /// The scheme has no such parameter, or the value is none of it.
    pub fn value(&self, name: &str) -> Result<Option<Value>> {
        let parameter = self.parameter(name)?;
        if let Some(value) = self.user(name) {
            let checked = parameter.check(value.clone());
            return checked.with_context(|| format!("`{name}` {value}")).map(Some);
        }
        let default = || parameter.default.map(|text| parameter.read_own(text));
        self.paper(parameter).or_else(default).transpose()
    }

    /// The error that a parameter is missing, which is named in backticks.
    pub fn needs(&self, what: &str) -> Error {
        let otherwise = " (or `paper`, for the paper's settings scaled to the signal)";
        let hint = if self.known.can_calibrate { otherwise } else { "" };
        anyhow!("{} needs `{what}`{hint}", self.info.name)
    }

    /// The samples that an encoder starts from: the value before the first, again and again, or the first themselves.
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
        value.context("there is no sample")
    }

    fn parameter(&self, name: &str) -> Result<&'static Parameter> {
        let own = self.info.parameter(name);
        own.with_context(|| format!("{} has no parameter {name}", self.info.name))
    }
}
