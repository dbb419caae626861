//! EIEIO, the datagrams of `SpiNNaker` boards. Reads and writes recordings, which consist of the payloads of the
//! datagrams, one after the other.

use super::omitted::Omitted;
use super::{EventReader, EventWriter, EventsKind, Item, Tally};
use crate::Result;
use spikewire::{Event, Polarity, Tick};
use spikewire_cameras::format::eieio;
use std::io::Write;
use std::num::NonZeroU32;

/// Mapping of a `SpiNNaker` board's keys and time stamps to addresses and ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Key that stands for address 0. EIEIO gives the source of an event as a number, the key.
    pub base: u32,
    /// Length of a time step, in µs.
    pub step: NonZeroU32,
    /// Whether an address has two keys, the first for polarity down and the second for up.
    pub is_signed: bool,
}

impl Board {
    /// Returns the key of an event: the number that stands for its address and polarity. Returns `None` if the key
    /// would exceed 32 bits. Also returns `None` for an event of polarity down if keys have no polarity.
    fn key(self, event: Event) -> Option<u32> {
        let address = u32::from(event.address);
        match (self.is_signed, event.polarity) {
            (false, Polarity::Down) => None,
            (false, Polarity::Up) => self.base.checked_add(address),
            (true, polarity) => {
                self.base.checked_add(2 * address + u32::from(polarity == Polarity::Up))
            }
        }
    }

    /// Returns the event that `key` stands for at `tick`, or `None` if the board's mapping does not use the key.
    fn event(self, key: u32, tick: Tick) -> Option<Event> {
        let key = key.checked_sub(self.base)?;
        let (address, polarity) = match (self.is_signed, key & 1) {
            (false, _) => (key, Polarity::Up),
            (true, 0) => (key >> 1, Polarity::Down),
            (true, _) => (key >> 1, Polarity::Up),
        };
        Some(Event { tick, address: address.try_into().ok()?, polarity })
    }
}

const MAX_KEYS: usize = 255;
/// Length of the longest datagram, in bytes.
const LONGEST: usize = 2 + 4 + 4 * MAX_KEYS;

/// A reader of EIEIO datagrams, the packets of events that `SpiNNaker` boards exchange.
pub(super) struct Reader {
    board: Board,
    waiting: Vec<u8>,
    time: Tick,
    skipped: u64,
}

impl Reader {
    pub(super) fn new(board: Board) -> Self {
        Self { board, waiting: Vec::new(), time: Tick::from_micros(0), skipped: 0 }
    }

    /// Reads the complete datagrams at the front of the buffer. Skips bytes at which no datagram can begin. If `is_end`
    /// is true, also skips an incomplete datagram at the end of the recording.
    fn datagrams(&mut self, is_end: bool, items: &mut Vec<Item>) {
        let Self { board, waiting, time, skipped } = self;
        let mut bytes = waiting.as_slice();
        while !bytes.is_empty() {
            if let Some(datagram) = eieio::decode(bytes) {
                if let Some(stamp) = datagram.timestamp {
                    *time = stamp.wrapping_mul(board.step.get()).into();
                }
                for key in datagram.keys() {
                    match board.event(key, *time) {
                        Some(event) => items.push(Item::Event(event)),
                        None => *skipped += 4,
                    }
                }
                let stamp = if datagram.timestamp.is_some() { 4 } else { 0 };
                bytes = &bytes[2 + stamp + 4 * datagram.keys().count()..];
            } else if is_end || bytes.len() >= LONGEST || !begins(bytes) {
                *skipped += 1;
                bytes = &bytes[1..];
            } else {
                break;
            }
        }
        let rest = bytes.len();
        waiting.drain(..waiting.len() - rest);
    }
}

/// Returns whether `bytes` could be the beginning of an EIEIO datagram that the decoder [`eieio`] supports.
fn begins(bytes: &[u8]) -> bool {
    let padded: Vec<u8> = bytes.iter().copied().chain([0; LONGEST]).collect();
    bytes.len() < 2 || eieio::decode(&padded).is_some()
}

impl EventReader for Reader {
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        self.waiting.extend(bytes);
        self.datagrams(false, items);
        Ok(())
    }

    fn finish(&mut self, items: &mut Vec<Item>) -> Result<()> {
        self.datagrams(true, items);
        Ok(())
    }

    fn tally(&self) -> Tally {
        Tally { skipped: self.skipped, ..Tally::default() }
    }
}

/// Writes a datagram for each time step. A step with more than [`MAX_KEYS`] events gets several datagrams.
pub(super) struct Writer {
    board: Board,
    drops: bool,
    stamp: u32,
    keys: Vec<u32>,
    events: u64,
    omitted: Omitted,
}

impl Writer {
    pub(super) fn new(board: Board, drops: bool) -> Self {
        Self { board, drops, stamp: 0, keys: Vec::new(), events: 0, omitted: Omitted::default() }
    }

    fn datagram(&mut self, output: &mut dyn Write) -> Result<()> {
        if self.keys.is_empty() {
            return Ok(());
        }
        let mut buffer = [0; LONGEST];
        let length = eieio::encode(Some(self.stamp), self.keys.drain(..), &mut buffer)?;
        Ok(output.write_all(&buffer[..length])?)
    }

    fn event(&mut self, event: Event, output: &mut dyn Write) -> Result<()> {
        let Some(key) = self.board.key(event) else {
            if self.drops {
                self.omitted.drop_event();
                return Ok(());
            }
            let (address, event) = (event.address, self.events);
            return Err(EventsKind::NoDirection { event, address }.into());
        };
        let stamp = event.tick.micros() / self.board.step;
        if stamp != self.stamp || self.keys.len() == MAX_KEYS {
            self.datagram(output)?;
        }
        self.stamp = stamp;
        self.keys.push(key);
        self.events += 1;
        self.omitted.observe_time((stamp * self.board.step.get()).into(), event.tick);
        Ok(())
    }
}

impl EventWriter for Writer {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()> {
        match *item {
            Item::Event(event) => self.event(event, output)?,
            other => self.omitted.leave_out(other, self.drops)?,
        }
        Ok(())
    }

    fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        self.datagram(output)
    }

    fn notes(&self) -> Vec<String> {
        self.omitted.notes("key")
    }
}
