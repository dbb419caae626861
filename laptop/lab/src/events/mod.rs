//! Streams of events in every format, there and back, in constant memory.
//!
//! The formats themselves are the crate's; here bytes are moved, and what a format cannot hold is counted.

mod bytes;
mod csv;
mod eieio;
mod format;
mod kinds;
mod link;
mod omitted;
mod stream;
mod tally;
mod whole;

pub use format::{Format, values_writer};
pub use kinds::EventsKind;
pub use link::{LinkReader, Values};
pub use stream::Stream;
pub use tally::{Held, LinkTally, Tally};
pub use whole::{Events, read_events, write_events};

use crate::Result;
use spikewire::{Event, Keyframe, Tick};
use std::io::Write;

/// One item of a stream, in its order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item {
    /// A spike.
    Event(Event),
    /// The value that the sender's encoder held.
    Keyframe(Keyframe),
    /// A sample of a code without keyframes, whose events are all told: its tick, and its bank's first address.
    Heartbeat(Tick, u16),
    /// The value of an address's decoder after an event or keyframe.
    Value {
        /// When.
        tick: Tick,
        /// Where.
        address: u16,
        /// The value, in the recording's unit.
        value: f64,
        /// The certainty of the value.
        known: Known,
    },
    /// This many frames never arrived.
    LostFrames(u32),
    /// The sender lost events.
    LostEvents,
    /// The sender began anew.
    Restart,
}

/// The certainty of a decoded value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// The value came as a keyframe.
    Keyframe,
    /// The value is that of the sender's own decoder, bit for bit.
    Exact,
    /// Something was lost since the last keyframe, or there was none yet.
    Estimate,
}

/// Turns bytes into items.
pub trait EventReader {
    /// Takes bytes, cut anywhere, and adds what they complete.
    ///
    /// # Errors
    /// Returns an error if the bytes are of another format.
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()>;

    /// The end of the bytes; adds what was held back.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    fn finish(&mut self, _: &mut Vec<Item>) -> Result<()> {
        Ok(())
    }

    /// The counts of all that is no event.
    fn tally(&self) -> Tally;

    /// Tells a format without times the time of the bytes that come next.
    fn set_arrival(&mut self, _: Tick) {}
}

/// Turns items into bytes.
pub trait EventWriter {
    /// Writes an item, or keeps it for later.
    ///
    /// # Errors
    /// The format cannot hold it, or the output failed.
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()>;

    /// Writes what was kept.
    ///
    /// # Errors
    /// The output failed.
    fn finish(&mut self, output: &mut dyn Write) -> Result<()>;

    /// Sentences on what the format could not hold.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}
