//! The error of a bad parameter, which is found when a scheme is built, and the checks that return it.

mod message;

use core::fmt;

pub(crate) use message::unwrap;

/// A parameter is out of its range.
///
/// Every variant says what is wrong, where, and what is allowed. Values are given as `f32` for every sample type.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum ConfigError {
    /// The value must be above 0 and finite.
    NotPositive {
        /// The name of the parameter.
        parameter: &'static str,
        /// Its value.
        value: f32,
    },
    /// The value must be 0 or more and finite.
    Negative {
        /// The name of the parameter.
        parameter: &'static str,
        /// Its value.
        value: f32,
    },
    /// The value must be finite.
    NotFinite {
        /// The name of the parameter.
        parameter: &'static str,
        /// Its value.
        value: f32,
    },
    /// The value must lie in `min..=max`.
    OutOfRange {
        /// The name of the parameter.
        parameter: &'static str,
        /// Its value.
        value: f32,
        /// The smallest value allowed.
        min: f32,
        /// The largest value allowed.
        max: f32,
    },
    /// A list must rise strictly, and `values[index]` does not exceed its predecessor.
    NotRising {
        /// The name of the parameter.
        parameter: &'static str,
        /// The index of the value that does not rise.
        index: usize,
        /// The value that does not rise.
        value: f32,
        /// The value before it, which it must exceed.
        previous: f32,
    },
    /// All taps are 0: spikes would add 0 to the decoded value.
    AllZero {
        /// The name of the parameter.
        parameter: &'static str,
    },
    /// A cell holds no sample: the sample type is too coarse for this many cells, or an edge lies outside the range.
    EmptyCell {
        /// The number of the cell, from 0 for the lowest.
        cell: usize,
        /// The number of cells.
        cells: usize,
    },
    /// A receptive field is so wide that its response is the strongest where two others meet.
    FieldTooWide {
        /// The number of the field, from 0 for the lowest.
        field: usize,
        /// The lower of the two fields that meet; the other is the next one.
        lower: usize,
    },
    /// A calibration has seen too few samples.
    TooFewSamples {
        /// How many it has seen.
        seen: u32,
        /// How many it needs.
        needed: u32,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotPositive { parameter, value } => {
                write!(f, "{parameter} {value} must be above 0 and finite")
            }
            Self::Negative { parameter, value } => {
                write!(f, "{parameter} {value} must be 0 or more and finite")
            }
            Self::NotFinite { parameter, value } => {
                write!(f, "{parameter} {value} must be finite")
            }
            Self::OutOfRange { parameter, value, min, max } => {
                write!(f, "{parameter} {value} must lie in {min}..={max}")
            }
            Self::NotRising { parameter, index, value, previous } => write!(
                f,
                "{parameter} must rise strictly, but number {index} is {value} after {previous}"
            ),
            Self::AllZero { parameter } => {
                write!(f, "{parameter} are all 0; at least one must not be")
            }
            Self::EmptyCell { cell, cells } => write!(
                f,
                "number {cell} of the {cells} cells must hold a sample: use a wider range or fewer cells, and \
                 edges within the range"
            ),
            Self::FieldTooWide { field, lower } => write!(
                f,
                "field {field} is so wide that it wins where fields {lower} and {} meet: use a narrower one there, or \
                 equal widths",
                lower.saturating_add(1)
            ),
            Self::TooFewSamples { seen, needed } => {
                write!(f, "the calibration has seen {seen} samples and needs at least {needed}")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

/// The value of a `Result`, or a return with its error: `?`, which functions of constants cannot use.
macro_rules! tri {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}
pub(crate) use tri;

/// Checks that a value is above 0 and finite.
pub(crate) const fn positive(parameter: &'static str, value: f64) -> Result<(), ConfigError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ConfigError::NotPositive { parameter, value: value as f32 })
    }
}

/// The largest step in `f32`. It is less than half a unit in the last place of `f32::MAX`, so that a finite value plus
/// a step is finite.
pub(crate) const LARGEST_STEP: f32 = 1e31;

/// Checks that a value is above 0 and at most [`LARGEST_STEP`].
pub(crate) const fn step(parameter: &'static str, value: f64) -> Result<(), ConfigError> {
    tri!(positive(parameter, value));
    within(parameter, value, f32::from_bits(1), LARGEST_STEP)
}

/// Checks that a value is finite and within ±[`LARGEST_STEP`].
pub(crate) const fn offset(parameter: &'static str, value: f64) -> Result<(), ConfigError> {
    tri!(finite(parameter, value));
    within(parameter, value, -LARGEST_STEP, LARGEST_STEP)
}

/// Checks that a value lies within `min..=max`.
pub(crate) const fn within(
    parameter: &'static str,
    value: f64,
    min: f32,
    max: f32,
) -> Result<(), ConfigError> {
    if value >= min as f64 && value <= max as f64 {
        Ok(())
    } else {
        Err(ConfigError::OutOfRange { parameter, value: value as f32, min, max })
    }
}

/// Checks that this many addresses from `value` on fit 16 bits.
pub(crate) const fn first_address(value: u16, addresses: usize) -> Result<(), ConfigError> {
    within("first address", value as f64, 0.0, ((1 << 16) - addresses) as f32)
}

/// Checks that a value is 0 or more and finite.
pub(crate) const fn not_negative(parameter: &'static str, value: f64) -> Result<(), ConfigError> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ConfigError::Negative { parameter, value: value as f32 })
    }
}

/// Checks the factor of BSA's multiplicative rule, which fixed point stores with 2 integer and 14 fraction bits.
pub(crate) const fn ratio(parameter: &'static str, value: f32) -> Result<(), ConfigError> {
    const STEP: f32 = 1.0 / 16_384.0;
    const MAX: f32 = 4.0 - STEP;
    within(parameter, value as f64, STEP, MAX)
}

/// Checks that `min < max` and both are finite.
pub(crate) const fn range(min: f64, max: f64) -> Result<(), ConfigError> {
    tri!(finite("min", min));
    tri!(finite("max", max));
    if min < max { Ok(()) } else { Err(not_rising("min and max", 1, max, min)) }
}

/// The error of a value that does not exceed the value before it.
pub(crate) const fn not_rising(
    parameter: &'static str,
    index: usize,
    value: f64,
    previous: f64,
) -> ConfigError {
    ConfigError::NotRising { parameter, index, value: value as f32, previous: previous as f32 }
}

/// Checks that a value is finite.
pub(crate) const fn finite(parameter: &'static str, value: f64) -> Result<(), ConfigError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(ConfigError::NotFinite { parameter, value: value as f32 })
    }
}
