//! The library of the laptop programs. Encodes recordings to spikes, scores codes, tunes parameters, gives advice,
//! draws pictures, and puts trained networks on chips.
//!
//! The library has no command line and prints nothing. The program `spikewire` and the Python bindings are built on it.

pub mod advise;
pub mod bank;
pub mod bench;
pub mod brief;
pub mod coding;
#[cfg(all(feature = "datasets", not(target_family = "wasm")))]
pub mod dataset;
pub mod emit;
pub mod encode;
mod error;
pub mod events;
pub mod fit;
pub mod flight;
#[cfg(feature = "frames")]
pub mod frames;
pub mod input;
pub mod look;
mod measure;
#[cfg(feature = "networks")]
pub mod network;
pub mod output;
mod passes;
#[cfg(not(target_family = "wasm"))]
pub mod plot;
#[cfg(all(feature = "ports", not(target_family = "wasm")))]
pub mod port;
pub mod resolution;
#[cfg(any(test, feature = "capture"))]
pub mod rtt;
pub mod scheme;
pub mod score;
pub mod slope;
pub mod spikes;
pub mod timeline;
pub mod trial;
pub mod tune;
pub mod unit;
pub mod values;
pub mod watch;

pub use error::{Error, ErrorKind, Place, Result, Spot};
