//! Errors as Python has them.

use pyo3::PyErr;
use pyo3::exceptions::PyValueError;

/// A `ValueError` with the words of the laptop program, whose options are keywords here.
pub(crate) fn value(error: &anyhow::Error) -> PyErr {
    PyValueError::new_err(keywords(&format!("{error:#}")))
}

/// `--min-efficiency` as `min_efficiency`.
pub(crate) fn keywords(text: &str) -> String {
    let is_part = |letter: char| letter.is_ascii_lowercase() || letter == '-';
    let mut words = text.split("--");
    let mut all = words.next().unwrap_or_default().to_owned();
    for word in words {
        let end = word.find(|letter| !is_part(letter)).unwrap_or(word.len());
        all += &word[..end].replace('-', "_");
        all += &word[end..];
    }
    all
}
