//! Event Stream (`.es`) of the generic type: a log file of events that loses nothing.

use super::{Clock, EventDecoder, EventFormat, FormatError};
use crate::bytes::Cursor;
use spikewire::Polarity;
use spikewire::{Event, Tick};

/// Event Stream version 2, generic events whose payload is the address, little endian, and a byte
/// that is 1 for up and 0 for down.
///
/// - **Layout:** the [header](Self::HEADER), then for each event the µs since the one before (a byte up to 253; `FF`
///   adds 254 µs, `FE` is a reset), the size of the payload, and the payload. The size comes in groups of 7 bits,
///   lowest group first, each with a lowest bit that is 1 if another group follows.
/// - **Length:** 5 bytes an event, and one for every 254 µs between two.
/// - **Resynchronisation:** none, as it is a file format: a damaged byte may spoil all events after it.
///
/// Source: Event Stream specification, neuromorphic-paris/event_stream.
///
/// ```
/// use spikewire::{Event, Polarity, Tick};
/// use spikewire_cameras::format::{EventDecoder, EventFormat, EventStream};
///
/// let event = Event { tick: Tick::from_micros(300), address: 0x0102, polarity: Polarity::Up };
/// let mut bytes = [0; 8];
/// assert_eq!(EventStream::encoder().encode(event, &mut bytes), Ok(6));
/// assert_eq!(bytes[..6], [0xFF, 46, 6, 0x02, 0x01, 1]);
///
/// let mut decoder = EventStream::decoder();
/// assert_eq!(decoder.decode(&EventStream::HEADER).count(), 0);
/// assert!(decoder.decode(&bytes[..6]).eq([event]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EventStream;

const RESET: u8 = 0xFE;
const OVERFLOW: u8 = 0xFF;
const OVERFLOW_TICKS: u32 = 254;
/// The size of the payload.
const SIZE: u8 = 3;
/// The size as it is written.
const SIZE_BYTE: u8 = SIZE << 1;
const MORE: u8 = 1;

impl EventStream {
    /// The first bytes of a file: magic, version 2.0.0, type 0.
    pub const HEADER: [u8; 16] = *b"Event Stream\x02\0\0\0";

    /// An encoder of a file that begins at tick 0. Write the [header](Self::HEADER) before the first event.
    ///
    /// For a log that begins long after boot use [`encoder_from`](Self::encoder_from).
    pub const fn encoder() -> EventStreamEncoder {
        Self::encoder_from(Tick::from_micros(0))
    }

    /// An encoder of a file that begins at this tick. The file counts time from there, and does not contain the tick
    /// itself. (From tick 0 it would begin with a byte for every 254 µs since boot.)
    pub const fn encoder_from(start: Tick) -> EventStreamEncoder {
        EventStreamEncoder { clock: Clock::starting_at(start) }
    }

    /// A decoder of a file that begins at tick 0, from its header on.
    pub const fn decoder() -> EventStreamDecoder {
        Self::decoder_from(Tick::from_micros(0))
    }

    /// A decoder of a file that begins at this tick, from its header on.
    pub const fn decoder_from(start: Tick) -> EventStreamDecoder {
        EventStreamDecoder { tick: start, state: State::Header(0), skipped: 0 }
    }
}

/// The encoder of [`EventStream`].
#[derive(Clone, Copy, Debug)]
pub struct EventStreamEncoder {
    clock: Clock,
}

impl EventFormat for EventStreamEncoder {
    const LONGEST: usize = 5;

    /// Writes an event. The time before it, a byte for every 254 µs, is written as far as it fits and is not written
    /// again when the event is offered again.
    fn encode(&mut self, event: Event, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let (mut delta, is_retimed) = self.clock.since(event.tick);
        let mut out = Cursor::new(bytes);
        while delta >= OVERFLOW_TICKS {
            // As many as 256 µs fit, without a division; then for the rest, which is a hundredth.
            let many = out.repeat(OVERFLOW, (delta >> 8).max(1) as usize);
            if many == 0 {
                return Err(FormatError::Full { written: out.written() });
            }
            let time = OVERFLOW_TICKS.wrapping_mul(many as u32);
            self.clock.advance(time, false);
            delta = delta.wrapping_sub(time);
        }
        let [low, high] = event.address.to_le_bytes();
        let up = (event.polarity == Polarity::Up).into();
        out.put(&[delta as u8, SIZE_BYTE, low, high, up])
            .ok_or(FormatError::Full { written: out.written() })?;
        self.clock.advance(delta, is_retimed);
        Ok(out.written())
    }

