//! Values of parameters, and their parsing.

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

use super::error::{Error, ErrorKind, Result};
use super::filter;
use super::words::Given;
use crate::{Kind, Parameter};

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A finite number.
    Number(f64),
    /// An integer, 0 or more.
    Count(u64),
    /// A word, such as `linear`; the shape of a filter, such as `triang:15`; or a multiple of the threshold, such as
    /// `2x`.
    Word(Cow<'static, str>),
    /// Finite numbers: centres, edges or taps. For a parameter that takes one number, a number for each channel.
    Numbers(Vec<f64>),
}

impl Value {
    /// Returns the value, if it is a number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Count(count) => Some(*count as f64),
            _ => None,
        }
    }

    /// Returns the numbers, if the value is a list or a number.
    pub fn numbers(&self) -> Option<&[f64]> {
        match self {
            Self::Numbers(numbers) => Some(numbers),
            Self::Number(number) => Some(std::slice::from_ref(number)),
            _ => None,
        }
    }

    /// Returns the word, if the value is one.
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            _ => None,
        }
    }
}

/// Writes the value as a file of spikes contains it; numbers are separated by commas.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Count(count) => count.fmt(f),
            Self::Word(word) => f.write_str(word),
            Self::Numbers(numbers) => {
                for (place, number) in numbers.iter().enumerate() {
                    let comma = if place > 0 { "," } else { "" };
                    write!(f, "{comma}{number}")?;
                }
                Ok(())
            }
        }
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Value {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<&'static str> for Value {
    fn from(word: &'static str) -> Self {
        Self::Word(word.into())
    }
}

impl From<String> for Value {
    fn from(word: String) -> Self {
        Self::Word(word.into())
    }
}

impl From<Vec<f64>> for Value {
    fn from(numbers: Vec<f64>) -> Self {
        Self::Numbers(numbers)
    }
}

/// The value of a flag that is set.
pub const SET: Value = Value::Word(Cow::Borrowed("true"));

impl Parameter {
    /// Parses a value, as the command line and files contain it.
    ///
    /// # Errors
    /// Returns an error if the text is not a value of this parameter's kind. The error has both, and says what is
    /// allowed.
    pub fn read(&self, text: &str) -> Result<Value> {
        self.read_in(text, Path::new(""))
    }

    /// Parses a value in a file of `directory`, to which the path of a file of taps is relative.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    pub fn read_in(&self, text: &str, directory: &Path) -> Result<Value> {
        self.parsed(text, directory).map_err(|kind| Error::of(Given::new(self.name, text), kind))
    }

    fn parsed(&self, text: &str, directory: &Path) -> Result<Value, ErrorKind> {
        let list = || -> Option<Vec<f64>> {
            let numbers = text.strip_suffix(',').unwrap_or(text).split(',');
            numbers.map(|number| number.trim().parse().ok()).collect()
        };
        let value = match self.kind {
            Kind::Count => match text.trim().parse() {
                Ok(count) => Value::Count(count),
                Err(_) => return Err(ErrorKind::NotWhole { min: 0, max: None }),
            },
            Kind::Filter => filter::read(text, directory).map_err(|error| error.kind)?,
            Kind::Number | Kind::Text => match list() {
                Some(numbers) if !text.contains(',') => Value::Number(numbers[0]),
                Some(numbers) => Value::Numbers(numbers),
                None if self.kind == Kind::Number => return Err(ErrorKind::NotANumber),
                None => Value::Word(text.to_owned().into()),
            },
            Kind::Choice(words) => match words.iter().find(|word| **word == text) {
                Some(word) => Value::Word((*word).into()),
                None => return Err(ErrorKind::NotOneOf { words }),
            },
            Kind::Flag => Value::Word(text.to_owned().into()),
        };
        self.checked(value)
    }

    /// Parses a value in a file of spikes, which contains a filter's taps, and one value for each channel.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    pub(super) fn read_recorded(&self, text: &str) -> Result<Value> {
        let value = match self.kind {
            Kind::Filter => Self { kind: Kind::Text, ..*self }.read(text)?,
            _ => self.read(text)?,
        };
        let wrong = |kind| Err(Error::of(Given::new(self.name, text), kind));
        match (self.kind, value) {
            (Kind::Filter, Value::Word(_)) => wrong(ErrorKind::NotAList),
            (Kind::Number, Value::Numbers(_)) => wrong(ErrorKind::NotANumber),
            (Kind::Filter, value) => self.check(value),
            (_, value) => Ok(value),
        }
    }

    /// Converts a value to the parameter's kind: integers to numbers, and the reverse.
    ///
    /// # Errors
    /// Returns an error if the value is not of this parameter's kind. The error has both, and says what is allowed.
    pub fn check(&self, value: Value) -> Result<Value> {
        let text = value.to_string();
        self.checked(value).map_err(|kind| Error::of(Given::new(self.name, text), kind))
    }

    fn checked(&self, value: Value) -> Result<Value, ErrorKind> {
        /// Largest number up to which every integer can be represented.
        const WHOLE: f64 = 9_007_199_254_740_992.0;
        if let Some(number) =
            value.numbers().and_then(|all| all.iter().find(|own| !own.is_finite()))
        {
            return Err(ErrorKind::NotFinite { number: *number });
        }
        Ok(match (self.kind, value) {
            (Kind::Number | Kind::Text, Value::Count(count)) => Value::Number(count as f64),
            (Kind::Count, Value::Number(number))
                if number.fract() == 0.0 && (0.0..=WHOLE).contains(&number) =>
            {
                Value::Count(number as u64)
            }
            (Kind::Filter, Value::Number(tap)) => Value::Numbers(vec![tap]),
            (Kind::Filter, Value::Count(tap)) => Value::Numbers(vec![tap as f64]),
            (Kind::Choice(words), Value::Word(word)) if !words.contains(&word.as_ref()) => {
                return Err(ErrorKind::NotOneOf { words });
            }
            (Kind::Number | Kind::Count | Kind::Text | Kind::Filter, Value::Numbers(numbers))
                if numbers.is_empty() =>
            {
                return Err(ErrorKind::Empty);
            }
            (Kind::Number | Kind::Text, value @ (Value::Number(_) | Value::Numbers(_)))
            | (Kind::Count, value @ Value::Count(_))
            | (Kind::Text | Kind::Filter | Kind::Choice(_), value @ Value::Word(_))
            | (Kind::Filter, value @ Value::Numbers(_)) => value,
            (Kind::Flag, value) if value == SET => value,
            (kind, _) => return Err(ErrorKind::NotOfKind { kind }),
        })
    }

    /// Parses a text of the catalogue, whose words need not be copied.
    pub(super) fn read_own(&self, text: &'static str) -> Result<Value> {
        match self.read(text)? {
            Value::Word(_) => Ok(Value::from(text)),
            value => Ok(value),
        }
    }
}

