//! Reads telemetry logs of a ground station, `.tlog`: packets of `MAVLink` 1 and 2, each preceded by its time of
//! arrival.
//!
//! Every type of common message is a topic. Messages of the same type from a second sender are on a topic of their own,
//! such as `ATTITUDE:1`. Packets of other types are skipped.

mod messages;

use crate::bytes::Bytes;
use crate::faults::Faults;
use crate::topic::Topic;
use crate::window::Window;
use crate::wire::Wire;
use crate::{Entry, Log, Result};
use messages::{Checksum, Message};
use std::collections::HashMap;
use std::path::Path;

/// Length in bytes of the time stamp before each packet: µs since 1970, big-endian.
const TIME: usize = 8;

/// Reader of a telemetry log.
pub(crate) struct Mavlink {
    window: Window,
    faults: Faults,
    topics: Vec<Topic>,
    /// Index in `topics` for each message number and sender. A sender is given by its system and its component.
    senders: HashMap<(u32, [u8; 2]), usize>,
    message: Vec<u8>,
    /// Number of packets skipped because their messages are unknown.
    unknown: u64,
    /// Offset of the first byte of the range that is being skipped as damaged.
    damaged: Option<u64>,
}

/// A packet, and the time of its arrival.
struct Packet<'a> {
    microseconds: u64,
    /// `MAVLink` ids of the system and of the component that sent the packet.
    sender: [u8; 2],
    number: u32,
    payload: &'a [u8],
    /// Bytes of the packet that the checksum covers. The checksum also covers a byte that is not in the packet,
    /// [`Message::extra`].
    checked: &'a [u8],
    checksum: u16,
    /// Total length in bytes of the time stamp, the packet and the packet's signature.
    length: usize,
}

/// Classification of the next bytes in the log.
enum Ahead<'a> {
    Packet(Packet<'a>),
    /// A packet that the end of the file cuts off.
    Cut,
    /// Bytes that are no packet.
    Odd,
}

/// Classifies the next bytes in the log, without regard to the checksum.
fn look(left: &[u8]) -> Ahead<'_> {
    let Some((time, packet)) = left.split_first_chunk::<TIME>() else { return Ahead::Cut };
    let (head, signature) = match packet {
        [0xfe, ..] => (6, 0),
        [0xfd, _, flags, ..] => (10, if flags & 1 == 1 { 13 } else { 0 }),
        [] | [0xfd] | [0xfd, _] => return Ahead::Cut,
        _ => return Ahead::Odd,
    };
    let Some(&length) = packet.get(1) else { return Ahead::Cut };
    let end = head + usize::from(length);
    let Some(whole) = packet.get(..end + 2 + signature) else { return Ahead::Cut };
    let (sender, number) = match *whole {
        [0xfe, _, _, system, component, number, ..] => ([system, component], number.into()),
        [0xfd, _, _, _, _, system, component, low, middle, high, ..] => {
            ([system, component], u32::from_le_bytes([low, middle, high, 0]))
        }
        _ => return Ahead::Odd,
    };
    Ahead::Packet(Packet {
        microseconds: u64::from_be_bytes(*time),
        sender,
        number,
        payload: &whole[head..end],
        checked: &whole[1..end],
        checksum: u16::from_le_bytes([whole[end], whole[end + 1]]),
        length: TIME + whole.len(),
    })
}

impl Packet<'_> {
    /// Returns whether the packet at the start of `left` is valid. If its message is known, the checksum must be right.
    /// If its message is unknown, the checksum cannot be calculated; instead, another packet must follow.
    fn is_good(&self, left: &[u8]) -> bool {
        match Message::of(self.number) {
            Some(message) => {
                let mut checksum = Checksum::default();
                checksum.take(self.checked);
                checksum.take(&[message.extra]);
                checksum.0 == self.checksum
            }
            None => is_followed(&left[self.length..]),
        }
    }
}

/// Returns whether `next` can be a time stamp and then a packet: the byte after the time stamp is one with which
/// packets start, or there is no such byte.
fn is_followed(next: &[u8]) -> bool {
    next.get(TIME).is_none_or(|start| matches!(start, 0xfd | 0xfe))
}

/// Returns whether these are the first bytes of a telemetry log: a packet from the years 2000 to 2100, followed by
/// another packet.
pub(crate) fn is_log(start: &[u8]) -> bool {
    const YEARS: std::ops::Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;
    match look(start) {
        Ahead::Packet(packet) => {
            YEARS.contains(&packet.microseconds)
                && (packet.is_good(start) || Message::of(packet.number).is_some())
                && is_followed(&start[packet.length..])
        }
        Ahead::Cut | Ahead::Odd => false,
    }
}

impl Mavlink {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            window: Window::new(Bytes::open(path)?),
            faults,
            topics: Vec::new(),
            senders: HashMap::new(),
            message: Vec::new(),
            unknown: 0,
            damaged: None,
        })
    }

    /// Reads the packet at the current position; returns `None` if no valid packet is there. The result is the packet's
    /// length and, if its message is known, the index of its topic and its time in ns.
    fn packet(&mut self) -> Option<(usize, Option<(usize, i64)>)> {
        let left = self.window.left();
        let Ahead::Packet(packet) = look(left) else { return None };
        if !packet.is_good(left) {
            return None;
        }
        let Some(message) = Message::of(packet.number) else { return Some((packet.length, None)) };
        self.message.clear();
        self.message.extend(packet.payload);
        // Senders leave out zeros at the end, and extensions that they do not know.
        self.message.resize(message.length.max(packet.payload.len()), 0);
        let sender = (packet.number, packet.sender);
        let before = self.senders.keys().filter(|(number, _)| *number == packet.number).count();
        let topic = *self.senders.entry(sender).or_insert_with(|| {
            let name = match before {
                0 => message.name.to_owned(),
                before => format!("{}:{before}", message.name),
            };
            let [system, component] = packet.sender;
            let kind = format!("system {system}, component {component}");
            let definition = Ok(message.definition.clone());
            self.topics.push(Topic { name, kind, wire: Wire::Ros1, definition });
            self.topics.len() - 1
        });
        let time = i64::try_from(packet.microseconds).unwrap_or(i64::MAX).saturating_mul(1000);
        Some((packet.length, Some((topic, time))))
    }
}

impl Log for Mavlink {
    fn next(&mut self) -> Result<Option<Entry>> {
        loop {
            self.window.fill(&mut self.faults)?;
            let offset = self.window.offset();
            let is_end = self.window.left().is_empty();
            let taken = if is_end { None } else { self.packet() };
            if (is_end || taken.is_some())
                && let Some(damaged) = self.damaged.take()
            {
                let what = format!("{} bytes are no packets", offset - damaged);
                self.faults.skip(damaged, what)?;
            }
            if is_end {
                if self.unknown > 0 {
                    let what = "packets of messages other than the common ones were passed over";
                    self.faults.note(format!("{} {what}", self.unknown));
                    self.unknown = 0;
                }
                return Ok(None);
            }
            match taken {
                Some((length, Some((topic, time)))) => {
                    self.window.pass(length);
                    return Ok(Some(Entry { topic, time, at: offset, sequence: None }));
                }
                Some((length, None)) => {
                    self.window.pass(length);
                    self.unknown += 1;
                }
                None if self.damaged.is_none()
                    && matches!(look(self.window.left()), Ahead::Cut) =>
                {
                    self.window.pass(usize::MAX);
                    self.faults.end(offset, "the log ends within a packet")?;
                }
                None => {
                    self.damaged.get_or_insert(offset);
                    self.window.pass(1);
                }
            }
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        &self.message
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}
