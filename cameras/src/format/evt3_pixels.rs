//! EVT 3.0: the default format of Prophesee's IMX636 cameras, words of 16 bits.

use super::evt2::X_MASK;
use super::evt21_pixels::take_valid;
use super::{Clock, EventDecoder, EventFormat, FormatError};
use crate::bytes::Cursor;
use crate::frame::PixelEvent;
use spikewire::{Polarity, Tick};

/// Prophesee EVT 3.0: words of 16 bits, little endian, each of which changes the time, the row or the columns.
///
/// - **Words**, by type\[15:12\]: 0 the row, y\[10:0\]; 2 an event, polarity\[11\] and x\[10:0\]; 3 the first column of a
///   vector, likewise; 4 and 5 a vector of 12 or 8 columns, a bit each, after which the next vector begins; 6 the low 12
///   bits of the time; 8 the next 12 bits, with which the low ones are 0.
/// - **Time:** 24 bits of µs; a jump back by nearly all of them counts as a wrap, after 16.8 s.
/// - **Length:** 2 bytes an event, and 2 for each of row and times that change. Events are written one by one, not as
///   vectors. A silence takes 4 bytes for each 16.8 s.
/// - **Resynchronisation:** with the next words of time and row; the stream must be read from the start of a word,
///   after a file's header.
///
/// Source: Prophesee, EVT 3.0 format.
///
/// ```
/// use spikewire::{Polarity, Tick};
/// use spikewire_cameras::format::{EventDecoder, EventFormat, Evt3Pixels};
/// use spikewire_cameras::frame::PixelEvent;
///
/// let event = PixelEvent { tick: Tick::from_micros(0x1041), x: 5, y: 239, polarity: Polarity::Up };
/// let mut bytes = [0; 8];
/// assert_eq!(Evt3Pixels::encoder().encode(event, &mut bytes), Ok(8));
/// assert_eq!(bytes, [0x01, 0x80, 0x41, 0x60, 0xEF, 0x00, 0x05, 0x28]);
/// assert!(Evt3Pixels::decoder().decode(&bytes).eq([event]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evt3Pixels;

const ROW: u16 = 0;
const COLUMN: u16 = 2;
const VECTOR_BASE: u16 = 3;
const VECTOR_12: u16 = 4;
const VECTOR_8: u16 = 5;
const TIME_LOW: u16 = 6;
const TIME_HIGH: u16 = 8;
const PAYLOAD: u16 = 0x0FFF;
const POLARITY: u16 = 0x0800;
const TIME_BITS: u32 = 12;
/// Bits of the time that a word of type [`TIME_HIGH`] has: `PAYLOAD`, as a part of the upper 20 bits of a tick.
const HIGH: u32 = PAYLOAD as u32;
/// The time in a wrap goes back by at least this much, in units of the words of type [`TIME_HIGH`]. Smaller steps back are
/// words that come out of order.
const WRAP: u32 = HIGH - 10;

impl Evt3Pixels {
    /// An encoder. For a file, write the header first: `% evt 3.0`, `% format EVT3;height=H;width=W`,
    /// `% geometry WxH` and `% end`, a line each.
    pub const fn encoder() -> Evt3PixelsEncoder {
        Evt3PixelsEncoder { clock: None, high: None, low: None, row: None, retimed: 0 }
    }

    /// A decoder of words, from the start of a word on.
    pub const fn decoder() -> Evt3PixelsDecoder {
        Evt3PixelsDecoder {
            first: None,
            high: None,
            low: 0,
            row: None,
            base: 0,
            polarity: Polarity::Up,
            next: PixelEvent { tick: Tick::from_micros(0), x: 0, y: 0, polarity: Polarity::Up },
            valid: 0,
            skipped: 0,
        }
    }
}

/// The encoder of [`Evt3Pixels`].
#[derive(Clone, Copy, Debug)]
pub struct Evt3PixelsEncoder {
    /// The tick of the last event.
    clock: Option<Tick>,
    /// The upper 20 bits of the tick that a reader of the words has reached.
    high: Option<u32>,
    /// The low 12 bits, if they were written after the upper ones.
    low: Option<u16>,
    row: Option<u16>,
    retimed: u32,
}

impl EventFormat<PixelEvent> for Evt3PixelsEncoder {
    const LONGEST: usize = 2;

