//! Spiking networks on the microcontroller itself.
//!
//! The crate runs a trained network of up to a few hundred neurons in memory of fixed size: no heap, no panic, no
//! unsafe code, and the same bits on every core. Weights stay in flash; only potentials, currents and lists of spikes
//! are in RAM. For each input that fired a layer adds its row of weights; it multiplies nothing for inputs that did not
//! fire.
#![doc = include_str!("../README.md")]
#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]
#![expect(
    clippy::inline_always,
    reason = "sums stay in registers only where the whole step is one function"
)]

mod chain;
mod checksum;
mod error;
mod input;
mod integer;
mod layer;
mod neuron;
mod number;
mod recurrence;
mod reset;
mod spikes;
mod weights;

pub use chain::{Network, State, Then, ThenState};
pub use error::ParameterError;
pub use input::{Input, Spiking, Values};
pub use integer::Packed;
pub use layer::{Layer, LayerState};
pub use neuron::{Cuba, CubaLi, CubaLif, Li, Lif, Neuron};
pub use number::Number;
pub use recurrence::{Forward, Full, OneToOne, Recurrence};
pub use reset::{
    NoReset, Reset, Subtract, SubtractLate, SubtractNoDelay, ToValue, ToValueHeld, ToValueLate,
};
pub use spikes::Spikes;
pub use weights::Weights;

/// Closes the crate's traits, as the bounds on sums hold only for its own types.
mod sealed {
    pub trait Sealed {}
}
