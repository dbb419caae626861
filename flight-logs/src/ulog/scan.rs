//! Finds the messages in a `ULog` file, and determines which of them can be read.

use super::super::definition::{Definition, Path, declared};
use super::super::topic::Topic;
use super::super::wire::{self, Wire};
use std::collections::HashMap;
use std::fmt;
use std::ops::Range;

/// Length of the file header, in bytes.
pub(crate) const HEADER: usize = 16;
/// Number of bytes before the content of a data message: length, kind and topic id.
pub(crate) const DATA: usize = 5;

/// Faults and dropouts found in a log.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    unregistered: Found,
    formats: Found,
    lengths: Found,
    damaged: Found,
    dropouts: Dropouts,
    /// Offset in the file of the message that the end of the file cuts off, if there is one.
    pub(crate) cut: Option<usize>,
    /// Offset in the file from which all bytes are 0, or all 0xff, if there are such bytes at its end.
    pub(crate) blank: Option<usize>,
    /// Range of the first damage: from its first byte to the next valid message.
    pub(crate) damage: Option<Range<usize>>,
}

/// Number of messages that were skipped for one reason, and the offset of the first of these messages.
#[derive(Debug, Default)]
struct Found {
    count: u64,
    first: usize,
}

/// Statistics of the log's dropouts: periods in which the logger could not write. Durations are in ms.
#[derive(Debug, Default)]
struct Dropouts {
    count: u64,
    milliseconds: u64,
    longest: u64,
}

impl Found {
    fn at(&mut self, offset: usize) {
        if self.count == 0 {
            self.first = offset;
        }
        self.count += 1;
    }
}

/// Writes one line for each kind of fault that was found.
impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Dropouts { count, milliseconds, longest } = self.dropouts;
        if count > 0 {
            writeln!(
                f,
                "{count} dropouts of the logger, {milliseconds} ms in all, {longest} ms the longest"
            )?;
        }
        for (found, what) in [
            (&self.unregistered, "messages with an id that is not registered"),
            (&self.formats, "definitions that cannot be read"),
            (&self.lengths, "messages longer or shorter than their format"),
            (&self.damaged, "damaged stretches"),
        ] {
            let Found { count, first } = found;
            if *count > 0 {
                writeln!(f, "{count} {what} were skipped, the first at byte {first}")?;
            }
        }
        Ok(())
    }
}

/// A message in the file: its offset, its kind, and the range of its content.
struct Message {
    at: usize,
    kind: u8,
    content: Range<usize>,
}

/// State of a pass over a log, and its results.
pub(crate) struct Scan<'a> {
    bytes: &'a [u8],
    /// Format definitions by name, with a line for each field.
    formats: HashMap<String, String>,
    /// Index in `topics` for each topic id that the log has registered. A later registration of an id replaces the
    /// earlier one.
    registered: HashMap<u16, usize>,
    /// Topics in the order in which they were registered.
    pub topics: Vec<Topic>,
    /// Layouts of messages, one for each topic, in the order of `topics`.
    pub series: Vec<Series>,
    /// Valid data messages, in the order of the file: index of the topic, and offset in the file.
    pub messages: Vec<(usize, usize)>,
    pub findings: Findings,
}

/// Layout of a topic's data messages.
pub(crate) struct Series {
    /// Path to the field with the time at which a message was logged.
    pub time: Path,
    /// Two lengths of a message in bytes: without the padding at its end, and with the padding. The logger usually
    /// leaves the padding out.
    pub lengths: (usize, usize),
}

impl<'a> Scan<'a> {
    /// Finds all messages in a log. `bytes` must be at least as long as the file header.
    pub(crate) fn run(bytes: &'a [u8]) -> Self {
        let mut scan = Self {
            bytes,
            formats: HashMap::new(),
            registered: HashMap::new(),
            topics: Vec::new(),
            series: Vec::new(),
            messages: Vec::new(),
            findings: Findings::default(),
        };
        let appended = scan.appended();
        let before = appended.unwrap_or(bytes.len());
        scan.part(HEADER..before, appended.is_some());
        if let Some(start) = appended {
            scan.part(start..bytes.len(), false);
        }
        scan
    }

