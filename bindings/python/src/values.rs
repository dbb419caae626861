//! Values of parameters between Python and the catalogue.

use catalogue::Info;
use catalogue::run::{Asked, Error, Result, SET, Value};
use pyo3::prelude::*;

/// A keyword's value, as Python has it.
#[derive(Clone, FromPyObject, IntoPyObject)]
pub(crate) enum Given {
    /// `True` or `False`.
    Flag(bool),
    /// A text.
    Word(String),
    /// An integer that is not negative.
    Count(u64),
    /// Any other number.
    Number(f64),
    /// A list of numbers.
    Numbers(Vec<f64>),
}

/// What is asked for by keywords.
///
/// # Errors
/// There is no such parameter, or the value is none of it. The error names the keyword.
pub(crate) fn asked(
    info: &'static Info,
    given: Vec<(String, Given)>,
    paper: bool,
) -> Result<Asked> {
    let mut asked = Asked::default();
    asked.paper = paper;
    for (name, given) in given {
        let Some(parameter) = info.parameter(&name) else {
            return Err(Error::takes_no(info, name));
        };
        let value = match given {
            Given::Flag(false) => continue,
            Given::Flag(true) => SET,
            Given::Word(text) => parameter.read(&text)?,
            Given::Count(count) => Value::Count(count),
            Given::Number(number) => Value::Number(number),
            Given::Numbers(all) => Value::Numbers(all),
        };
        asked.set(parameter.name, parameter.check(value)?);
    }
    Ok(asked)
}

/// Values as keywords.
pub(crate) fn keywords(asked: &Asked) -> Vec<(&'static str, Given)> {
    asked.iter().map(|(name, value)| (name, given(value))).collect()
}

fn given(value: &Value) -> Given {
    match value {
        value if *value == SET => Given::Flag(true),
        Value::Number(number) => Given::Number(*number),
        Value::Count(count) => Given::Count(*count),
        Value::Word(word) => Given::Word(word.to_string()),
        Value::Numbers(numbers) => Given::Numbers(numbers.clone()),
    }
}
