//! From what a user gave, and from the paper and the signal where that leaves something open, to complete settings.

use std::collections::BTreeMap;

use anyhow::{Context, Error, Result, anyhow, bail};

use super::settings::list;
use super::{Calibrated, Settings, filter};
use crate::{Found, Info, Kind, Paper, Parameter, Scaled};

/// What a user gave, by the names of the parameters.
#[derive(Clone, Debug, Default)]
pub struct Options {
    given: BTreeMap<String, String>,
    /// The paper's settings, scaled to the signal's range, for what is not given.
    pub paper: bool,
}

impl Options {
    /// Sets a parameter; a flag with any text.
    pub fn set(&mut self, name: &str, text: &str) {
        self.given.insert(name.to_owned(), text.to_owned());
    }

    /// Takes a parameter back.
    pub fn unset(&mut self, name: &str) {
        self.given.remove(name);
    }

    /// What was given.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.given.get(name).map(String::as_str)
    }

    /// All that was given, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.given.iter().map(|(name, text)| (name.as_str(), text.as_str()))
    }

    /// With these for what was not given.
    #[must_use]
    pub fn or(&self, others: &Self) -> Self {
        let mut given = others.given.clone();
        given.extend(self.given.clone());
        Self { given, paper: self.paper || others.paper }
    }

    /// Whether no parameter is given.
    pub fn is_empty(&self) -> bool {
        self.given.is_empty()
    }

    /// Refuses what the scheme does not take.
    ///
    /// # Errors
    /// Such a parameter is given.
    pub fn check(&self, info: &Info) -> Result<()> {
        let has = |name: &str| info.parameters.iter().any(|own| own.name == name);
        let Some(name) = self.given.keys().find(|name| !has(name)) else { return Ok(()) };
        let taken: Vec<String> =
            info.parameters.iter().map(|own| format!("--{}", own.name)).collect();
        bail!("{} takes no --{name}; it takes {}", info.name, taken.join(" "))
    }
}

/// What is known of the signal.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// A calibration over the whole of it, where one was needed.
    pub calibrated: Option<&'a Calibrated>,
    /// The first samples, finite: as many as the encoder starts from, or all there are.
    pub first: &'a [f64],
    /// Whether the whole of it could be read before, as `--paper` needs.
    pub can_calibrate: bool,
}

/// The parameters in whose place a calibration stands, if one of them is not given.
pub fn missing(info: &Info, options: &Options) -> Option<String> {
    let of_range = |own: &&Parameter| matches!(own.found, Some(Found::Min | Found::Max));
    let found: Vec<&Parameter> = info.parameters.iter().filter(of_range).collect();
    if found.iter().all(|own| options.get(own.name).is_some()) {
        return None;
    }
    let names: Vec<String> = found.iter().map(|own| format!("--{}", own.name)).collect();
    Some(names.join(" and "))
}

/// What a user gave to a scheme, with all that may stand in for what is not given.
pub struct Asked<'a> {
    info: &'static Info,
    /// What was given.
    pub options: &'a Options,
    /// What is known of the signal.
    pub known: &'a Known<'a>,
    /// The range of the signal over that of the paper's, if the paper's settings are wanted.
    scale: Option<f64>,
}

