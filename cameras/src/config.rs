//! The checks of parameters, and what a constant does with one that is refused.

use spikewire::ConfigError;

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

/// Returns the value, or fails the build if it initialises a constant.
///
/// # Panics
/// Panics on an error.
#[track_caller]
pub(crate) const fn unwrap<T: Copy>(result: Result<T, ConfigError>) -> T {
    match result {
        Ok(value) => value,
        Err(error) => error.panic(),
    }
}