    /// Returns whether the log sets a flag that forbids to read it: one that says how the log differs from the format as
    /// it is known here. Of those flags only that of appended data is known.
    pub(crate) fn is_incompatible(bytes: &[u8]) -> bool {
        let Some(&[low, high, b'B']) = bytes.get(HEADER..HEADER + 3) else { return false };
        let length = usize::from(u16::from_le_bytes([low, high]));
        let content = bytes.get(HEADER + 3..).unwrap_or_default();
        let content = content.get(..length).unwrap_or(content);
        let flags = content.get(8..16).unwrap_or_default();
        (0..)
            .zip(flags)
            .any(|(place, flags)| if place == 0 { flags & !1 != 0 } else { *flags != 0 })
    }

    /// Returns the offset at which PX4 appended data to the finished log, as it does after a crash. Returns `None` if
    /// nothing was appended.
    fn appended(&self) -> Option<usize> {
        let first = self.header(HEADER, self.bytes.len()).filter(|first| first.kind == b'B')?;
        let content = &self.bytes[first.content];
        let is_appended = content.get(8)? & 1 == 1;
        let offset = u64::from_le_bytes(content.get(16..24)?.try_into().ok()?);
        let offset = usize::try_from(offset).ok()?;
        (is_appended && (HEADER..self.bytes.len()).contains(&offset)).then_some(offset)
    }

    fn part(&mut self, part: Range<usize>, may_be_cut: bool) {
        let mut at = part.start;
        while at < part.end {
            if let Some(message) = self.accepted(at, part.end) {
                at = message.content.end;
                self.take(&message);
                continue;
            }
            if let Some(next) = (at + 1..part.end).find(|&next| self.goes_on(next, part.end)) {
                self.findings.damaged.at(at);
                self.findings.damage.get_or_insert(at..next);
                at = next;
            } else {
                let rest = &self.bytes[at..part.end];
                if [0, 0xff].iter().any(|blank| rest.iter().all(|byte| byte == blank)) {
                    self.findings.blank = Some(at);
                } else if !may_be_cut {
                    self.findings.cut = Some(at);
                }
                return;
            }
        }
    }

    fn header(&self, at: usize, end: usize) -> Option<Message> {
        let &[low, high, kind] = self.bytes.get(at..at + 3)? else { return None };
        let length = usize::from(u16::from_le_bytes([low, high]));
        let content = at + 3..at + 3 + length;
        (content.end <= end).then_some(Message { at, kind, content })
    }

    /// Returns the message at offset `at`, if the message is valid or can be skipped. An invalid message can be skipped
    /// if another message or the end of the log follows it.
    fn accepted(&self, at: usize, end: usize) -> Option<Message> {
        let message = self.header(at, end)?;
        if self.is_good(&message) {
            return Some(message);
        }
        let next = message.content.end;
        let is_led = next == end || self.header(next, end).is_some_and(|next| is_known(&next));
        let is_one = message.kind != 0 && !message.content.is_empty();
        (is_one && is_led).then_some(message)
    }

    /// Returns whether three valid messages follow each other, the first at offset `at`.
    fn goes_on(&self, at: usize, end: usize) -> bool {
        const ENOUGH: usize = 3;
        let mut next = at;
        for _ in 0..ENOUGH {
            match self.header(next, end).filter(|message| self.is_good(message)) {
                Some(message) => next = message.content.end,
                None => return false,
            }
        }
        true
    }

    fn is_good(&self, message: &Message) -> bool {
        let fits = || {
            let (id, length) = self.data_of(message)?;
            let (short, long) = self.series.get(*self.registered.get(&id)?)?.lengths;
            (length == short || length == long).then_some(())
        };
        is_known(message) && (message.kind != b'D' || fits().is_some())
    }