impl<'a> Asked<'a> {
    pub(super) fn new(
        info: &'static Info,
        options: &'a Options,
        known: &'a Known<'a>,
    ) -> Result<Self> {
        options.check(info)?;
        let mut asked = Self { info, options, known, scale: None };
        if options.paper {
            let end = |name: &str, found| match options.get(name) {
                Some(text) => finite(name, text),
                None => asked.found(found),
            };
            let (min, max) = (end("min", Found::Min)?, end("max", Found::Max)?);
            if min >= max {
                bail!("--paper: the signal never leaves {min}");
            }
            asked.scale = Some((max - min) / Scaled::<f32>::PAPER_RANGE);
        }
        Ok(asked)
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

    /// Sets one parameter as given, as in the paper, by default, or as the signal tells.
    ///
    /// # Errors
    /// It is missing or makes no sense.
    pub fn settle(&self, name: &str, settings: &mut Settings) -> Result<()> {
        let parameter = self.parameter(name)?;
        let text = match (self.text(name), parameter.found) {
            (None, Some(Found::First)) => {
                settings.set_first(self.found(Found::First)?);
                return Ok(());
            }
            (None, Some(found)) => self.found(found)?.to_string(),
            (None, None) => return Err(self.needs(name)),
            (Some(text), _) => match parameter.kind {
                Kind::Number => finite(name, &text)?.to_string(),
                Kind::Count => match text.parse::<u64>() {
                    Ok(count) => count.to_string(),
                    Err(_) => bail!("--{name} {text}: it must be a whole number, 0 or more"),
                },
                Kind::Choice(words) if !words.contains(&text.as_str()) => {
                    bail!("--{name} {text}: there are {}", words.join(", "))
                }
                Kind::Filter => list(&filter::taps(&text)?),
                Kind::Choice(_) | Kind::Flag | Kind::Text => text,
            },
        };
        settings.set(parameter.key(), text);
        Ok(())
    }

    /// A number as given, as in the paper or by default.
    ///
    /// # Errors
    /// There is none, or it is not a finite number.
    pub fn number(&self, name: &str) -> Result<f64> {
        finite(name, &self.text(name).ok_or_else(|| self.needs(name))?)
    }

    /// One of a parameter's words.
    ///
    /// # Errors
    /// There is none, or not this one.
    pub fn word(&self, name: &str) -> Result<String> {
        let mut settings = Settings::default();
        self.settle(name, &mut settings)?;
        Ok(settings.get(name).unwrap_or_default().to_owned())
    }

    /// A list of finite numbers, as a file holds it; `None` if it is one of these words instead.
    ///
    /// # Errors
    /// There is none, or it is neither.
    pub fn list(&self, name: &str, words: &[&str]) -> Result<Option<String>> {
        let list = self.text(name).ok_or_else(|| self.needs(name))?;
        if words.contains(&list.as_str()) {
            return Ok(None);
        }
        let numbers = list.split(',').map(|text| {
            let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            number.map(|number| number.to_string()).with_context(|| {
                format!(
                    "--{name} {list}: `{text}` is neither a finite number, nor is the whole {}",
                    words.join(" or ")
                )
            })
        });
        Ok(Some(numbers.collect::<Result<Vec<_>>>()?.join(",")))
    }

    /// What the user gave.
    pub fn user(&self, name: &str) -> Option<&str> {
        self.options.get(name)
    }

    /// What the user gave, or the paper has if that is wanted, or the default.
    pub fn text(&self, name: &str) -> Option<String> {
        let parameter = self.parameter(name).ok()?;
        let given = self.user(name).map(str::to_owned);
        let default = || parameter.default.map(str::to_owned);
        given.or_else(|| self.paper(parameter)).or_else(default)
    }

    /// That a parameter is missing.
    pub fn needs(&self, what: &str) -> Error {
        let otherwise = " (or --paper, for the paper's settings scaled to the signal)";
        let hint = if self.known.can_calibrate { otherwise } else { "" };
        anyhow!("{} needs --{what}{hint}", self.info.name)
    }

    /// The samples that an encoder starts from: the value before the first, again and again, or the first themselves.
    pub(super) fn first_window(&self, count: usize) -> Result<Vec<f64>> {
        Ok(match self.user("start") {
            Some(start) => vec![finite("start", start)?; count],
            None => self.known.first.iter().copied().take(count).collect(),
        })
    }

    fn paper(&self, parameter: &Parameter) -> Option<String> {
        let scale = self.scale?;
        match parameter.paper {
            Paper::None => None,
            Paper::Text(text) => Some(text.to_owned()),
            Paper::Signal(value) => Some((value * scale).to_string()),
            Paper::Filter(shape) => Some(format!("{shape},peak={scale}")),
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
        let own = self.info.parameters.iter().find(|parameter| parameter.name == name);
        own.with_context(|| format!("{} has no parameter {name}", self.info.name))
    }
}

fn finite(name: &str, text: &str) -> Result<f64> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => bail!("--{name} {value} must be finite"),
        Err(_) => bail!("--{name} {text}: it is not a number"),
    }
}