    /// Writes an event. The words of time and row before it are written as far as they fit, and are not written again
    /// when the event is offered again.
    fn encode(&mut self, event: PixelEvent, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let PixelEvent { tick, x, y, polarity } = event;
        if u32::from(x.max(y)) > X_MASK {
            return Err(FormatError::Pixel { x, y });
        }
        let last = self.clock.unwrap_or(tick);
        let (delta, is_retimed) = Clock::starting_at(last).since(tick);
        let mut time = last;
        time += delta;
        let (high, low) = (time.micros() >> TIME_BITS, time.micros() as u16 & PAYLOAD);

        let mut out = Cursor::new(bytes);
        while let Some(next) = self.next_high(high) {
            put(&mut out, TIME_HIGH, (next & HIGH) as u16)?;
            (self.high, self.low) = (Some(next), Some(0));
        }
        if self.low != Some(low) {
            put(&mut out, TIME_LOW, low)?;
            self.low = Some(low);
        }
        if self.row != Some(y) {
            put(&mut out, ROW, y)?;
            self.row = Some(y);
        }
        let up = if polarity == Polarity::Up { POLARITY } else { 0 };
        put(&mut out, COLUMN, up | x)?;
        self.clock = Some(time);
        self.retimed = self.retimed.saturating_add(is_retimed.into());
        Ok(out.written())
    }

    fn retimed(&self) -> u32 {
        self.retimed
    }
}

impl Evt3PixelsEncoder {
    /// Returns the time of the next word of type [`TIME_HIGH`] on the way to `high`; `None` if there is no way to go. A
    /// reader sees a wrap only from the last of the 4096 times to the first.
    fn next_high(&self, high: u32) -> Option<u32> {
        // A reader begins in the first of the wraps.
        let Some(now) = self.high else { return Some(high.min(HIGH)) };
        let end = now | HIGH;
        // The upper 20 bits of ticks wrap.
        let way = high.wrapping_sub(now) & (u32::MAX >> TIME_BITS);
        match way {
            0 => None,
            _ if way <= end.wrapping_sub(now) => Some(high),
            _ if now == end => Some(end.wrapping_add(1) & (u32::MAX >> TIME_BITS)),
            _ => Some(end),
        }
    }
}

fn put(out: &mut Cursor<'_>, kind: u16, payload: u16) -> Result<(), FormatError> {
    let full = FormatError::Full { written: out.written() };
    out.put(&(kind << TIME_BITS | payload).to_le_bytes()).ok_or(full)
}

/// The decoder of [`Evt3Pixels`].
///
/// Triggers and other words are skipped, and so are events before the first words of time and row.
#[derive(Clone, Copy, Debug)]
pub struct Evt3PixelsDecoder {
    /// The first byte of a word.
    first: Option<u8>,
    /// The upper 20 bits of the tick.
    high: Option<u32>,
    low: u16,
    row: Option<u16>,
    /// First column of the next vector.
    base: u16,
    /// Polarity of vectors.
    polarity: Polarity,
    /// The event of the lowest bit of `valid`.
    next: PixelEvent,
    /// The pixels of the last word that have not been returned yet.
    valid: u32,
    skipped: u32,
}

impl Evt3PixelsDecoder {
    fn word(&mut self, word: u16) {
        let payload = word & PAYLOAD;
        let column = payload & !POLARITY;
        let polarity = if payload & POLARITY == 0 { Polarity::Down } else { Polarity::Up };
        match word >> TIME_BITS {
            ROW => self.row = Some(column),
            COLUMN => self.events(column, polarity, 1),
            VECTOR_BASE => (self.base, self.polarity) = (column, polarity),
            VECTOR_12 => self.vector(payload, 12),
            VECTOR_8 => self.vector(payload & 0xFF, 8),
            TIME_LOW => self.low = payload,
            TIME_HIGH => self.time_high(payload.into()),
            _ => self.skip(),
        }
    }

    fn vector(&mut self, valid: u16, columns: u16) {
        self.events(self.base, self.polarity, valid.into());
        self.base = self.base.wrapping_add(columns);
    }

    fn events(&mut self, x: u16, polarity: Polarity, valid: u32) {
        let (Some(high), Some(y)) = (self.high, self.row) else { return self.skip() };
        let tick = Tick::from(high << TIME_BITS | u32::from(self.low));
        self.next = PixelEvent { tick, x, y, polarity };
        self.valid = valid;
    }

    fn time_high(&mut self, time: u32) {
        let high = match self.high {
            None => time,
            Some(now) => {
                let is_wrap = (now & HIGH).saturating_sub(time) >= WRAP;
                let wraps = (now >> TIME_BITS).wrapping_add(is_wrap.into());
                wraps << TIME_BITS | time
            }
        };
        (self.high, self.low) = (Some(high), 0);
    }

    fn skip(&mut self) {
        self.skipped = self.skipped.saturating_add(2);
    }
}

impl EventDecoder<PixelEvent> for Evt3PixelsDecoder {
    fn push(&mut self, byte: u8) -> Option<PixelEvent> {
        match self.first.take() {
            None => self.first = Some(byte),
            Some(first) => self.word(u16::from_le_bytes([first, byte])),
        }
        self.pending()
    }

    fn pending(&mut self) -> Option<PixelEvent> {
        take_valid(&mut self.valid, self.next)
    }

    fn skipped(&self) -> u32 {
        self.skipped
    }

    fn is_partial(&self) -> bool {
        self.first.is_some()
    }
}
