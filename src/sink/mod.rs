//! Where events go: a queue to main, a bus, a serial port.
//!
//! A sink takes events from an [`EventSource`](crate::EventSource), which is a queue as `&EVENTS` or
//! any iterator, and takes no more than it can keep. Nothing is lost on an error: what a sink took and could not send, it
//! holds and sends first the next time.

mod batch;
mod error;
#[cfg(feature = "queue")]
mod queue;
#[cfg(feature = "embedded-io")]
mod serial;
#[cfg(feature = "embedded-hal")]
mod spi;

pub use batch::{Batch, Formatted};
pub use error::SinkError;
#[cfg(feature = "queue")]
pub use queue::{Drain, Drained, EventQueue, Overflow, Refused};
#[cfg(feature = "embedded-io")]
pub use serial::SerialSink;
#[cfg(feature = "async")]
pub use spi::AsyncSpiSink;
#[cfg(feature = "embedded-hal")]
pub use spi::{AlwaysReady, SpiSink};
