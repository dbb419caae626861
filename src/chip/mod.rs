//! Neuromorphic chips, each in its own words.
//!
//! | chip | spikes in | spikes out | how it was checked |
//! |---|---|---|---|
//! | [`TinyOdin`], [`Odin`] | parallel bus, 4-phase handshake | the same | bytes and words of the RTL in simulation; models of the chips, clock by clock |
//! | [`Akd1500`] | a window onto memory, over SPI | the same | bytes of the vendor's library |
//! | [`Xylo`] | counts in registers | a status register | the registers in the vendor's sources |
//!
//! None of this has been seen on hardware. None of the buses has a checksum: what can be read back
//! should be, and every chip here can verify what it writes.
//!
//! No wait is unbounded: each looks at the pins or registers as often as it is told, then returns an
//! error.

mod akd1500;
mod error;
mod family;
mod odin;
mod output_source;
mod tinyodin;
mod xylo;

pub use akd1500::{Akd1500, ConvolutionEvent, DenseEvent};
pub use error::ChipError;
pub use family::{
    AerPort, Counters, Describe, FormatError, Gated, Input, Inputs, Network, NetworkBytes,
    OdinChip, Phase, Progress, Running, Spikes,
};
pub use odin::{
    Odin, OdinInput, OdinLearning, OdinNetwork, OdinNeuron, OdinRegisters, OdinSynapse,
};
pub use output_source::OutputSource;
pub use tinyodin::{TinyOdin, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, TinyOdinRegisters};
pub use xylo::{InputBank, Registers, Xylo, XyloMap, pack_counts};
