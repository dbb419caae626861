//! Event formats of cameras, tools and boards, both ways.
//!
//! | format | for | address | time |
//! |---|---|---|---|
//! | [`Edvs`] | eDVS and mini-eDVS over UART | 14 bits | none, or 16 to 32 bits |
//! | [`EventStream`] | `.es` files, the lossless log | 16 bits | any |
//! | [`Evt2`] | Prophesee's tools | 16 of 22 bits | 34 bits |
//! | [`eieio`] | `SpiNNaker` boards, by UDP datagram | 32-bit keys | 32 bits a datagram |
//!
//! A format is plain data and makes its encoder and decoder. Encoders write whole events into the
//! caller's buffer; decoders take a byte at a time, from anywhere in a stream, never panic, and count
//! what they skip.
//!
//! The formats but [`eieio`] and eDVS E4 have no way to step back in time: an event earlier than the
//! one before it is written at that one's time, or, by eDVS E2 and E3, at a later one. One that comes
//! 2³¹ µs (35.8 minutes) or more after the one before looks as if it were earlier. Every event that
//! will be read at another time is counted as retimed.

mod edvs;
pub mod eieio;
mod event_stream;
mod evt2;

use core::fmt;

use crate::event::{Event, Tick};

pub use edvs::{Edvs, EdvsDecoder, EdvsEncoder, EdvsTime};
pub use event_stream::{EventStream, EventStreamDecoder, EventStreamEncoder};
pub use evt2::{Evt2, Evt2Decoder, Evt2Encoder};

/// Writes events, one after the other.
pub trait EventFormat {
    /// The bytes of the longest piece that is written at once: in as many, an event, or some of the
    /// time before it, always fits.
    const LONGEST: usize;

    /// Writes an event at the start of `bytes` and returns its length.
    ///
    /// # Errors
    /// The event does not fit, or the format has no word for its address.
    fn encode(&mut self, event: Event, bytes: &mut [u8]) -> Result<usize, FormatError>;

    /// How many events were written so that they are read at another time than theirs.
    fn retimed(&self) -> u32;
}

/// Reads events, a byte at a time.
pub trait EventDecoder {
    /// Takes a byte, and returns the event that it completes.
    fn push(&mut self, byte: u8) -> Option<Event>;

    /// How many bytes belonged to no event that could be read.
    fn skipped(&self) -> u32;

    /// Whether the last bytes begin something that has not ended: a stream that ends here is cut.
    fn is_partial(&self) -> bool;

    /// Takes bytes, cut anywhere, and returns the events that they complete. Run it to its end.
    fn decode(&mut self, bytes: &[u8]) -> impl Iterator<Item = Event> {
        bytes.iter().filter_map(|&byte| self.push(byte))
    }
}

/// Why an event was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum FormatError {
    /// The event does not fit: offer it again with the rest of the buffer used.
    Full {
        /// How many bytes were written nevertheless: time that passed before the event, which is
        /// not written again.
        written: usize,
    },
    /// The format has no word for the address.
    Address {
        /// What it was.
        address: u16,
        /// The largest allowed.
        max: u16,
    },
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Full { .. } => write!(f, "the event does not fit the buffer"),
            Self::Address { address, max } => {
                write!(f, "address {address} is above {max}, the format's largest")
            }
        }
    }
}

impl core::error::Error for FormatError {}

/// The time at which a reader that began with the writer is.
#[derive(Clone, Copy, Debug, Default)]
struct Clock {
    tick: Tick,
    retimed: u32,
}

impl Clock {
    const fn starting_at(tick: Tick) -> Self {
        Self { tick, retimed: 0 }
    }

    /// How much later an event is, in microseconds, and whether it is earlier and has to be retimed.
    fn since(self, tick: Tick) -> (u32, bool) {
        let delta = tick.since(self.tick);
        (delta.max(0) as u32, delta < 0)
    }

    /// Goes on by time that was written.
    fn advance(&mut self, delta: u32, is_retimed: bool) {
        self.tick += delta;
        self.retimed = self.retimed.saturating_add(is_retimed.into());
    }
}
