//! Event Stream (`.es`), DVS type: the pixels of an event camera.

use super::{Clock, EventDecoder, EventFormat, FormatError};
use crate::bytes::Cursor;
use crate::frame::PixelEvent;
use spikewire::Polarity;
use spikewire::Tick;

/// Event Stream version 2, DVS events, of a [camera](crate::frame) of this size.
///
/// - **Layout:** the [header](Self::header), then five bytes an event: the first has the µs since the event before in
///   its upper 7 bits, and 1 for up in its lowest; x and y follow in 16 bits each, little endian. Between events the
///   byte `FF` adds 127 µs, and `FE` is a reset.
/// - **Rows:** as this crate counts them, from the top; a viewer that draws y upwards shows the picture upside down.
/// - **Length:** 5 bytes an event, and one for every 127 µs between two.
/// - **Resynchronisation:** none, as it is a file format: a damaged byte may spoil all events after it.
///
/// Source: Event Stream specification, neuromorphic-paris/event_stream.
///
/// ```
/// use spikewire::{Polarity, Tick};
/// use spikewire_cameras::frame::PixelEvent;
/// use spikewire_cameras::format::{Dvs, EventDecoder, EventFormat};
///
/// let camera = Dvs::new(320, 240);
/// let event = PixelEvent { tick: Tick::from_micros(130), x: 5, y: 239, polarity: Polarity::Up };
/// let mut bytes = [0; 8];
/// assert_eq!(camera.encoder().encode(event, &mut bytes), Ok(6));
/// assert_eq!(bytes[..6], [0xFF, 0x07, 5, 0, 239, 0]);
///
/// let mut decoder = Dvs::decoder();
/// assert_eq!(decoder.decode(&camera.header()).count(), 0);
/// assert!(decoder.decode(&bytes[..6]).eq([event]));
/// assert_eq!(decoder.size(), Some((320, 240)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dvs {
    width: u16,
    height: u16,
}

const MAGIC: [u8; 16] = *b"Event Stream\x02\0\0\x01";
const HEADER: usize = MAGIC.len() + 4;
const RESET: u8 = 0xFE;
const OVERFLOW: u8 = 0xFF;
const OVERFLOW_TICKS: u32 = 127;

impl Dvs {
    /// A camera of `width` columns and `height` rows.
    pub const fn new(width: u16, height: u16) -> Self {
        Self { width, height }
    }

    /// The first bytes of a file: magic, version 2.0.0, type 1, width and height.
    pub const fn header(&self) -> [u8; 20] {
        let [m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, ma, mb, mc, md, me, mf] = MAGIC;
        let ([w0, w1], [h0, h1]) = (self.width.to_le_bytes(), self.height.to_le_bytes());
        [m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, ma, mb, mc, md, me, mf, w0, w1, h0, h1]
    }

    /// An encoder of a file that begins at tick 0. Write the [header](Self::header) before the first event.
    pub const fn encoder(&self) -> DvsEncoder {
        self.encoder_from(Tick::from_micros(0))
    }

    /// An encoder of a file that begins at this tick. The file counts time from there, and does not contain the tick
    /// itself.
    pub const fn encoder_from(&self, start: Tick) -> DvsEncoder {
        DvsEncoder { camera: *self, clock: Clock::starting_at(start) }
    }

    /// A decoder of a file that begins at tick 0, from its header on.
    pub const fn decoder() -> DvsDecoder {
        Self::decoder_from(Tick::from_micros(0))
    }

    /// A decoder of a file that begins at this tick, from its header on.
    pub const fn decoder_from(start: Tick) -> DvsDecoder {
        DvsDecoder { tick: start, size: [0; 4], state: State::Header(0), skipped: 0 }
    }
}

/// The encoder of [`Dvs`].
#[derive(Clone, Copy, Debug)]
pub struct DvsEncoder {
    camera: Dvs,
    clock: Clock,
}

impl EventFormat<PixelEvent> for DvsEncoder {
    const LONGEST: usize = 5;

