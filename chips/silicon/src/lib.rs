//! Models of the chips tinyODIN, ODIN and [`ReckOn`], exact to the clock cycle. They were written from the chips'
//! public register-transfer code; nothing is copied from it.
//!
//! `ReckOn` has a module of its own, [`reckon`]. The models of tinyODIN and ODIN share their [SPI slave](spi), [output
//! bus](output), [pins](board) and [controller](chip), and differ in their [`Kind`]: [`TinyOdin`] or [`Odin`].
//!
//! Exact to the clock cycle are the synchronisers, the controller, the scheduler's queue, the order of a sweep, the
//! neurons, the gate and the write-back over SPI. Not modelled are ODIN's learning (`ca_en` is taken as 0), its
//! Izhikevich neurons, its bursts, and the monitoring on the output bus.

#![no_std]
#![allow(
    clippy::match_same_arms,
    clippy::verbose_bit_mask,
    clippy::cast_possible_wrap,
    clippy::struct_excessive_bools,
    reason = "the models are written like the chips"
)]

extern crate alloc;

pub mod board;
pub mod chip;
mod odin;
pub mod output;
pub mod reckon;
pub mod spi;
mod tiny_odin;

pub use chip::{Board, Chip, Kind, Pins, Port, Spi};
pub use odin::Odin;
pub use reckon::ReckOn;
pub use tiny_odin::TinyOdin;