    fn retimed(&self) -> u32 {
        self.clock.retimed
    }
}

/// The decoder of [`EventStream`].
///
/// Events with a payload of another size are skipped, and so is a file with another header.
#[derive(Clone, Copy, Debug)]
pub struct EventStreamDecoder {
    tick: Tick,
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
    Size {
        size: u32,
        shift: u8,
    },
    Payload {
        payload: [u8; 3],
        at: u8,
    },
    Skip {
        left: u32,
    },
}

impl EventStreamDecoder {
    /// Whether the header is that of another format or type, so that no event is read.
    pub const fn is_foreign(&self) -> bool {
        matches!(self.state, State::Foreign)
    }

    fn skip(&mut self, count: u32) {
        self.skipped = self.skipped.saturating_add(count);
    }

    fn after_size(&mut self, size: u32) -> State {
        match size {
            0 => {
                self.skip(1);
                State::Time
            }
            3 => State::Payload { payload: [0; 3], at: 0 },
            left => State::Skip { left },
        }
    }
}

impl EventDecoder for EventStreamDecoder {
    fn push(&mut self, byte: u8) -> Option<Event> {
        self.state = match self.state {
            State::Header(at) => match EventStream::HEADER.get(usize::from(at)) {
                // Minor versions and patches change nothing that is read here.
                Some(&expected) if byte == expected || at == 13 || at == 14 => match at {
                    15 => State::Time,
                    _ => State::Header(at + 1),
                },
                _ => State::Foreign,
            },
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
                self.tick += u32::from(byte);
                State::Size { size: 0, shift: 0 }
            }
            State::Size { size, shift } => {
                let part = u32::from(byte >> 1);
                let shifted = part.unbounded_shl(shift.into());
                // A size that 32 bits cannot hold is longer than any stream.
                let is_held = shifted.unbounded_shr(shift.into()) == part;
                let size = if is_held { size | shifted } else { u32::MAX };
                if byte & MORE == 0 {
                    self.after_size(size)
                } else {
                    State::Size { size, shift: shift.saturating_add(7) }
                }
            }
            State::Payload { mut payload, at } => {
                if let Some(slot) = payload.get_mut(usize::from(at)) {
                    *slot = byte;
                }
                if at < SIZE - 1 {
                    State::Payload { payload, at: at + 1 }
                } else {
                    self.state = State::Time;
                    let [low, high, up] = payload;
                    return Some(Event {
                        tick: self.tick,
                        address: u16::from_le_bytes([low, high]),
                        polarity: if up == 0 { Polarity::Down } else { Polarity::Up },
                    });
                }
            }
            State::Skip { left } => {
                self.skip(1);
                if left > 1 { State::Skip { left: left - 1 } } else { State::Time }
            }
        };
        None
    }

    /// The bytes of a silence are counted, and added to the time at once.
    fn decode(&mut self, bytes: &[u8]) -> impl Iterator<Item = Event> {
        let mut rest = bytes;
        core::iter::from_fn(move || {
            loop {
                if matches!(self.state, State::Time) {
                    let silence = rest.iter().take_while(|&&byte| byte == OVERFLOW).count();
                    self.tick += OVERFLOW_TICKS.wrapping_mul(silence as u32);
                    rest = rest.get(silence..).unwrap_or_default();
                }
                let (&byte, after) = rest.split_first()?;
                rest = after;
                if let Some(event) = self.push(byte) {
                    return Some(event);
                }
            }
        })
    }

    fn skipped(&self) -> u32 {
        self.skipped
    }

    fn is_partial(&self) -> bool {
        !matches!(self.state, State::Time | State::Header(0) | State::Foreign)
    }
}
