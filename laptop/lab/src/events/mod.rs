//! Reads and writes streams of events in every format, in constant memory.
//!
//! The codecs of the formats are in `spikewire` and `spikewire-cameras`. This module moves bytes through the codecs,
//! and counts the items that a format cannot hold.

mod bytes;
mod csv;
mod dvs;
mod eieio;
mod format;
mod kinds;
mod link;
mod omitted;
mod pixels;
mod prophesee;
mod stream;
mod tally;
mod whole;

pub use format::{Format, values_writer};
pub use kinds::EventsKind;
pub use link::{LinkReader, Values};
pub use stream::Stream;
pub use tally::{Held, LinkTally, Tally};
pub use whole::{Events, read_events, write_events, write_pixels};

use crate::Result;
use spikewire::{Event, Keyframe, Tick};
pub use spikewire_cameras::frame::PixelEvent;
use std::io::Write;

/// One item of a stream of events. Items have the order in which they were sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item {
    /// A spike.
    Event(Event),
    /// An event of a camera's pixel. A stream has either these or spikes.
    Pixel(PixelEvent),
    /// A value that the sender's encoder held, from which a decoder can resume.
    Keyframe(Keyframe),
    /// A heartbeat, sent for a sample by a sender whose code has no keyframes. The fields are the tick of the sample
    /// and the first address of the sender. All events of the sample come before the heartbeat.
    Heartbeat(Tick, u16),
    /// The value of a decoder after an event or keyframe.
    Value {
        /// Tick of the event or keyframe that gave the value.
        tick: Tick,
        /// First address of the decoded channel.
        address: u16,
        /// The decoded value, in the recording's unit.
        value: f64,
        /// Certainty that the value equals the value of the sender's own decoder.
        known: Known,
    },
    /// A loss of this number of frames on the link.
    LostFrames(u32),
    /// A loss of events in the sender. These events were never sent.
    LostEvents,
    /// A restart of the sender.
    Restart,
}

/// The size of a camera's picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Number of columns.
    pub width: u16,
    /// Number of rows.
    pub height: u16,
}

/// Certainty of a decoded value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// The value comes from a keyframe.
    Keyframe,
    /// The value equals the value of the sender's own decoder, bit for bit.
    Exact,
    /// The value may differ from the sender's: events were lost since the last keyframe, or no keyframe has come yet.
    Estimate,
}

/// A reader of the bytes of one event format. It converts the bytes to items: spikes, keyframes, losses and restarts.
pub trait EventReader {
    /// Reads the next bytes of the input, and appends the items that they complete. The input may be split between any
    /// two bytes.
    ///
    /// # Errors
    /// Returns an error if the bytes belong to a different format.
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()>;

    /// Ends the input, and appends the items that the reader has not appended yet.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    fn finish(&mut self, _: &mut Vec<Item>) -> Result<()> {
        Ok(())
    }

    /// Returns the counts of everything in the stream that is not an event.
    fn tally(&self) -> Tally;

    /// Returns the size of the camera's picture, if the stream has said it.
    fn size(&self) -> Option<Size> {
        None
    }

    /// Sets the time of arrival of the next bytes, for a format whose events have no times.
    fn set_arrival(&mut self, _: Tick) {}
}

/// A writer of one event format. It converts items to the bytes of the format.
pub trait EventWriter {
    /// Writes an item, or keeps it to be written later.
    ///
    /// # Errors
    /// Returns an error if the format cannot express the item, or if the output cannot be written.
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()>;

    /// Sets the size of the camera's picture, for a format that writes it before its first event. Has no effect if the
    /// format's settings have a size.
    fn set_size(&mut self, _: Size) {}

    /// Writes the items that [`write`](Self::write) has kept for later.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    fn finish(&mut self, output: &mut dyn Write) -> Result<()>;

    /// Returns notes on the items that the format could not hold.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}
