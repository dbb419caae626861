//! eDVS and mini-eDVS: the serial protocol of the drone-sized event cameras.

use super::{Clock, EventDecoder, EventFormat, FormatError};
use crate::bytes::Cursor;
use spikewire::Polarity;
use spikewire::{Event, Tick};

/// How the camera sends time: `!E0` to `!E4`. Older firmware numbers them one lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EdvsTime {
    /// E0: none.
    None,
    /// E1: µs since the event before, in one to four groups of 7 bits; cut to 2²⁸-1 µs.
    Delta,
    /// E2: the low 16 bits of the tick; right while less than 65 ms pass between events.
    Bits16,
    /// E3: the low 24 bits of the tick; right while less than 16.7 s pass between events.
    Bits24,
    /// E4: the tick.
    Bits32,
}

/// The eDVS protocol: `1yyyyyyy pxxxxxxx`, then time, most significant byte first.
///
/// - **Address:** `y << 7 | x`, 0 to 16 383.
/// - **Polarity:** readers disagree; `p = 1` is [`Polarity::Up`] by default, or
///   [down](Self::with_up_as_zero).
/// - **Length:** 2 bytes, and 1 to 4 of time.
/// - **Resynchronisation:** the first byte of an event has bit 7 set; bytes before it are skipped. Later bytes may
///   have it set, too: after a lost byte, or a start in the middle of the stream, a few events are wrong. If all
///   events have `p = 1`, as those of rate and population codes, they may stay wrong, with no byte skipped: send
///   those [with up as zero](Self::with_up_as_zero). Then E0, and E1 while less than 2 s pass between events, are
///   right again after at most three events; E2 to E4, whose time bytes have any value, may take longer.
///
/// Source: eDVS user guide; libcaer, `edvs.c`.
///
/// ```
/// use spikewire::{Event, Polarity, Tick};
/// use spikewire_cameras::format::{Edvs, EdvsTime, EventDecoder, EventFormat};
///
/// const CAMERA: Edvs = Edvs::new(EdvsTime::Delta);
/// let event = Event { tick: Tick::from_micros(0x80), address: 3 << 7 | 5, polarity: Polarity::Up };
///
/// let mut bytes = [0; 6];
/// assert_eq!(CAMERA.encoder().encode(event, &mut bytes), Ok(4));
/// assert_eq!(bytes[..4], [0x83, 0x85, 0x01, 0x80]);
/// assert!(CAMERA.decoder().decode(&bytes[..4]).eq([event]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Edvs {
    time: EdvsTime,
    up_is_zero: bool,
}

const MAX_ADDRESS: u16 = (1 << 14) - 1;
const FIRST: u8 = 0x80;
const UP: u8 = 0x80;
const LAST_GROUP: u8 = 0x80;
const MAX_DELTA: u32 = (1 << 28) - 1;

impl Edvs {
    /// The protocol with this form of time, in which `p = 1` is up.
    pub const fn new(time: EdvsTime) -> Self {
        Self { time, up_is_zero: false }
    }

    /// Makes `p = 0` up and `p = 1` down.
    #[must_use]
    pub const fn with_up_as_zero(self) -> Self {
        Self { up_is_zero: true, ..self }
    }

    /// An encoder whose first delta counts from tick 0.
    pub const fn encoder(self) -> EdvsEncoder {
        self.encoder_from(Tick::from_micros(0))
    }

    /// An encoder that starts at this tick: the first delta of E1 counts from it, and the first short time of E2 and E3
    /// is taken to lie after it.
    pub const fn encoder_from(self, start: Tick) -> EdvsEncoder {
        EdvsEncoder { protocol: self, clock: Clock::starting_at(start) }
    }

    /// A decoder that starts at tick 0, or at [another](EdvsDecoder::set_tick).
    pub const fn decoder(self) -> EdvsDecoder {
        EdvsDecoder { protocol: self, tick: Tick::from_micros(0), state: State::First, skipped: 0 }
    }

    fn polarity(self, byte: u8) -> Polarity {
        if (byte & UP != 0) == self.up_is_zero { Polarity::Down } else { Polarity::Up }
    }
}

/// The encoder of [`Edvs`].
#[derive(Clone, Copy, Debug)]
pub struct EdvsEncoder {
    protocol: Edvs,
    clock: Clock,
}

impl EventFormat for EdvsEncoder {
    const LONGEST: usize = 6;

