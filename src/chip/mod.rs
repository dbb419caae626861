//! Neuromorphic chips, each in its own words.
//!
//! | chip | spikes in | spikes out | how it was checked |
//! |---|---|---|---|
//! | [`TinyOdin`], [`Odin`] | parallel bus, 4-phase handshake | the same | bytes and words of the RTL in simulation; a model of the handshake |
//! | [`Akd1500`] | a window onto memory, over SPI | the same | bytes of the vendor's library |
//! | [`Xylo`] | counts in registers | a status register | the registers in the vendor's sources |
//!
//! None of this has been seen on hardware. None of the buses has a checksum: what can be read back
//! should be, and every chip here can verify what it writes.
//!
//! No wait is unbounded: each looks at the pins or registers as often as it is told, then returns an
//! error.

mod aer;
mod akd1500;
mod error;
mod odin;
mod odin_family;
mod tinyodin;
mod xylo;

pub use aer::{AerPort, Phase};
pub use akd1500::{Akd1500, ConvolutionEvent, DenseEvent};
pub use error::ChipError;
pub use odin::{Odin, OdinInput};
pub use odin_family::{Input, OdinChip};
pub use tinyodin::{TinyOdin, TinyOdinInput};
pub use xylo::{InputBank, Registers, Xylo, XyloMap, pack_counts};
