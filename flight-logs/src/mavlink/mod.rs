//! Reads telemetry logs of a ground station, `.tlog`: packets of `MAVLink` 1 and 2, each preceded by its time of
//! arrival.
//!
//! Every type of common message is a topic. Messages of the same type from a second sender are on a topic of their own,
//! such as `ATTITUDE:1`. Packets of other types are skipped, and counted by their names.

mod messages;
mod names;

use crate::bytes::Bytes;
use crate::faults::Faults;
use crate::topic::Topic;
use crate::window::Window;
use crate::wire::Wire;
use crate::{Entry, Log, Result};
use messages::{Checksum, Message};
use std::collections::{BTreeMap, HashMap};
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
    /// Number of packets skipped because the layout of their messages is unknown, by message number.
    unknown: BTreeMap<u32, u64>,
    /// Number of packets whose time stamp is 0.
    unstamped: u64,
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
            Some(_) => self.is_checked(),
            None => is_followed(&left[self.length..]),
        }
    }

    /// Returns whether the packet's message is known, and its checksum right.
    fn is_checked(&self) -> bool {
        Message::of(self.number).is_some_and(|message| {
            let mut checksum = Checksum::default();
            checksum.take(self.checked);
            checksum.take(&[message.extra]);
            checksum.0 == self.checksum
        })
    }
}

/// Returns whether `next` can be a time stamp and then a packet: the byte after the time stamp is one with which
/// packets start, or there is no such byte.
fn is_followed(next: &[u8]) -> bool {
    next.get(TIME).is_none_or(|start| matches!(start, 0xfd | 0xfe))
}

/// Returns whether these are the first bytes of a telemetry log: a packet from the years 2000 to 2100, followed by
/// another packet, or packets with other times or behind other bytes whose checksums are right.
pub(crate) fn is_log(start: &[u8]) -> bool {
    const YEARS: std::ops::Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;
    let is_dated = match look(start) {
        Ahead::Packet(packet) => {
            YEARS.contains(&packet.microseconds)
                && (packet.is_good(start) || Message::of(packet.number).is_some())
                && is_followed(&start[packet.length..])
        }
        Ahead::Cut | Ahead::Odd => false,
    };
    is_dated || (0..start.len()).any(|at| are_checked(&start[at..]))
}

/// Returns whether the bytes begin with two packets of known messages whose checksums are right. One in 2^32 places of
/// other files does so by chance.
fn are_checked(mut bytes: &[u8]) -> bool {
    const ENOUGH: usize = 2;
    for _ in 0..ENOUGH {
        match look(bytes) {
            Ahead::Packet(packet) if packet.is_checked() => bytes = &bytes[packet.length..],
            _ => return false,
        }
    }
    true
}

impl Mavlink {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            window: Window::new(Bytes::open(path)?),
            faults,
            topics: Vec::new(),
            senders: HashMap::new(),
            message: Vec::new(),
            unknown: BTreeMap::new(),
            unstamped: 0,
            damaged: None,
        })
    }

    /// Notes the packets that are not read, by their names, and those without a time.
    fn note_skipped(&mut self) {
        let unknown = std::mem::take(&mut self.unknown);
        let count: u64 = unknown.values().sum();
        if count > 0 {
            let mut kinds: Vec<(u32, u64)> = unknown.into_iter().collect();
            kinds.sort_by_key(|&(number, count)| (std::cmp::Reverse(count), number));
            let names = kinds.iter().map(|&(number, count)| match names::name(number) {
                Some(name) => format!("{count} {name}"),
                None => format!("{count} of number {number}"),
            });
            let names = names.collect::<Vec<_>>().join(", ");
            let what = "packets of messages whose layout is not known were passed over";
            self.faults.note(format!("{count} {what}: {names}"));
        }
        let unstamped = std::mem::take(&mut self.unstamped);
        if unstamped > 0 {
            self.faults.note(format!("{unstamped} packets have the time of arrival 0"));
        }
    }

    /// Reads the packet at the current position; returns `None` if no valid packet is there. The result is the packet's
    /// length and, if its message is known, the index of its topic and its time in ns.
    fn packet(&mut self) -> Option<(usize, Option<(usize, i64)>)> {
        let left = self.window.left();
        let Ahead::Packet(packet) = look(left) else { return None };
        if !packet.is_good(left) {
            return None;
        }
        self.unstamped += u64::from(packet.microseconds == 0);
        let Some(message) = Message::of(packet.number) else {
            *self.unknown.entry(packet.number).or_default() += 1;
            return Some((packet.length, None));
        };
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
            // The stamp of the next packet may begin with zeros.
            if self.window.pass_blank(TIME) {
                continue;
            }
            let is_end = self.window.left().is_empty();
            if let Some(blank) = self.window.end_blank() {
                if is_end {
                    self.faults.blank(blank, offset - blank);
                } else {
                    self.damaged.get_or_insert(blank);
                }
            }
            let taken = if is_end { None } else { self.packet() };
            if (is_end || taken.is_some())
                && let Some(damaged) = self.damaged.take()
            {
                let what = format!("{} bytes are no packets", offset - damaged);
                self.faults.skip(damaged, what)?;
            }
            if is_end {
                self.note_skipped();
                return Ok(None);
            }
            match taken {
                Some((length, Some((topic, time)))) => {
                    self.window.pass(length);
                    return Ok(Some(Entry { topic, time, at: offset, sequence: None }));
                }
                Some((length, None)) => self.window.pass(length),
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
