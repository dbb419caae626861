//! The error of a bad parameter.

use core::fmt;

/// A weight or a neuron's parameter is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterError {
    /// The name of the parameter.
    pub parameter: &'static str,
    /// The row and column of a weight; 0 and 0 for a neuron's parameter.
    pub place: (usize, usize),
    /// The parameter's value.
    pub value: f32,
    /// The smallest value allowed.
    pub min: f32,
    /// The largest value allowed.
    pub max: f32,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { parameter, place: (row, column), value, min, max } = self;
        write!(f, "{parameter} {value} at row {row}, column {column} must lie in {min}..={max}")
    }
}

impl core::error::Error for ParameterError {}

/// Returns the value, or fails the build where a constant is bad.
pub(crate) const fn unwrap<T: Copy>(result: Result<T, ParameterError>) -> T {
    match result {
        Ok(value) => value,
        Err(_) => panic!("a parameter is not finite or out of its range; try_new says which"),
    }
}