    /// Returns the topic id of a data message, and the number of bytes after the id; `None` if the message is too short
    /// for an id.
    fn data_of(&self, message: &Message) -> Option<(u16, usize)> {
        let id = self.bytes[message.content.clone()].first_chunk()?;
        Some((u16::from_le_bytes(*id), message.content.len() - 2))
    }

    fn take(&mut self, message: &Message) {
        let content = &self.bytes[message.content.clone()];
        match message.kind {
            b'F' => self.define(message.at, content),
            b'A' => self.register(message.at, content),
            b'D' => {
                let id = self.data_of(message).map(|(id, _)| id);
                match id.map(|id| self.registered.get(&id)) {
                    Some(None) => self.findings.unregistered.at(message.at),
                    Some(Some(&series)) if self.is_good(message) => {
                        self.messages.push((series, message.at));
                    }
                    _ => self.findings.lengths.at(message.at),
                }
            }
            b'O' => {
                if let Some(&milliseconds) = content.first_chunk() {
                    let milliseconds = u64::from(u16::from_le_bytes(milliseconds));
                    let dropouts = &mut self.findings.dropouts;
                    dropouts.count += 1;
                    dropouts.milliseconds += milliseconds;
                    dropouts.longest = dropouts.longest.max(milliseconds);
                }
            }
            // Parameters, logged text and other kinds of messages are ignored.
            _ => {}
        }
    }

    /// Stores a format definition, `name:type field;type[8] field;`. An invalid definition is counted as a fault.
    fn define(&mut self, at: usize, content: &[u8]) {
        let defined = str::from_utf8(content).ok().and_then(|text| text.split_once(':'));
        let fields = |fields: &str| fields.replace(';', "\n");
        let defined = defined.map(|(name, text)| (name.to_owned(), fields(text)));
        let are_fields = |fields: &str| {
            fields.lines().all(|field| field.trim().is_empty() || declared(field).is_some())
        };
        match defined.filter(|(_, fields)| are_fields(fields)) {
            Some((name, fields)) => drop(self.formats.insert(name, fields)),
            None => self.findings.formats.at(at),
        }
    }

    fn register(&mut self, at: usize, content: &[u8]) {
        /// A message of zeros. Decoding this message by a definition gives the length of messages with this definition.
        /// No message is longer than 65 535 bytes.
        const NOTHING: &[u8] = &[0; 1 << 16];
        let registered = || {
            let (&[instance, low, high], name) = content.split_first_chunk()?;
            let name = str::from_utf8(name).ok()?;
            let definition = Definition::of_px4(name, &self.formats).ok()?;
            let length = wire::length(Wire::Ros1, &definition, NOTHING).ok()?;
            let series = Series {
                time: definition.time()?,
                lengths: (length - definition.padding(), length),
            };
            let name = match instance {
                0 => name.to_owned(),
                instance => format!("{name}:{instance}"),
            };
            let topic =
                Topic { name, kind: String::new(), wire: Wire::Ros1, definition: Ok(definition) };
            Some((u16::from_le_bytes([low, high]), topic, series))
        };
        let Some((id, topic, series)) = registered() else {
            self.findings.formats.at(at);
            return;
        };
        let index = topic.index_in(&mut self.topics);
        if index == self.series.len() {
            self.series.push(series);
        }
        self.registered.insert(id, index);
    }
}

/// Returns whether `ULog` defines the kind of a message, and allows the message's length for this kind.
fn is_known(message: &Message) -> bool {
    let length = message.content.len();
    match message.kind {
        b'B' => length >= 40,
        b'F' => length >= 3,
        b'A' => length >= 4,
        b'R' | b'O' => length == 2,
        b'D' => length > 2,
        b'S' => length == 8,
        b'L' => length >= 9,
        b'C' => length >= 11,
        b'I' | b'M' | b'P' | b'Q' => length >= 2,
        _ => false,
    }
}
