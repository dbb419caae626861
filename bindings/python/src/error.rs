//! Errors as Python has them.

use pyo3::PyErr;
use pyo3::exceptions::PyValueError;

/// A `ValueError` with the words of the library, which names settings as keywords are named.
pub(crate) fn value(error: &anyhow::Error) -> PyErr {
    PyValueError::new_err(format!("{error:#}"))
}