impl Kind {
    /// Describes the kind of values in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Count => "a whole number, 0 or more",
            Self::Choice(_) => "a word",
            Self::Flag => "`true`, or left out",
            Self::Text => "a word, a number or a list of numbers",
            Self::Filter => "a shape or a list of taps",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{SET, Value};
    use crate::{Kind, Parameter, Unit};

    const fn of(kind: Kind) -> Parameter {
        Parameter::new("own", kind, Unit::None, "")
    }

    #[test]
    fn texts_are_values() {
        let word = |text: &str| Value::from(text.to_owned());
        for (kind, text, value) in [
            (Kind::Number, "0.5", Value::from(0.5)),
            (Kind::Number, "0.5, 1", vec![0.5, 1.0].into()),
            (Kind::Count, "7", 7_u64.into()),
            (Kind::Choice(&["sub", "mul"]), "mul", word("mul")),
            (Kind::Flag, "true", SET),
            (Kind::Text, "linear", word("linear")),
            (Kind::Text, "2x", word("2x")),
            (Kind::Text, "-1,0,3", vec![-1.0, 0.0, 3.0].into()),
            (Kind::Filter, "4,", vec![4.0].into()),
            (Kind::Filter, "triang:3", word("triang:3")),
        ] {
            assert_eq!(of(kind).read(text).unwrap(), value, "{text}");
        }
        for (kind, text, words) in [
            (Kind::Number, "abc", "is not a number"),
            (Kind::Number, "inf", "must be finite"),
            (Kind::Count, "-1", "must be a whole number"),
            (Kind::Choice(&["sub", "mul"]), "div", "there are sub, mul"),
            (Kind::Flag, "no", "must be `true`"),
        ] {
            let told = of(kind).read(text).unwrap_err().to_string();
            assert!(told.contains(words), "{text}: {told}");
        }
    }

    #[test]
    fn whole_numbers_are_numbers_too() {
        let check = |kind, value| of(kind).check(value);
        assert_eq!(check(Kind::Number, 2_u64.into()).unwrap(), Value::from(2.0));
        assert_eq!(check(Kind::Count, 2.0.into()).unwrap(), Value::from(2_u64));
        assert_eq!(check(Kind::Filter, 2.0.into()).unwrap(), vec![2.0].into());
        assert!(check(Kind::Count, 2.5.into()).is_err());
        assert!(check(Kind::Number, vec![].into()).is_err());
    }
}
