//! Models of the chips tinyODIN, ODIN and [`ReckOn`], exact to the clock cycle. The models were written from the chips'
//! public register-transfer code; none of that code is copied.
//!
//! `ReckOn` has a module of its own, [`reckon`]. The models of tinyODIN and ODIN share their [SPI slave](spi), [output
//! bus](output), [pins](board) and [controller](chip), and differ in their [`Kind`]: [`TinyOdin`] or [`Odin`].
//!
//! In the models of tinyODIN and ODIN, these parts are exact to the clock cycle: the synchronisers, the controller, the
//! scheduler's queue, the order in which a spike visits the neurons, the neurons, the gate, and writes over SPI. ODIN's
//! learning, Izhikevich neurons, bursts and monitoring on the output bus are not modelled. (The model assumes that
//! `ca_en`, the bit of a neuron that turns learning on, is 0.)

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
