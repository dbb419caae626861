//! Values of parameters between Python and the catalogue.

use anyhow::{Context, Result, anyhow};
use catalogue::Info;
use catalogue::run::{Asked, SET, Value, takes_no};
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
pub(crate) fn asked(info: &Info, given: Vec<(String, Given)>, paper: bool) -> Result<Asked> {
    let mut asked = Asked::default();
    asked.paper = paper;
    for (name, given) in given {
        let parameter = info.parameter(&name).with_context(|| takes_no(info, &name))?;
        let (value, text) = match given {
            Given::Flag(false) => continue,
            Given::Flag(true) => (Ok(SET), "True".to_owned()),
            Given::Word(text) => (parameter.read(&text), text),
            Given::Count(count) => (Ok(Value::Count(count)), count.to_string()),
            Given::Number(number) => (Ok(Value::Number(number)), number.to_string()),
            Given::Numbers(all) => (Ok(Value::Numbers(all.clone())), format!("{all:?}")),
        };
        let value = value.and_then(|value| parameter.check(value));
        asked.set(parameter.name, value.map_err(|error| anyhow!("{name}={text}: {error:#}"))?);
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
