//! Converts bytes of one event format to bytes of another.

use super::{EventReader, EventWriter, EventsKind, Format, Item, Tally};
use crate::Result;
use catalogue::run::{Spell, Worded, quoted};
use spikewire::Tick;
use std::collections::HashSet;
use std::fmt;
use std::io::Write;

/// A reader connected to a writer, with counts of the items that pass between them.
pub struct Stream<'a> {
    reader: Box<dyn EventReader + 'a>,
    writer: Box<dyn EventWriter>,
    /// Shift of the output's ticks. If the caller wants the output to start at 0, the first tick is subtracted from all
    /// ticks.
    zero: Zero,
    items: Vec<Item>,
    bytes: u64,
    events: u64,
    values: u64,
    addresses: Vec<u64>,
    /// The columns and rows that had events.
    pixels: HashSet<(u16, u16)>,
    last: Option<Tick>,
    wraps: u64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Zero {
    Keep,
    Wanted,
    At(Tick),
}

impl<'a> Stream<'a> {
    /// Connects a reader to a writer. If `from_zero`, all ticks are shifted such that the first tick is 0.
    pub fn new(
        reader: Box<dyn EventReader + 'a>,
        writer: Box<dyn EventWriter>,
        from_zero: bool,
    ) -> Self {
        Self {
            reader,
            writer,
            zero: if from_zero { Zero::Wanted } else { Zero::Keep },
            items: Vec::new(),
            bytes: 0,
            events: 0,
            values: 0,
            addresses: vec![0; 1 << 16],
            pixels: HashSet::new(),
            last: None,
            wraps: 0,
        }
    }

    /// Converts the next bytes of the input, which may be split between any two bytes. `arrival` is the bytes' time of
    /// arrival, for formats whose events have no times.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read, or if their items cannot be written.
    pub fn push(
        &mut self,
        bytes: &[u8],
        arrival: Option<Tick>,
        output: &mut dyn Write,
    ) -> Result<()> {
        /// Maximum number of bytes that are read at once, which bounds the memory that the items take.
        const PIECE: usize = 1 << 14;
        if let Some(tick) = arrival {
            self.reader.set_arrival(tick);
        }
        for piece in bytes.chunks(PIECE) {
            self.bytes += piece.len() as u64;
            // Items before an error are still written.
            let read = self.reader.read(piece, &mut self.items);
            self.write(output)?;
            read?;
        }
        Ok(())
    }

    /// Ends the stream after its last bytes, and writes the items that were held back.
    ///
    /// # Errors
    /// See [`push`](Self::push).
    pub fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        let read = self.reader.finish(&mut self.items);
        self.write(output)?;
        read?;
        self.writer.finish(output)
    }

    fn write(&mut self, output: &mut dyn Write) -> Result<()> {
        if let Some(size) = self.reader.size() {
            self.writer.set_size(size);
        }
        let mut items = std::mem::take(&mut self.items);
        for item in &mut items {
            self.observe(item);
            self.writer.write(item, output)?;
        }
        items.clear();
        self.items = items;
        Ok(())
    }

    fn observe(&mut self, item: &mut Item) {
        let now = match item {
            Item::Event(event) => {
                self.events += 1;
                self.addresses[usize::from(event.address)] += 1;
                &mut event.tick
            }
            Item::Pixel(event) => {
                self.events += 1;
                self.pixels.insert((event.x, event.y));
                &mut event.tick
            }
            Item::Value { tick, address, .. } => {
                self.values += 1;
                self.addresses[usize::from(*address)] += 1;
                tick
            }
            Item::Keyframe(keyframe) => {
                self.start_at_zero(&mut keyframe.tick);
                return;
            }
            Item::Heartbeat(tick, _) => {
                self.start_at_zero(tick);
                return;
            }
            _ => return,
        };
        self.start_at_zero(now);
        if self.last.is_some_and(|last| now.micros() < last.micros() && last.is_before(*now)) {
            self.wraps += 1;
        }
        self.last = Some(*now);
    }

    fn start_at_zero(&mut self, tick: &mut Tick) {
        match self.zero {
            Zero::Keep => {}
            Zero::Wanted => {
                self.zero = Zero::At(*tick);
                *tick = Tick::from_micros(0);
            }
            Zero::At(zero) => *tick = Tick::from(tick.micros().wrapping_sub(zero.micros())),
        }
    }

    /// Returns an entry for each address from 0 to 65535: the number of events and decoded values that have this
    /// address.
    pub fn addresses(&self) -> &[u64] {
        &self.addresses
    }

    /// Returns the total number of events and decoded values.
    pub fn count(&self) -> u64 {
        self.events + self.values
    }

    /// Returns the number of bytes read so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Checks that the bytes read so far belong to `format`. `file` is the input's name in the error.
    ///
    /// # Errors
    /// Returns an error if bytes were skipped and neither an event nor a frame was found.
    pub fn check_format(&self, format: Format, file: &str) -> Result<()> {
        let Tally { skipped, link, .. } = self.tally();
        let frames = link.map_or(0, |link| link.frames);
        if skipped > 0 && self.count() == 0 && frames == 0 {
            let what = if link.is_some() { "frame" } else { "event" };
            let bytes = self.bytes;
            let format = format.to_string();
            return Err(EventsKind::OtherFormat { format, what, bytes }.at(file));
        }
        Ok(())
    }

    /// Returns a text for the user: how many bytes were written in total, and for each event or value on average.
    /// `bytes` is the total.
    pub fn written(&self, bytes: u64) -> String {
        match self.count() {
            0 => format!("{bytes} bytes written"),
            count => {
                let what = if self.values > 0 { "a value" } else { "an event" };
                format!("{bytes} bytes written, {:.2} {what}", bytes as f64 / count as f64)
            }
        }
    }

    /// Returns the counts of everything in the stream that is not an event.
    pub fn tally(&self) -> Tally {
        self.reader.tally()
    }
}

/// Writes notes for the user about the stream up to now, a line each.
impl fmt::Display for Stream<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.word(f, quoted)
    }
}

impl Worded for Stream<'_> {
    fn word(&self, f: &mut fmt::Formatter<'_>, spell: Spell) -> fmt::Result {
        let (count, what) =
            if self.values > 0 { (self.values, "values") } else { (self.events, "events") };
        let (places, of_places) = match self.pixels.len() {
            0 => (self.addresses.iter().filter(|&&count| count > 0).count(), "addresses"),
            pixels => (pixels, "pixels"),
        };
        write!(f, "{} bytes, {count} {what} at {places} {of_places}", self.bytes)?;
        if count > 0 {
            write!(f, ", {:.2} bytes each", self.bytes as f64 / count as f64)?;
        }
        writeln!(f)?;
        self.tally().word(f, spell)?;
        if let Zero::At(zero) = self.zero {
            writeln!(f, "{} µs taken off every tick", zero.micros())?;
        }
        if self.wraps > 0 {
            writeln!(f, "ticks wrapped {} times, after 71.6 minutes each", self.wraps)?;
        }
        self.writer.notes().iter().try_for_each(|note| writeln!(f, "{note}"))
    }
}
