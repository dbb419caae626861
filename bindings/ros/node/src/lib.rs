//! ROS 2 nodes over DDS in Rust: `encode` turns a number of any topic into spikes, `decode` turns spikes into
//! values, and `flight` turns all channels of a `flight.toml` into spikes.
//!
//! `codec` is the only module that knows the run-time codecs of the catalogue, and `node` the only one that knows DDS.
//! What is between them, from samples to messages and back, is tested without either's help.

mod arguments;
mod bank;
mod clock;
mod codec;
mod counters;
mod decoding;
mod encoding;
mod failures;
mod message;
mod names;
mod node;
mod settings;
mod wire;

pub use node::{Kind, run};
