//! Spiking networks on the microcontroller itself.
//!
//! A trained network of up to a few hundred neurons, stepped in memory of fixed size: no heap, no panic, no unsafe code,
//! and the same bits on every core. Weights stay in flash; only potentials, currents and the lists of spikes lie in RAM.
//! A layer adds the row of weights of each input that fired, and multiplies nothing that did not.
#![doc = include_str!("../README.md")]
#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]
#![expect(
    clippy::inline_always,
    reason = "sums stay in registers only where the whole step is one function"
)]

mod chain;
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
    Reset, Subtract, SubtractLate, SubtractNoDelay, ToValue, ToValueHeld, ToValueLate,
};
pub use spikes::Spikes;
pub use weights::Weights;

/// Closes the crate's traits: their bounds on sums hold for the types here alone.
mod sealed {
    pub trait Sealed {}
}
