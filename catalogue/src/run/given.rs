//! Settings as a scheme is built from them: by type, in the unit of the sample type.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use anyhow::{Context, Result, bail};
use spikewire::{Sample, dynamic, rate};

use super::Settings;
use super::settings::{number, numbers};

/// Settings, and a record of what was read in the signal's unit.
#[derive(Debug)]
pub struct Given<'a> {
    settings: &'a Settings,
    /// What a 1 of the signal is in the unit of the sample type.
    one: f64,
    ran: RefCell<Vec<Ran>>,
}

/// A parameter in the signal's unit, as it was given and as it ran.
#[derive(Clone, Debug, PartialEq)]
pub struct Ran {
    /// Its name in a file.
    pub name: &'static str,
    /// As it was given: one number, or a list.
    pub asked: Vec<f64>,
    /// In the sample type.
    pub ran: Vec<f64>,
}

impl<'a> Given<'a> {
    /// Settings for a sample type in whose unit a 1 of the signal is this.
    pub fn new(settings: &'a Settings, one: f64) -> Self {
        Self { settings, one, ran: RefCell::default() }
    }

    /// What was read in the signal's unit.
    pub(super) fn told(&self) -> Vec<Ran> {
        self.ran.borrow().clone()
    }

    /// A text.
    ///
    /// # Errors
    /// There is none of this name, as in a file that is none of spikes.
    pub fn word(&self, name: &str) -> Result<&'a str> {
        let text = self.settings.get(name);
        text.with_context(|| format!("the header lacks `# {name}=`; is it a file of spikes?"))
    }

    /// A finite number.
    ///
    /// # Errors
    /// There is none of this name, or it is no finite number.
    pub fn number(&self, name: &str) -> Result<f64> {
        number(name, self.word(name)?)
    }

    /// Finite numbers with commas between.
    ///
    /// # Errors
    /// As for [`number`](Self::number).
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        numbers(name, self.word(name)?)
    }

    /// A whole number within this range.
    ///
    /// # Errors
    /// There is none of this name, or it is none, or out of the range.
    pub fn count(&self, name: &str, range: RangeInclusive<usize>) -> Result<usize> {
        let text = self.word(name)?;
        let (min, max) = (range.start(), range.end());
        match text.trim().parse() {
            Ok(count) if range.contains(&count) => Ok(count),
            _ if *max == usize::MAX => bail!("{name} {text} must be a whole number, {min} or more"),
            _ => bail!("{name} {text} must be a whole number in {min}..={max}"),
        }
    }

    /// How many neurons there are.
    ///
    /// # Errors
    /// As for [`count`](Self::count).
    pub fn neurons(&self) -> Result<usize> {
        self.count("neurons", 3..=dynamic::NEURONS)
    }

    /// How many taps the filter has.
    ///
    /// # Errors
    /// As for [`numbers`](Self::numbers).
    pub fn length(&self) -> Result<usize> {
        Ok(self.numbers("taps")?.len())
    }

    /// A number in the signal's unit.
    ///
    /// # Errors
    /// As for [`number`](Self::number).
    pub fn signal<S: Sample>(&self, name: &str) -> Result<S> {
        let samples = self.read(name, vec![self.number(name)?]);
        Ok(samples.into_iter().next().unwrap_or_default())
    }

    /// Numbers in the signal's unit.
    ///
    /// # Errors
    /// As for [`number`](Self::number).
    pub fn signals<S: Sample>(&self, name: &str) -> Result<Vec<S>> {
        Ok(self.read(name, self.numbers(name)?))
    }

    /// Numbers in the signal's unit, in that of the sample type, but not rounded to it.
    ///
    /// # Errors
    /// As for [`number`](Self::number).
    pub fn reals(&self, name: &str) -> Result<Vec<f32>> {
        Ok(self.numbers(name)?.into_iter().map(|number| (number * self.one) as f32).collect())
    }

    /// From `min` to `max`.
    ///
    /// # Errors
    /// As for [`number`](Self::number).
    pub fn range<S: Sample>(&self) -> Result<RangeInclusive<S>> {
        Ok(self.signal("min")?..=self.signal("max")?)
    }

    /// One of these words.
    ///
    /// # Errors
    /// There is none of this name, or another word.
    pub fn choice(&self, name: &str, words: &[&str]) -> Result<&'a str> {
        let text = self.word(name)?;
        if !words.contains(&text) {
            bail!("{name} {text}: there are {}", words.join(", "));
        }
        Ok(text)
    }

    /// Whether the mean of spikes is taken over a window, and not as an average.
    ///
    /// # Errors
    /// There is no such setting, or it is another word.
    pub fn takes_window(&self) -> Result<bool> {
        Ok(self.choice("mean", &["average", "window"])? == "window")
    }

    /// A mean over a window, in the room of the largest.
    ///
    /// # Errors
    /// As for [`count`](Self::count).
    pub fn window(&self) -> Result<rate::Window<128>> {
        Ok(rate::Window::try_new(self.count("power", 0..=12)? as u8)?)
    }

    /// A mean as an average.
    ///
    /// # Errors
    /// As for [`count`](Self::count).
    pub fn average(&self) -> Result<rate::Average> {
        Ok(rate::Average::try_new(self.count("power", 1..=15)? as u8)?)
    }

    /// The filter.
    ///
    /// # Errors
    /// There are too many taps or none, or they make no filter.
    pub fn taps<S: Sample>(&self) -> Result<dynamic::Taps<S>> {
        Ok(dynamic::Taps::try_new(&self.signals("taps")?)?)
    }

    fn read<S: Sample>(&self, name: &str, asked: Vec<f64>) -> Vec<S> {
        let samples: Vec<S> = asked.iter().map(|value| S::from_f64(value * self.one)).collect();
        let entries = self.settings.entries().iter();
        if let Some((name, _)) = entries.into_iter().find(|(own, _)| *own == name) {
            let ran = samples.iter().map(|sample| sample.to_f64() / self.one).collect();
            let mut all = self.ran.borrow_mut();
            all.retain(|ran| ran.name != *name);
            all.push(Ran { name, asked, ran });
        }
        samples
    }
}
