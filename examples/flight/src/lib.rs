//! What a flying example does about its sensor, without a HAL.
//!
//! An SPI master cannot notice that nobody answers: it reads zeros, and calls them samples. A sensor that lost its supply
//! for a moment no longer says that it has any, and no events look like no rotation. So
//!
//! - [`Device`] gives the sensor the pauses that it needs between two accesses, and chip select its guard times;
//! - [`bmi323`] and [`bmi088`] start the sensor, and read back what it was told;
//! - [`free_bus`] frees an I2C bus that a sensor holds since the controller was reset;
//! - [`Sampler`] stands between sensor and queue: it counts samples, finds those that are missing, notices a sensor that is
//!   silent or stuck, and tells the far end by a break;
//! - [`code`] is the code of the channels, and why;
//! - [`clock`] checks a crystal and its dividers while the firmware is compiled.
//!
//! One text is both: futures over `embedded-hal-async`, or with the feature `blocking` plain functions over `embedded-hal`.

#![cfg_attr(not(test), no_std)]

pub mod bmi088;
#[cfg(feature = "bmi323")]
pub mod bmi323;
pub mod clock;
pub mod code;
mod counters;
mod device;
mod i2c;
mod sampler;
#[cfg(feature = "simulated")]
pub mod simulated;

pub use counters::Counters;
pub use device::{Device, Timing};
/// What goes wrong in a [`Device`].
pub use embedded_hal_bus::spi::DeviceError as SpiError;
pub use i2c::free_bus;
pub use sampler::{Plan, Sampler, Why};
