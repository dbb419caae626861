//! A model of `ReckOn`, exact to the clock cycle: its SPI, controllers, neurons, traces, learning and random
//! generators.
//!
//! It was written from the chip's public register-transfer code; nothing is copied from it.

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
