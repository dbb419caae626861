//! Event formats of cameras, tools and boards, both ways.
//!
//! | format | for | address | time |
//! |---|---|---|---|
//! | [`Edvs`] | eDVS and mini-eDVS over UART | 14 bits | none, or 16 to 32 bits |
//! | [`EventStream`] | `.es` files, the lossless log | 16 bits | any |
//! | [`Evt2`] | Prophesee's tools | 16 of 22 bits | 34 bits |
//! | [`Evt2Pixels`] | a [camera's events](crate::frame) in Prophesee's tools | x and y, 11 bits each | 34 bits |
//! | [`Evt21Pixels`] | Prophesee's cameras, read only | x and y, 11 bits each | 34 bits |
//! | [`Evt3Pixels`] | Prophesee's cameras and tools | x and y, 11 bits each | any |
//! | [`Dvs`] | a camera's events in `.es` files | x and y, 16 bits each | any |
//! | [`eieio`] | `SpiNNaker` boards, by UDP datagram | 32-bit keys | 32 bits a datagram |
//!
//! A format is plain data and makes its encoder and decoder. Encoders write whole events into the caller's buffer.
//! Decoders take a byte at a time, from anywhere in a stream, never panic, and count the bytes that they skip.
//!
//! **Time** goes forward in all formats but [`eieio`] and eDVS E4: an event earlier than the one before it is written at
//! the time of that one, or, by eDVS E2 and E3, at a later time. Ticks wrap, so that an event counts as earlier if its tick
//! lies up to 2²⁴ µs (16.8 s) back, and otherwise as later: after a silence of up to 71.3 minutes. A longer silence is
//! written 2³² µs shorter, which leaves every tick as it is. Every event that will be read at another tick is counted as
//! [retimed](EventFormat::retimed).

mod dvs;
mod edvs;
pub mod eieio;
mod event_stream;
mod evt2;
mod evt21_pixels;
mod evt2_pixels;
mod evt3_pixels;
mod formatted;

use core::fmt;

use spikewire::{Event, Tick};

pub use dvs::{Dvs, DvsDecoder, DvsEncoder};
pub use edvs::{Edvs, EdvsDecoder, EdvsEncoder, EdvsTime};
pub use event_stream::{EventStream, EventStreamDecoder, EventStreamEncoder};
pub use evt2::{Evt2, Evt2Decoder, Evt2Encoder};
pub use evt2_pixels::{Evt2Pixels, Evt2PixelsDecoder, Evt2PixelsEncoder};
pub use evt3_pixels::{Evt3Pixels, Evt3PixelsDecoder, Evt3PixelsEncoder};
pub use evt21_pixels::{Evt21Order, Evt21Pixels, Evt21PixelsDecoder};
pub use formatted::Formatted;

/// Writes events, one after the other: [`Event`]s with an address, or the
/// [`PixelEvent`](crate::frame::PixelEvent)s of a camera.
pub trait EventFormat<E = Event> {
    /// The length of the longest piece that is written at once. A buffer of this length always has room for an event,
    /// or for part of the time before it.
    const LONGEST: usize;

    /// Writes an event at the start of `bytes` and returns its length.
    ///
    /// # Errors
    /// Returns an error if the event does not fit, or the format has no word for its address.
    fn encode(&mut self, event: E, bytes: &mut [u8]) -> Result<usize, FormatError>;

    /// How many events will be read at another time than their own.
    fn retimed(&self) -> u32;
}

/// Reads events, a byte at a time: [`Event`]s with an address, or a camera's
/// [`PixelEvent`](crate::frame::PixelEvent)s.
pub trait EventDecoder<E = Event> {
    /// Takes a byte, and returns the event that it completes, or the first of several. Take the others with
    /// [`pending`](Self::pending) before the next byte.
    fn push(&mut self, byte: u8) -> Option<E>;

    /// Returns the next event of a word with several, in formats that have such words.
    fn pending(&mut self) -> Option<E> {
        None
    }

    /// How many bytes were skipped, as they belonged to no event that could be read.
    fn skipped(&self) -> u32;

    /// Whether the last bytes are part of an event or a header that has not ended: a stream that ends here was cut.
    fn is_partial(&self) -> bool;

    /// Takes bytes, cut anywhere, and returns the events that they complete. Take all of these.
    fn decode(&mut self, bytes: &[u8]) -> impl Iterator<Item = E> {
        let mut bytes = bytes.iter();
        core::iter::from_fn(move || {
            loop {
                let pending = self.pending();
                if pending.is_some() {
                    return pending;
                }
                let event = self.push(*bytes.next()?);
                if event.is_some() {
                    return event;
                }
            }
        })
    }
}

/// Why an event was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum FormatError {
    /// The event does not fit the buffer: send what is written, and offer the event again.
    Full {
        /// How many bytes of the time before the event were written. They count, and are not written again.
        written: usize,
    },
    /// The format has no word for the address.
    Address {
        /// The address that was given.
        address: u16,
        /// The largest allowed.
        max: u16,
    },
    /// The pixel lies outside the picture, whose size is in the file's header.
    Pixel {
        /// Its column.
        x: u16,
        /// Its row.
        y: u16,
    },
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Full { .. } => write!(f, "the event does not fit the buffer"),
            Self::Address { address, max } => {
                write!(f, "address {address} is above {max}, the format's largest")
            }
            Self::Pixel { x, y } => {
                write!(f, "pixel {x}, {y} lies outside the picture that the header tells")
            }
        }
    }
}

impl core::error::Error for FormatError {}

/// How much earlier than the event before an event may be, in µs. One that looks earlier still comes after a silence.
const MOST_EARLIER: u32 = 1 << 24;

/// The time that a reader of the stream has reached, and the count of retimed events.
#[derive(Clone, Copy, Debug, Default)]
struct Clock {
    tick: Tick,
    retimed: u32,
}

impl Clock {
    const fn starting_at(tick: Tick) -> Self {
        Self { tick, retimed: 0 }
    }

    /// How much later an event is, in microseconds; 0 and true if it is earlier and must be retimed.
    fn since(self, tick: Tick) -> (u32, bool) {
        let delta = tick.since(self.tick).cast_unsigned();
        let is_earlier = delta >= MOST_EARLIER.wrapping_neg();
        (if is_earlier { 0 } else { delta }, is_earlier)
    }

    /// Adds time that was written.
    fn advance(&mut self, delta: u32, is_retimed: bool) {
        self.tick += delta;
        self.retimed = self.retimed.saturating_add(is_retimed.into());
    }
}
