//! tinyODIN, ODIN and [`ReckOn`], clock by clock, written from the chips' public register-transfer code: no code of
//! theirs is in here.
//!
//! `ReckOn` is a room of its own, [`reckon`]. One file each for what the others share: the [SPI slave](spi), the [output bus](output), the
//! [pins](board) that a driver holds; and one for the [controller](chip). What the two do differently is a
//! [`Kind`]: [`TinyOdin`], [`Odin`].
//!
//! Exact, in clocks, are: the synchronisers, the controller, the scheduler's queue, the order of a sweep,
//! the neurons, the gate, the write-back over SPI. Left out are ODIN's learning (`ca_en` is taken as 0),
//! its Izhikevich neurons, its bursts, and the output bus's monitoring.

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
