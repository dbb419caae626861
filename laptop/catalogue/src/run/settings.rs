//! Complete parameters of a scheme: all that encoding and decoding need.

use std::ops::RangeInclusive;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use spikewire::{Sample, dynamic, rate};

use super::error::{Error, ErrorKind, Result};
use super::words::Given;
use super::{Asked, SampleType, Value};
use crate::{Found, Info};

/// Parameters in the signal's unit, rounded to a sample type, in the order of a file of spikes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    values: Vec<(&'static str, Value)>,
    /// Sample type to which they are rounded.
    pub sample: SampleType,
    /// Samples from which an encoder starts: one, or the first window of a moving window. Not needed for decoding.
    pub first: Vec<f64>,
    /// Stream of the random generator, for codes that draw by chance. Channels with the same seed have different
    /// streams, by their number.
    pub stream: u64,
    /// Values that the sample type has changed, as they were before.
    pub rounded: Vec<(&'static str, Value)>,
}

/// Key of the first sample in a file, if the decoder starts with the value of that sample. If it starts with the value
/// before it, the key is the parameter's name.
const FIRST: &str = "first";

impl Settings {
    /// Returns names and values, in the order of a file.
    pub fn entries(&self) -> &[(&'static str, Value)] {
        &self.values
    }

    pub(super) fn entries_mut(&mut self) -> &mut [(&'static str, Value)] {
        &mut self.values
    }

    /// Returns the value of an entry.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.values.iter().find(|(own, _)| *own == name).map(|(_, value)| value)
    }

    /// Sets an entry; a new one is appended.
    pub fn set(&mut self, name: &'static str, value: impl Into<Value>) {
        match self.values.iter_mut().find(|(own, _)| *own == name) {
            Some((_, old)) => *old = value.into(),
            None => self.values.push((name, value.into())),
        }
    }

    /// Sets the value of the first sample, from which the decoder starts; its spike then changes nothing.
    pub(super) fn set_first(&mut self, value: f64) {
        self.set(FIRST, value);
    }

    /// Returns these settings for another recording, whose encoder starts from these samples. What does not follow from
    /// them stays.
    #[must_use]
    pub fn beginning(&self, first: &[f64]) -> Self {
        let mut own = Self { first: first.to_vec(), ..self.clone() };
        if let (true, Some(&first)) = (own.starts_at_first(), first.first()) {
            own.rounded.retain(|(name, _)| *name != FIRST);
            let rounded = own.sample.rounded(first);
            if rounded != first {
                own.rounded.push((FIRST, first.into()));
            }
            own.set_first(rounded);
        }
        own
    }

    /// Returns the value from which the decoder starts: that of the first sample, or the one before it.
    pub fn first_value(&self) -> Option<f64> {
        self.get(self.first_key()?)?.number()
    }

    /// Returns the key of the value from which the decoder starts: that of the first sample, or the one before it.
    pub(super) fn first_key(&self) -> Option<&'static str> {
        let mut names = self.values.iter().map(|(name, _)| *name);
        names.find(|name| [FIRST, "start"].contains(name))
    }

    /// Returns whether the decoder starts with the value of the first sample, whose spike then changes nothing.
    pub fn starts_at_first(&self) -> bool {
        self.get(FIRST).is_some()
    }

    /// Returns parameters that resolve to these settings again.
    pub fn to_asked(&self, info: &Info) -> Asked {
        let mut asked = Asked::default();
        for parameter in info.parameters.iter().filter(|parameter| parameter.is_recorded) {
            if let Some(value) = self.get(parameter.key()) {
                asked.set(parameter.name, value.clone());
            }
        }
        asked
    }

    /// Takes the entries of a scheme out of the keys of a file.
    ///
    /// # Errors
    /// Returns an error if the text of a key is not a value of its parameter.
    pub fn take(info: &Info, sample: SampleType, keys: &mut Vec<(String, String)>) -> Result<Self> {
        let mut settings = Self { sample, ..Self::default() };
        for parameter in info.parameters.iter().filter(|parameter| parameter.is_recorded) {
            let first = (parameter.found == Some(Found::First)).then_some(FIRST);
            for name in first.into_iter().chain([parameter.key()]) {
                if let Some(place) = keys.iter().position(|(key, _)| key == name) {
                    let text = keys.remove(place).1;
                    let value = parameter.read_recorded(&text);
                    settings.set(
                        name,
                        value.map_err(|error| {
                            Error::of(Given::listed(name, Some(&text)), error.kind)
                        })?,
                    );
                }
            }
        }
        Ok(settings)
    }

    /// Returns a value.
    ///
    /// # Errors
    /// Returns an error if the setting is missing, as in a file that is not one of spikes.
    pub fn value(&self, name: &str) -> Result<&Value> {
        let lacking =
            || Error::of(Given::listed(name, None::<&str>), ErrorKind::Lacking { or: None });
        self.get(name).ok_or_else(lacking)
    }

    /// Returns the word that stands in place of a list; `None` if there is a list.
    ///
    /// # Errors
    /// Returns an error if the setting is missing.
    pub fn preset(&self, name: &str) -> Result<Option<&str>> {
        Ok(self.value(name)?.word())
    }

