//! A model of `ReckOn`, clock by clock: its SPI, controllers, neurons, traces, learning and sources of random numbers.
//!
//! It was written from the chip's public register-transfer code, of which nothing is copied.

mod board;
mod chip;
mod digest;
mod learn;
mod lfsr;
mod memory;
mod spi;

pub use board::{Board, Pins, Port, Spi};
pub use chip::{EventState, Inputs, Outputs, ReckOn, State};
pub use memory::Memory;
