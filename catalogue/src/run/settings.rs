//! The parameters of a scheme, complete: all that encoding and decoding need.

use anyhow::{Result, bail};

use super::Options;
use crate::{Found, Info, Kind};

/// Parameters in the signal's unit, as a file of spikes lists them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    entries: Vec<(&'static str, String)>,
    /// The samples that an encoder starts from: one, or a moving window's first. Decoding needs none.
    pub first: Vec<f64>,
}

/// What a file calls the first sample, where the decoder starts with the value of that very sample; the value before
/// it is called as the option is.
const FIRST: &str = "first";

impl Settings {
    /// The names and texts, in the order of a file.
    pub fn entries(&self) -> &[(&'static str, String)] {
        &self.entries
    }

    /// The text of an entry.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(own, _)| *own == name).map(|(_, text)| text.as_str())
    }

    /// A number, if there is such an entry and it is one.
    pub fn number(&self, name: &str) -> Option<f64> {
        number(name, self.get(name)?).ok()
    }

    /// Numbers, if there is such an entry and it is a list of them.
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        numbers(name, self.get(name)?).ok()
    }

    /// Sets an entry, in its place or at the end.
    pub fn set(&mut self, name: &'static str, text: String) {
        match self.entries.iter_mut().find(|(own, _)| *own == name) {
            Some((_, old)) => *old = text,
            None => self.entries.push((name, text)),
        }
    }

    /// Sets the value of the first sample, from which the decoder starts; its spike changes nothing.
    pub(super) fn set_first(&mut self, value: f64) {
        self.set(FIRST, value.to_string());
    }

    /// The decoder's first value: the first sample's, or the one before it.
    pub fn first_value(&self) -> Option<f64> {
        self.number(self.first_key()?)
    }

    /// The entry with the decoder's first value: the first sample's, or the one before it.
    pub(super) fn first_key(&self) -> Option<&'static str> {
        let names = self.entries.iter().map(|(name, _)| *name);
        names.into_iter().find(|name| [FIRST, "start"].contains(name))
    }

    /// Whether the decoder's first value is that of the first sample, whose spike then changes nothing.
    pub fn starts_at_first(&self) -> bool {
        self.get(FIRST).is_some()
    }

    /// These as options that bring them about again.
    pub fn to_options(&self, info: &Info) -> Options {
        let mut options = Options::default();
        for parameter in info.parameters.iter().filter(|parameter| parameter.is_recorded) {
            if let Some(text) = self.get(parameter.key()) {
                // A comma at the end, or one tap alone would be the name of a file.
                let end = if parameter.kind == Kind::Filter { "," } else { "" };
                options.set(parameter.name, &format!("{text}{end}"));
            }
        }
        options
    }

    /// The entries of a scheme among the keys of a file, which are taken from these.
    pub fn take(info: &Info, keys: &mut Vec<(String, String)>) -> Self {
        let mut settings = Self::default();
        let mut take = |name: &'static str| {
            if let Some(place) = keys.iter().position(|(key, _)| key == name) {
                settings.set(name, keys.remove(place).1);
            }
        };
        for parameter in info.parameters.iter().filter(|parameter| parameter.is_recorded) {
            if parameter.found == Some(Found::First) {
                take(FIRST);
            }
            take(parameter.key());
        }
        settings
    }
}

/// Whether a text is a list, or a number, and no word.
pub fn is_list(text: &str) -> bool {
    !text.chars().next().is_some_and(char::is_alphabetic)
}

/// A finite number.
///
/// # Errors
/// It is none.
pub fn number(name: &str, text: &str) -> Result<f64> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => bail!("{name}={value}: it must be finite"),
        Err(_) => bail!("{name}={text} is not a number"),
    }
}

/// Finite numbers with commas between.
pub(super) fn numbers(name: &str, text: &str) -> Result<Vec<f64>> {
    text.split(',').map(|text| number(name, text)).collect()
}

/// Numbers with commas between.
pub(super) fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}
