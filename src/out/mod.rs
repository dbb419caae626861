//! Sinks: items out over SPI or a serial port.
//!
//! A sink takes items from a [`Source`](crate::Source), such as a queue's consumer, and no more than it
//! can keep. Nothing is lost on an error: what a sink took and could not send, it holds and sends first
//! the next time.

mod error;
#[cfg(feature = "embedded-io")]
mod serial;
#[cfg(feature = "embedded-hal")]
mod spi;

pub use crate::wire::{Batch, Formatted};
pub use error::SinkError;
#[cfg(feature = "embedded-io")]
pub use serial::SerialSink;
#[cfg(feature = "async")]
pub use spi::AsyncSpiSink;
#[cfg(feature = "embedded-hal")]
pub use spi::{AlwaysReady, SpiSink};
