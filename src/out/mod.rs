//! Sinks: send items over SPI or a serial port.
//!
//! A sink takes items from a [`Source`](crate::Source), such as the consumer of a queue, one batch at a time. No item is
//! lost on an error: the sink keeps what it could not send, and sends it first the next time.

mod error;
#[cfg(feature = "embedded-io-06")]
mod io06;
#[cfg(feature = "embedded-io-07")]
mod serial;
#[cfg(feature = "embedded-hal")]
mod spi;

pub use crate::wire::Batch;
pub use error::SinkError;
#[cfg(feature = "embedded-io-06")]
pub use io06::{Io06, Io06Error};
#[cfg(feature = "embedded-io-07")]
pub use serial::SerialSink;
#[cfg(feature = "async")]
pub use spi::AsyncSpiSink;
#[cfg(feature = "embedded-hal")]
pub use spi::{AlwaysReady, SpiSink};