    /// Returns a finite number.
    ///
    /// # Errors
    /// Returns an error if the setting is missing or not a number.
    pub fn number(&self, name: &str) -> Result<f64> {
        let value = self.value(name)?;
        let wrong = || Error::of(Given::listed(name, Some(value)), ErrorKind::NotANumber);
        value.number().ok_or_else(wrong)
    }

    /// Returns finite numbers.
    ///
    /// # Errors
    /// Returns an error if the setting is missing or a word.
    pub fn numbers(&self, name: &str) -> Result<&[f64]> {
        let value = self.value(name)?;
        let wrong = || Error::of(Given::listed(name, Some(value)), ErrorKind::NotAList);
        value.numbers().ok_or_else(wrong)
    }

    /// Returns an integer within `range`.
    ///
    /// # Errors
    /// Returns an error if the setting is missing, not an integer, or outside `range`.
    pub fn count(&self, name: &str, range: RangeInclusive<usize>) -> Result<usize> {
        let value = self.value(name)?;
        let (min, max) = (range.start(), range.end());
        let count = match value {
            Value::Count(count) => usize::try_from(*count).ok(),
            _ => None,
        };
        match count {
            Some(count) if range.contains(&count) => Ok(count),
            _ => {
                let max = Some(*max).filter(|max| *max < usize::MAX);
                Err(Error::of(
                    Given::listed(name, Some(value)),
                    ErrorKind::NotWhole { min: *min, max },
                ))
            }
        }
    }

    /// Returns the settings with another stream of the random generator.
    #[must_use]
    pub fn with_stream(&self, stream: u64) -> Self {
        Self { stream, ..self.clone() }
    }

    /// Makes the random generator, with the settings' seed and stream.
    ///
    /// # Errors
    /// Returns an error if the seed is missing or not an integer.
    pub fn generator(&self) -> Result<ChaCha8Rng> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.count("seed", 0..=usize::MAX)? as u64);
        generator.set_stream(self.stream);
        Ok(generator)
    }

    /// Returns a word, which must be one of these.
    ///
    /// # Errors
    /// Returns an error if the setting is missing or is none of the words.
    pub fn choice(&self, name: &str, words: &'static [&'static str]) -> Result<&'static str> {
        let value = self.value(name)?;
        match words.iter().find(|own| value.word() == Some(own)) {
            Some(word) => Ok(word),
            None => Err(Error::of(Given::listed(name, Some(value)), ErrorKind::NotOneOf { words })),
        }
    }

    /// Returns the number of neurons.
    ///
    /// # Errors
    /// See [`count`](Self::count).
    pub fn neurons(&self) -> Result<usize> {
        self.count("neurons", 3..=dynamic::NEURONS)
    }

    /// Returns the number of taps in the filter.
    ///
    /// # Errors
    /// See [`numbers`](Self::numbers).
    pub fn length(&self) -> Result<usize> {
        Ok(self.numbers("taps")?.len())
    }

    /// Returns a number in the signal's unit, as a sample.
    ///
    /// # Errors
    /// See [`number`](Self::number).
    pub fn signal<S: Sample>(&self, name: &str) -> Result<S> {
        Ok(S::from_f64(self.number(name)? * self.sample.one()))
    }

    /// Returns numbers in the signal's unit, as samples.
    ///
    /// # Errors
    /// See [`numbers`](Self::numbers).
    pub fn signals<S: Sample>(&self, name: &str) -> Result<Vec<S>> {
        let one = self.sample.one();
        Ok(self.numbers(name)?.iter().map(|number| S::from_f64(number * one)).collect())
    }

    /// Returns numbers in the signal's unit, scaled to the unit of the sample type, but not rounded to it.
    ///
    /// # Errors
    /// See [`numbers`](Self::numbers).
    pub fn reals(&self, name: &str) -> Result<Vec<f32>> {
        let one = self.sample.one();
        Ok(self.numbers(name)?.iter().map(|number| (number * one) as f32).collect())
    }

    /// Returns the range from `min` to `max`.
    ///
    /// # Errors
    /// See [`number`](Self::number).
    pub fn range<S: Sample>(&self) -> Result<RangeInclusive<S>> {
        Ok(self.signal("min")?..=self.signal("max")?)
    }

    /// Returns whether spikes are averaged over a window, rather than by a running average.
    ///
    /// # Errors
    /// Returns an error if the setting is missing or is another word.
    pub fn takes_window(&self) -> Result<bool> {
        Ok(self.choice("mean", &["average", "window"])? == "window")
    }

    /// Makes the average over a window, with the capacity of the largest.
    ///
    /// # Errors
    /// See [`count`](Self::count).
    pub fn window(&self) -> Result<rate::Window<128>> {
        Ok(rate::Window::try_new(self.count("power", 0..=12)? as u8)?)
    }

    /// Makes the running average.
    ///
    /// # Errors
    /// See [`count`](Self::count).
    pub fn average(&self) -> Result<rate::Average> {
        Ok(rate::Average::try_new(self.count("power", 1..=15)? as u8)?)
    }

    /// Returns the filter.
    ///
    /// # Errors
    /// Returns an error if there are no taps or too many, or if they do not form a filter.
    pub fn taps<S: Sample>(&self) -> Result<dynamic::Taps<S>> {
        Ok(dynamic::Taps::try_new(&self.signals("taps")?)?)
    }
}
