//! Tables of events as CSV, with the columns `tick,address,polarity`, or `tick,x,y,polarity` for those of a camera. Comment
//! lines hold all other items, such as keyframes.

use super::{EventReader, EventWriter, EventsKind, Item, Known, Tally};
use crate::error::At;
use crate::{Place, Result};
use catalogue::run::SampleType;
use spikewire::{Event, Keyframe, Polarity, SampleKind, Tick};
use spikewire_cameras::frame::PixelEvent;
use std::io::Write;

pub(super) const HEADER: &str = "tick,address,polarity";
pub(super) const PIXELS: &str = "tick,x,y,polarity";
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
    origin: Origin,
    polarity: usize,
}

/// The columns that say where an event comes from.
#[derive(Clone, Copy)]
enum Origin {
    Address(usize),
    Pixel { x: usize, y: usize },
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
        self.events += u64::from(matches!(item, Some(Item::Event(_) | Item::Pixel(_))));
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
    let origin = match (find(&["address"]), find(&["x"]), find(&["y"])) {
        (Some(address), ..) => Some(Origin::Address(address)),
        (None, Some(x), Some(y)) => Some(Origin::Pixel { x, y }),
        _ => None,
    };
    match (find(&["tick", "time_us"]), origin, find(&["polarity"])) {
        (Some(tick), Some(origin), Some(polarity)) => Ok(Columns { tick, origin, polarity }),
        _ => Err(EventsKind::NoHeader { text: text.to_owned() }.into()),
    }
}

fn event_item(text: &str, columns: Columns, long_ticks: &mut u64) -> Result<Item> {
    let field = |column: usize| text.split(',').nth(column).map_or("", str::trim);
    let tick = field(columns.tick);
    let micros: u64 = tick.parse().map_err(|_| EventsKind::Tick { text: tick.to_owned() })?;
    let tick = Tick::from_micros(micros);
    *long_ticks += u64::from(u64::from(tick.micros()) != micros);
    let polarity = match field(columns.polarity) {
        "1" => Polarity::Up,
        "-1" => Polarity::Down,
        other => return Err(EventsKind::Polarity { text: other.to_owned() }.into()),
    };
    match columns.origin {
        Origin::Address(column) => {
            let text = field(column);
            let no_address = |_| EventsKind::Address { text: text.to_owned() };
            let address = text.parse().map_err(no_address)?;
            Ok(Item::Event(Event { tick, address, polarity }))
        }
        Origin::Pixel { x, y } => {
            let (x, y) = (pixel("x", field(x))?, pixel("y", field(y))?);
            Ok(Item::Pixel(PixelEvent { tick, x, y, polarity }))
        }
    }
}

fn pixel(column: &'static str, text: &str) -> Result<u16> {
    text.parse().map_err(|_| EventsKind::Pixel { column, text: text.to_owned() }.into())
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
    /// Whether events have columns and rows; `None` before the first item.
    has_pixels: Option<bool>,
    line: Vec<u8>,
}

impl Writer {
    pub(super) fn new(values: Option<SampleType>) -> Self {
        Self { values, has_pixels: None, line: Vec::new() }
    }

    /// Writes the header at the first call. `has_pixels` is what the first item asks for.
    fn begin(&mut self, has_pixels: bool, output: &mut dyn Write) -> Result<()> {
        if self.has_pixels.is_none() {
            self.has_pixels = Some(has_pixels);
            let header = match (self.values, has_pixels) {
                (Some(_), _) => VALUES,
                (None, true) => PIXELS,
                (None, false) => HEADER,
            };
            writeln!(output, "{header}")?;
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

    fn polarity(&mut self, polarity: Polarity) {
        self.line.extend(if polarity == Polarity::Up { &b"1\n"[..] } else { b"-1\n" });
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
        self.begin(matches!(item, Item::Pixel(_)), output)?;
        match *item {
            Item::Event(_) if self.has_pixels == Some(true) => {
                return Err(EventsKind::NoAddresses.into());
            }
            Item::Pixel(_) if self.has_pixels == Some(false) => {
                return Err(EventsKind::NoPixels.into());
            }
            Item::Event(Event { tick, address, polarity }) => {
                self.start_line(tick, address);
                self.polarity(polarity);
                output.write_all(&self.line)?;
            }
            Item::Pixel(PixelEvent { tick, x, y, polarity }) => {
                self.start_line(tick, x);
                self.line.extend(itoa::Buffer::new().format(y).as_bytes());
                self.line.push(b',');
                self.polarity(polarity);
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
        self.begin(false, output)
    }
}
