//! Tables of events as CSV, with the columns `tick,address,polarity`. Comment lines hold all other items, such as
//! keyframes.

use super::{EventReader, EventWriter, EventsKind, Item, Known, Tally};
use crate::error::At;
use crate::{Place, Result};
use catalogue::run::SampleType;
use spikewire::{Event, Keyframe, Polarity, SampleKind, Tick};
use std::io::Write;

pub(super) const HEADER: &str = "tick,address,polarity";
const VALUES: &str = "tick,address,value,known";

/// A reader of event tables in CSV. Also reads a file of spikes, if the file gives times.
pub(super) struct Reader {
    file: String,
    /// The bytes of the unfinished line.
    line: Vec<u8>,
    /// Number of finished lines.
    number: u64,
    columns: Option<Columns>,
    events: u64,
    /// Number of ticks that did not fit in 32 bits.
    long_ticks: u64,
    is_file_of_spikes: bool,
    /// Number of events that a file of spikes declares in its last line.
    declared_events: Option<u64>,
}

/// Indices of the columns in a line.
#[derive(Clone, Copy)]
struct Columns {
    tick: usize,
    address: usize,
    polarity: usize,
}

impl Reader {
    pub(super) fn new(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            line: Vec::new(),
            number: 0,
            columns: None,
            events: 0,
            long_ticks: 0,
            is_file_of_spikes: false,
            declared_events: None,
        }
    }

    /// Reads a comment, given without its `#`. Remembers what the comment says about the file, and returns the item in
    /// the comment, or `None` if the comment holds no item.
    fn note(&mut self, note: &str) -> Result<Option<Item>> {
        match note.split_once('=') {
            Some(("spikewire", _)) => self.is_file_of_spikes = true,
            Some(("events", count)) if self.is_file_of_spikes => {
                let no_count = |_| EventsKind::NotACount { text: count.to_owned() };
                self.declared_events = Some(count.parse().map_err(no_count)?);
            }
            _ => {}
        }
        note_item(note)
    }

    fn end_line(&mut self, items: &mut Vec<Item>) -> Result<()> {
        self.number += 1;
        let line = std::mem::take(&mut self.line);
        let text = String::from_utf8_lossy(&line);
        let text = text.trim();
        let item = if let Some(note) = text.strip_prefix('#') {
            self.note(note.trim())
        } else if let Some(columns) = self.columns {
            if text.is_empty() {
                Ok(None)
            } else {
                event_item(text, columns, &mut self.long_ticks).map(Some)
            }
        } else {
            header(text).map(|columns| {
                self.columns = Some(columns);
                None
            })
        };
        let item = item.at(|| Place::line(&self.file, self.number))?;
        self.events += u64::from(matches!(item, Some(Item::Event(_))));
        items.extend(item);
        Ok(())
    }
}

impl EventReader for Reader {
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        const LONGEST: usize = 4096;
        for piece in bytes.split_inclusive(|&byte| byte == b'\n') {
            self.line.extend(piece);
            if self.line.len() > LONGEST {
                let place = Place::line(&self.file, self.number + 1);
                return Err(EventsKind::LongLine { most: LONGEST }.at(place));
            }
            if piece.ends_with(b"\n") {
                self.end_line(items)?;
            }
        }
        Ok(())
    }

    fn finish(&mut self, items: &mut Vec<Item>) -> Result<()> {
        if !self.line.is_empty() {
            self.end_line(items)?;
        }
        if self.columns.is_none() {
            return Err(EventsKind::Empty.at(&self.file));
        }
        match self.declared_events {
            None if self.is_file_of_spikes => Err(EventsKind::NoEnd.at(&self.file)),
            Some(said) if said != self.events => {
                Err(EventsKind::OtherCount { events: self.events, said }.at(&self.file))
            }
            _ => Ok(()),
        }
    }

    fn tally(&self) -> Tally {
        Tally { long_ticks: self.long_ticks, ..Tally::default() }
    }
}

fn header(text: &str) -> Result<Columns> {
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    let find = |wanted: &[&str]| names.iter().position(|name| wanted.contains(name));
    match (find(&["tick", "time_us"]), find(&["address"]), find(&["polarity"])) {
        (Some(tick), Some(address), Some(polarity)) => Ok(Columns { tick, address, polarity }),
        _ => Err(EventsKind::NoHeader { text: text.to_owned() }.into()),
    }
}

fn event_item(text: &str, columns: Columns, long_ticks: &mut u64) -> Result<Item> {
    let field = |column: usize| text.split(',').nth(column).map_or("", str::trim);
    let (tick, address) = (field(columns.tick), field(columns.address));
    let micros: u64 = tick.parse().map_err(|_| EventsKind::Tick { text: tick.to_owned() })?;
    let tick = Tick::from_micros(micros);
    *long_ticks += u64::from(u64::from(tick.micros()) != micros);
    let address = address.parse().map_err(|_| EventsKind::Address { text: address.to_owned() })?;
    let polarity = match field(columns.polarity) {
        "1" => Polarity::Up,
        "-1" => Polarity::Down,
        other => return Err(EventsKind::Polarity { text: other.to_owned() }.into()),
    };
    Ok(Item::Event(Event { tick, address, polarity }))
}

