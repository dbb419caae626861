//! Errors as Python has them.

use lab::ErrorKind;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::{PyErr, create_exception};

create_exception!(
    spikewire,
    Error,
    PyValueError,
    "A setting, a file or a signal that cannot be used.\n\n`parameter` is the keyword at fault and `value` what it was, if it is \
     one alone; `file` is the file, and `kind` the reason's name. `remedy` is the keyword that would go on over it."
);

/// The exception of an error, in the words of the library, which names settings as keywords are named.
pub(crate) fn value(error: impl Into<anyhow::Error>) -> PyErr {
    let error = error.into();
    let (mut words, mut own) = (Vec::new(), None);
    for cause in error.chain() {
        words.push(cause.to_string());
        own = Attributes::of(cause);
        if own.is_some() {
            break;
        }
    }
    let exception = Error::new_err(words.join(": "));
    let set = Python::attach(|py| own.unwrap_or_default().set(exception.value(py)));
    set.err().unwrap_or(exception)
}

/// The exception of a call that must wait for another one, which Python's half declares with two bases.
pub(crate) fn busy(words: String) -> PyErr {
    let error = Python::attach(|py| {
        let kind = py.import("spikewire._errors")?.getattr("Busy")?;
        Ok(PyErr::from_value(kind.call1((words,))?))
    });
    error.unwrap_or_else(|error| error)
}

/// The attributes of an exception, for a program to act on.
#[derive(Default)]
struct Attributes<'a> {
    parameter: Option<&'a str>,
    value: Option<&'a str>,
    file: Option<&'a str>,
    kind: Option<&'static str>,
    remedy: Option<&'static str>,
}

impl<'a> Attributes<'a> {
    fn of(cause: &'a (dyn std::error::Error + 'static)) -> Option<Self> {
        let (parameter, mut own) = if let Some(error) = cause.downcast_ref::<lab::Error>() {
            let own = Self {
                file: error.file(),
                kind: Some(ErrorKind::name(&error.kind)),
                remedy: error.remedy(),
                ..Self::default()
            };
            (&error.parameter, own)
        } else {
            let error = cause.downcast_ref::<catalogue::run::Error>()?;
            (&error.parameter, Self { kind: Some(error.kind.name()), ..Self::default() })
        };
        own.parameter = parameter.as_ref().map(|own| &*own.name);
        own.value = parameter.as_ref().and_then(|own| own.value.as_deref());
        Some(own)
    }

    fn set(&self, exception: &Bound<'_, PyAny>) -> PyResult<()> {
        exception.setattr("parameter", self.parameter)?;
        exception.setattr("value", self.value)?;
        exception.setattr("file", self.file)?;
        exception.setattr("kind", self.kind)?;
        exception.setattr("remedy", self.remedy)
    }
}
