//! The parameters that a user gave.

use super::Value;
use super::error::{Error, ErrorKind, Result};
use super::words::Given;
use crate::{Info, Kind};

/// Values of parameters, by their names in the catalogue. Missing ones may come from the signal or the paper.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// Sorted by name.
    values: Vec<(&'static str, Value)>,
    /// Whether missing parameters take the paper's values, scaled to the signal's range.
    pub paper: bool,
}

impl Asked {
    /// Sets a parameter.
    pub fn set(&mut self, name: &'static str, value: impl Into<Value>) {
        let value = value.into();
        match self.values.binary_search_by_key(&name, |(own, _)| own) {
            Ok(place) => self.values[place].1 = value,
            Err(place) => self.values.insert(place, (name, value)),
        }
    }

    /// Removes a parameter.
    pub fn unset(&mut self, name: &str) {
        self.values.retain(|(own, _)| *own != name);
    }

    /// Returns the value of a parameter.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.values.iter().find(|(own, _)| *own == name).map(|(_, value)| value)
    }

    /// Returns the value of a parameter, if it is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.get(name)?.number()
    }

    /// Returns the value of a parameter, if it is a word.
    pub fn word(&self, name: &str) -> Option<&str> {
        self.get(name)?.word()
    }

    /// Returns all values, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.values.iter().map(|(name, value)| (*name, value))
    }

    /// Returns these values, completed by those of `others`.
    #[must_use]
    pub fn or(&self, others: &Self) -> Self {
        let mut all = others.clone();
        self.values.iter().for_each(|(name, value)| all.set(name, value.clone()));
        all.paper |= self.paper;
        all
    }

    /// Returns whether no parameter is given.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Checks that the scheme has all these parameters.
    ///
    /// # Errors
    /// Returns an error if a parameter is given that the scheme does not have.
    pub fn check(&self, info: &'static Info) -> Result<()> {
        match self.values.iter().find(|(name, _)| info.parameter(name).is_none()) {
            Some((name, _)) => Err(Error::takes_no(info, *name)),
            None => Ok(()),
        }
    }

    /// Returns the number of channels for which values are given; `None` if no parameter has a value for each channel.
    ///
    /// # Errors
    /// Returns an error if two parameters have different numbers of values.
    pub fn channels(&self, info: &Info) -> Result<Option<usize>> {
        let mut all: Option<(&'static str, usize)> = None;
        for (name, value) in self.each(info) {
            match all {
                Some((other, count)) if count != value.len() => {
                    let kind = ErrorKind::OtherChannels { values: value.len(), other, count };
                    return Err(Error::of(Given::named(name), kind));
                }
                _ => all = Some((name, value.len())),
            }
        }
        Ok(all.map(|(_, count)| count))
    }

    /// Returns the values for one of `channels` channels.
    ///
    /// # Errors
    /// Returns an error if a parameter has another number of values.
    pub fn channel(&self, info: &Info, channel: usize, channels: usize) -> Result<Self> {
        let mut own = self.clone();
        for (name, values) in self.each(info) {
            match values.get(channel) {
                Some(value) if values.len() == channels => own.set(name, *value),
                _ => {
                    let kind = ErrorKind::OneAChannel { values: values.len(), channels };
                    return Err(Error::of(Given::named(name), kind));
                }
            }
        }
        Ok(own)
    }

    /// Returns the parameters that take one number and have a list, with a number for each channel.
    fn each<'a>(&'a self, info: &'a Info) -> impl Iterator<Item = (&'static str, &'a [f64])> {
        self.values.iter().filter_map(|(name, value)| match value {
            Value::Numbers(numbers) => {
                let takes_one = info.parameter(name)?.kind == Kind::Number;
                takes_one.then_some((*name, numbers.as_slice()))
            }
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Asked;
    use crate::run::RunTime;

    #[test]
    fn a_list_is_one_number_a_channel() {
        let info = crate::schemes::sf::Scheme.info();
        let mut asked = Asked::default();
        asked.set("threshold", vec![0.1, 0.2]);
        assert_eq!(asked.channels(info).unwrap(), Some(2));
        assert_eq!(asked.channel(info, 1, 2).unwrap().number("threshold"), Some(0.2));
        let told = asked.channel(info, 0, 3).unwrap_err().to_string();
        assert_eq!(told, "`threshold` has 2 values, one a channel, for 3 channels");
        asked.set("start", vec![0.0; 3]);
        assert!(asked.channels(info).is_err());
    }
}
