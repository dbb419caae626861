//! Reads and writes streams of events in every format, in constant memory.
//!
//! The codecs of the formats are in the crate; this module moves bytes, and counts what a format cannot hold.

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

/// One item of a stream; items come in the order of the stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item {
    /// A spike.
    Event(Event),
    /// The value that the sender's encoder held.
    Keyframe(Keyframe),
    /// The tick of a sample, and the first address of its bank. Only codes without keyframes send it; it says that all
    /// events before it have been sent.
    Heartbeat(Tick, u16),
    /// The value of a decoder after an event or keyframe.
    Value {
        /// Tick of the event or keyframe.
        tick: Tick,
        /// Address of the decoder.
        address: u16,
        /// The value, in the recording's unit.
        value: f64,
        /// How certain the value is.
        known: Known,
    },
    /// Frames were lost on the link; holds their number.
    LostFrames(u32),
    /// Events were lost by the sender.
    LostEvents,
    /// The sender restarted.
    Restart,
}

/// How certain a decoded value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// The value is that of a keyframe.
    Keyframe,
    /// The value equals that of the sender's own decoder, bit for bit.
    Exact,
    /// The value may be off: something was lost since the last keyframe, or there was no keyframe yet.
    Estimate,
}

/// Converts bytes of a format to items.
pub trait EventReader {
    /// Reads bytes, which may be cut anywhere, and appends the items that they complete.
    ///
    /// # Errors
    /// Returns an error if the bytes are of another format.
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()>;

    /// Ends the input; appends items that were held back.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    fn finish(&mut self, _: &mut Vec<Item>) -> Result<()> {
        Ok(())
    }

    /// Returns counts of everything that is not an event.
    fn tally(&self) -> Tally;

    /// Sets the time of arrival of the next bytes, for a format whose events have no times.
    fn set_arrival(&mut self, _: Tick) {}
}

/// Converts items to bytes of a format.
pub trait EventWriter {
    /// Writes an item, or keeps it to be written later.
    ///
    /// # Errors
    /// Returns an error if the format cannot express the item, or if the output cannot be written.
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()>;

    /// Writes the items that were kept.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    fn finish(&mut self, output: &mut dyn Write) -> Result<()>;

    /// Returns notes on what the format could not hold.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}
