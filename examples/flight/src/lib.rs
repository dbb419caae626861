//! Six channels of an IMU to spikes and to frames, as they fly, without a HAL.
//!
//! A board brings pins, clocks and memory; the rest is here, once:
//!
//! - [`Imu`] is the contract of a sensor: [`bmi088`] and [`bmi323`] keep it, and so does the crate `icm42688p`;
//! - [`Device`] gives a sensor on SPI its guard times and pauses, and [`Spin`] makes them no shorter than asked for;
//! - [`free_bus`] frees an I2C bus that a sensor holds since the controller was reset;
//! - [`Watch`] runs for ever: it starts the sensor, reads it at each data-ready edge, turns its axes into the vehicle's
//!   ([`Alignment`]), codes the samples, and starts the sensor again when it dies;
//! - [`Sampler`] judges the samples: it notices a sensor that is silent, stuck or failing, and tells the far end by a break;
//! - [`Station`] does both for a flight's file, one call a period, for a sensor whose newest sample lies in [`Registers`]; a
//!   blocking bus goes into [`Blocking`], and [`Channels`] turns counts into the file's samples;
//! - [`Sender`] writes frames to a UART or a USB port, through [`Bounced`] where that port's DMA does not reach every memory;
//! - [`Rounds`] tells whoever feeds the watchdog that sampling goes on;
//! - [`clock`] checks a crystal and its dividers while the firmware is compiled.
//!
//! An SPI master cannot notice that nobody answers: it reads zeros, ones or noise, and calls them samples. A sensor that lost
//! its supply for a moment says nothing of it, and no events look like no rotation. Hence the read-back at the start, the
//! sensor's identity or header in every read, and the limits of [`Plan`].

#![cfg_attr(not(test), no_std)]

mod align;
mod blocking;
pub mod bmi088;
#[cfg(feature = "bmi323")]
pub mod bmi323;
mod bounced;
mod channels;
pub mod clock;
pub mod code;
mod counters;
mod device;
mod fault;
mod i2c;
mod imu;
mod names;
mod pace;
mod rounds;
mod sampler;
mod sender;
mod spin;
mod station;
mod watch;

/// Number of keyframes a second. Two of them may be lost before the far end's silence, which counts on this, is over: see
/// the crate `far-end`. A keyframe of six channels in 16 bits makes a frame of some 30 bytes.
pub const KEYFRAMES: u16 = 20;

pub use align::Alignment;
pub use blocking::Blocking;
pub use bounced::Bounced;
pub use channels::{Channels, Counts, OfCounts};
pub use counters::Counters;
pub use device::{Device, Timing};
pub use fault::Fault;
pub use i2c::free_bus;
pub use imu::{Burst, CHANNELS, Imu, Sample, Schemes};
pub use pace::Pace;
pub use rounds::Rounds;
pub use sampler::{Plan, Sampler, Why};
pub use sender::Sender;
pub use spin::Spin;
pub use station::{News, Registers, Station};
pub use watch::{Watch, encode};
