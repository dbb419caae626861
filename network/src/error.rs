//! The error of an invalid parameter.

use core::fmt;

/// A weight or a neuron's parameter is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterError {
    /// The name of the parameter.
    pub parameter: &'static str,
    /// Row and column of a weight; 0 and 0 for a parameter of a neuron.
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

/// Returns the value; fails the build if a constant is invalid.
pub(crate) const fn unwrap<T: Copy>(result: Result<T, ParameterError>) -> T {
    match result {
        Ok(value) => value,
        Err(_) => panic!("a parameter is not finite or out of its range; try_new says which"),
    }
}
