//! A model of `ReckOn`, exact to the clock cycle: its SPI, controllers, neurons, traces, learning and random
//! generators.
//!
//! The model was written from the chip's public register-transfer code; none of that code is copied.

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