    fn encode(&mut self, event: Event, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let Event { tick, address, polarity } = event;
        if address > MAX_ADDRESS {
            return Err(FormatError::Address { address, max: MAX_ADDRESS });
        }
        let up = if (polarity == Polarity::Up) == self.protocol.up_is_zero { 0 } else { UP };
        let ahead = tick.since(self.clock.tick).cast_unsigned();
        let micros = tick.micros();
        let delta = match self.protocol.time {
            EdvsTime::None | EdvsTime::Bits32 => ahead,
            EdvsTime::Delta => self.clock.since(tick).0.min(MAX_DELTA),
            EdvsTime::Bits16 => ahead & 0xFFFF,
            EdvsTime::Bits24 => ahead & 0xFF_FFFF,
        };

        let mut out = Cursor::new(bytes);
        out.put(&[FIRST | (address >> 7) as u8, up | (address & 0x7F) as u8])
            .and_then(|()| match self.protocol.time {
                EdvsTime::None => Some(()),
                EdvsTime::Delta => put_delta(&mut out, delta),
                EdvsTime::Bits16 => out.put(&(micros as u16).to_be_bytes()),
                EdvsTime::Bits24 => {
                    let [_, high, middle, low] = micros.to_be_bytes();
                    out.put(&[high, middle, low])
                }
                EdvsTime::Bits32 => out.put(&micros.to_be_bytes()),
            })
            .ok_or(FormatError::Full { written: 0 })?;
        self.clock.advance(delta, delta != ahead);
        Ok(out.written())
    }

    fn retimed(&self) -> u32 {
        self.clock.retimed
    }
}

/// Appends a delta in groups of 7 bits. Like the camera, it takes one group more for the largest number of a length.
fn put_delta(out: &mut Cursor<'_>, delta: u32) -> Option<()> {
    let group = |shift: u32| (delta >> shift) as u8 & 0x7F;
    let last = group(0) | LAST_GROUP;
    match delta {
        0..=0x7E => out.put(&[last]),
        0x7F..=0x3FFE => out.put(&[group(7), last]),
        0x3FFF..=0x1F_FFFE => out.put(&[group(14), group(7), last]),
        _ => out.put(&[group(21), group(14), group(7), last]),
    }
}

/// The decoder of [`Edvs`].
#[derive(Clone, Copy, Debug)]
pub struct EdvsDecoder {
    protocol: Edvs,
    tick: Tick,
    state: State,
    skipped: u32,
}

#[derive(Clone, Copy, Debug)]
enum State {
    First,
    Second { y: u8 },
    Time { y: u8, second: u8, time: u32, bytes: u8 },
}

impl EdvsDecoder {
    /// Sets the time of the event before the next one. E0 gives this time to all events, E1 adds its delta to it, and
    /// E2 and E3 take the first time after it that has the bits received.
    pub fn set_tick(&mut self, tick: Tick) {
        self.tick = tick;
    }

    fn event(&mut self, y: u8, second: u8) -> Event {
        self.state = State::First;
        Event {
            tick: self.tick,
            address: u16::from(y & 0x7F) << 7 | u16::from(second & 0x7F),
            polarity: self.protocol.polarity(second),
        }
    }

    /// The tick of the event from its time, once all `bytes` of it are here.
    fn tick(&self, time: u32, bytes: u8, last: u8) -> Option<Tick> {
        let bits = match self.protocol.time {
            EdvsTime::Delta => {
                return (last & LAST_GROUP != 0).then_some(self.tick + time);
            }
            EdvsTime::None | EdvsTime::Bits32 => return (bytes == 4).then_some(time.into()),
            EdvsTime::Bits16 => 16,
            EdvsTime::Bits24 => 24,
        };
        let ahead = time.wrapping_sub(self.tick.micros()) & ((1 << bits) - 1);
        (u32::from(bytes) * 8 == bits).then_some(self.tick + ahead)
    }
}

impl EventDecoder for EdvsDecoder {
    fn push(&mut self, byte: u8) -> Option<Event> {
        match self.state {
            State::First if byte & FIRST == 0 => {
                self.skipped = self.skipped.saturating_add(1);
                None
            }
            State::First => {
                self.state = State::Second { y: byte };
                None
            }
            State::Second { y } if self.protocol.time == EdvsTime::None => {
                Some(self.event(y, byte))
            }
            State::Second { y } => {
                self.state = State::Time { y, second: byte, time: 0, bytes: 0 };
                None
            }
            State::Time { y, second, time, bytes } => {
                let bytes = bytes.wrapping_add(1);
                let time = match self.protocol.time {
                    EdvsTime::Delta => time << 7 | u32::from(byte & 0x7F),
                    _ => time << 8 | u32::from(byte),
                };
                if let Some(tick) = self.tick(time, bytes, byte) {
                    self.tick = tick;
                    return Some(self.event(y, second));
                }
                if bytes == 4 {
                    // A delta of more than four groups, which no camera sends.
                    self.skipped = self.skipped.saturating_add(6);
                    self.state = State::First;
                } else {
                    self.state = State::Time { y, second, time, bytes };
                }
                None
            }
        }
    }

    fn skipped(&self) -> u32 {
        self.skipped
    }

    fn is_partial(&self) -> bool {
        !matches!(self.state, State::First)
    }
}