/// Parses a comment that holds an item: a keyframe, a heartbeat, a loss or a restart. Returns `None` for any other
/// comment. `note` is the comment without its `#`.
fn note_item(note: &str) -> Result<Option<Item>> {
    let (key, value) = note.split_once('=').unwrap_or((note, ""));
    let text = || value.to_owned();
    Ok(match key {
        "lost_frames" => {
            Some(Item::LostFrames(value.parse().map_err(|_| EventsKind::Frames { text: text() })?))
        }
        "heartbeat" => {
            Some(heartbeat(value).ok_or_else(|| EventsKind::Heartbeat { text: text() })?)
        }
        "lost_events" => Some(Item::LostEvents),
        "restart" => Some(Item::Restart),
        "keyframe" => Some(keyframe(value).ok_or_else(|| EventsKind::Keyframe { text: text() })?),
        _ => None,
    })
}

fn keyframe(value: &str) -> Option<Item> {
    let mut fields = value.split(',');
    let (tick, address, bits) = (fields.next()?, fields.next()?, fields.next()?);
    let kind = kind(fields.next()?)?;
    if fields.next().is_some() || bits.len() != 2 * kind.size() {
        return None;
    }
    let tick = Tick::from(tick.parse::<u32>().ok()?);
    let (address, bits) = (address.parse().ok()?, u32::from_str_radix(bits, 16).ok()?);
    Some(Item::Keyframe(Keyframe { tick, address, kind, bits }))
}

fn heartbeat(value: &str) -> Option<Item> {
    let (tick, address) = value.split_once(',')?;
    Some(Item::Heartbeat(Tick::from(tick.parse::<u32>().ok()?), address.parse().ok()?))
}

/// Parses the name of a sample type, such as `f32`, `i16` or `q8.8`.
fn kind(name: &str) -> Option<SampleKind> {
    let kind = |byte| SampleKind::from_byte(byte).filter(|kind| name_of(*kind) == name);
    (0..=u8::MAX).find_map(kind)
}

fn name_of(kind: SampleKind) -> String {
    match kind {
        SampleKind::F32 => SampleType::F32.to_string(),
        SampleKind::Fixed16 { fraction } => SampleType::Fixed16 { fraction }.to_string(),
        SampleKind::Fixed32 { fraction } => SampleType::Fixed32 { fraction }.to_string(),
    }
}

/// A writer of a table of events. If `values` holds a sample type, the table holds decoded values of that type instead.
pub(super) struct Writer {
    values: Option<SampleType>,
    has_begun: bool,
    line: Vec<u8>,
}

impl Writer {
    pub(super) fn new(values: Option<SampleType>) -> Self {
        Self { values, has_begun: false, line: Vec::new() }
    }

    fn begin(&mut self, output: &mut dyn Write) -> Result<()> {
        if !std::mem::replace(&mut self.has_begun, true) {
            writeln!(output, "{}", if self.values.is_some() { VALUES } else { HEADER })?;
        }
        Ok(())
    }

    fn start_line(&mut self, tick: Tick, address: u16) {
        let mut digits = itoa::Buffer::new();
        self.line.clear();
        self.line.extend(digits.format(tick.micros()).as_bytes());
        self.line.push(b',');
        self.line.extend(digits.format(address).as_bytes());
        self.line.push(b',');
    }

    /// Appends a value to the line, as the shortest text that can be parsed to exactly the same value. The text of an
    /// `f32` sample must be parsed as `f32`, and any other text as `f64`.
    fn value(&mut self, value: f64) {
        let mut digits = zmij::Buffer::new();
        let text = match self.values {
            Some(SampleType::F32) => digits.format(value as f32),
            _ => digits.format(value),
        };
        self.line.extend(text.as_bytes());
    }
}

impl EventWriter for Writer {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()> {
        self.begin(output)?;
        match *item {
            Item::Event(Event { tick, address, polarity }) => {
                self.start_line(tick, address);
                let polarity: &[u8] = if polarity == Polarity::Up { b"1\n" } else { b"-1\n" };
                self.line.extend(polarity);
                output.write_all(&self.line)?;
            }
            Item::Value { tick, address, value, known } => {
                self.start_line(tick, address);
                self.value(value);
                let known: &[u8] = match known {
                    Known::Keyframe => b",keyframe\n",
                    Known::Exact => b",exact\n",
                    Known::Estimate => b",estimate\n",
                };
                self.line.extend(known);
                output.write_all(&self.line)?;
            }
            Item::Keyframe(Keyframe { tick, address, kind, bits }) => {
                let (tick, digits, name) = (tick.micros(), 2 * kind.size(), name_of(kind));
                writeln!(output, "# keyframe={tick},{address},{bits:0digits$x},{name}")?;
            }
            Item::Heartbeat(tick, address) => {
                writeln!(output, "# heartbeat={},{address}", tick.micros())?;
            }
            Item::LostFrames(count) => writeln!(output, "# lost_frames={count}")?,
            Item::LostEvents => writeln!(output, "# lost_events")?,
            Item::Restart => writeln!(output, "# restart")?,
        }
        Ok(())
    }

    fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        self.begin(output)
    }
}