    /// Writes an event. The time before it, a byte for every 127 µs, is written as far as it fits and is not written
    /// again when the event is offered again.
    fn encode(&mut self, event: PixelEvent, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let PixelEvent { tick, x, y, polarity } = event;
        let Dvs { width, height } = self.camera;
        if x >= width || y >= height {
            return Err(FormatError::Pixel { x, y });
        }
        let (mut delta, is_retimed) = self.clock.since(tick);
        let mut out = Cursor::new(bytes);
        while delta >= OVERFLOW_TICKS {
            out.put(&[OVERFLOW]).ok_or(FormatError::Full { written: out.written() })?;
            self.clock.advance(OVERFLOW_TICKS, false);
            delta -= OVERFLOW_TICKS;
        }
        let first = (delta as u8) << 1 | u8::from(polarity == Polarity::Up);
        let ([x0, x1], [y0, y1]) = (x.to_le_bytes(), y.to_le_bytes());
        out.put(&[first, x0, x1, y0, y1]).ok_or(FormatError::Full { written: out.written() })?;
        self.clock.advance(delta, is_retimed);
        Ok(out.written())
    }

    fn retimed(&self) -> u32 {
        self.clock.retimed
    }
}

/// The decoder of [`Dvs`].
///
/// Events outside the picture are skipped, and so is a file with another header.
#[derive(Clone, Copy, Debug)]
pub struct DvsDecoder {
    tick: Tick,
    size: [u8; 4],
    state: State,
    skipped: u32,
}

#[derive(Clone, Copy, Debug)]
enum State {
    /// This many bytes of the header were right.
    Header(u8),
    /// The header was another one.
    Foreign,
    Time,
    Pixel {
        polarity: Polarity,
        bytes: [u8; 4],
        at: u8,
    },
}

impl DvsDecoder {
    /// Whether the header is that of another format or type, so that no event is read.
    pub const fn is_foreign(&self) -> bool {
        matches!(self.state, State::Foreign)
    }

    /// The columns and rows; `None` before the header has been read.
    pub const fn size(&self) -> Option<(u16, u16)> {
        let [w0, w1, h0, h1] = self.size;
        match self.state {
            State::Header(_) | State::Foreign => None,
            _ => Some((u16::from_le_bytes([w0, w1]), u16::from_le_bytes([h0, h1]))),
        }
    }

    fn skip(&mut self, count: u32) {
        self.skipped = self.skipped.saturating_add(count);
    }

    fn header(&mut self, at: u8, byte: u8) -> State {
        let place = usize::from(at);
        // Minor versions and patches change nothing that is read here.
        let is_good =
            MAGIC.get(place).is_none_or(|&expected| byte == expected || at == 13 || at == 14);
        if let Some(slot) = self.size.get_mut(place.wrapping_sub(MAGIC.len())) {
            *slot = byte;
        }
        match is_good {
            false => State::Foreign,
            true if place + 1 == HEADER => State::Time,
            true => State::Header(at.wrapping_add(1)),
        }
    }

    fn event(&mut self, polarity: Polarity, [x0, x1, y0, y1]: [u8; 4]) -> Option<PixelEvent> {
        self.state = State::Time;
        let (width, height) = self.size()?;
        let (x, y) = (u16::from_le_bytes([x0, x1]), u16::from_le_bytes([y0, y1]));
        if x >= width || y >= height {
            self.skip(5);
            return None;
        }
        Some(PixelEvent { tick: self.tick, x, y, polarity })
    }
}

impl EventDecoder<PixelEvent> for DvsDecoder {
    fn push(&mut self, byte: u8) -> Option<PixelEvent> {
        self.state = match self.state {
            State::Header(at) => self.header(at, byte),
            State::Foreign => {
                self.skip(1);
                State::Foreign
            }
            State::Time if byte == RESET => State::Time,
            State::Time if byte == OVERFLOW => {
                self.tick += OVERFLOW_TICKS;
                State::Time
            }
            State::Time => {
                self.tick += u32::from(byte >> 1);
                let polarity = if byte & 1 == 1 { Polarity::Up } else { Polarity::Down };
                State::Pixel { polarity, bytes: [0; 4], at: 0 }
            }
            State::Pixel { polarity, mut bytes, at } => {
                if let Some(slot) = bytes.get_mut(usize::from(at)) {
                    *slot = byte;
                }
                if at == 3 {
                    return self.event(polarity, bytes);
                }
                State::Pixel { polarity, bytes, at: at.wrapping_add(1) }
            }
        };
        None
    }

    fn skipped(&self) -> u32 {
        self.skipped
    }

    fn is_partial(&self) -> bool {
        !matches!(self.state, State::Time | State::Header(0) | State::Foreign)
    }
}
