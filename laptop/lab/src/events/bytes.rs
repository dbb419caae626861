//! Reads and writes event formats that are a plain sequence of events: eDVS, Event Stream, EVT2, EVT3.

use super::omitted::Omitted;
use super::prophesee::pixel_of;
use super::{EventReader, EventWriter, EventsKind, Item, Tally};
use crate::Result;
use spikewire::{Event, Tick};
use spikewire_cameras::format::{EventDecoder, EventFormat, FormatError};
use spikewire_cameras::frame::PixelEvent;
use std::io::Write;
use std::marker::PhantomData;

/// Reads events with the decoder of one format.
pub(super) struct Reader<D> {
    decoder: D,
    /// Sets the time of the events that follow. `None` for a format whose events have times of their own.
    set_arrival: Option<fn(&mut D, Tick)>,
}

impl<D: EventDecoder> Reader<D> {
    pub(super) fn new(decoder: D, set_arrival: Option<fn(&mut D, Tick)>) -> Self {
        Self { decoder, set_arrival }
    }
}

impl<D: EventDecoder> EventReader for Reader<D> {
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        items.extend(self.decoder.decode(bytes).map(Item::Event));
        Ok(())
    }

    fn tally(&self) -> Tally {
        Tally {
            skipped: self.decoder.skipped().into(),
            is_cut: self.decoder.is_partial(),
            ..Tally::default()
        }
    }

    fn set_arrival(&mut self, tick: Tick) {
        if let Some(set) = self.set_arrival {
            set(&mut self.decoder, tick);
        }
    }
}

/// An event as a format writes it: with an address, or with a column and a row.
pub(super) trait Written: Copy {
    /// Returns the event of an item; `None` if the item has none of this kind.
    fn from_item(item: &Item) -> Option<Self>;

    fn tick(self) -> Tick;
}

impl Written for Event {
    fn from_item(item: &Item) -> Option<Self> {
        match item {
            Item::Event(event) => Some(*event),
            _ => None,
        }
    }

    fn tick(self) -> Tick {
        self.tick
    }
}

impl Written for PixelEvent {
    fn from_item(item: &Item) -> Option<Self> {
        match item {
            Item::Event(event) => Some(pixel_of(*event)),
            Item::Pixel(event) => Some(*event),
            _ => None,
        }
    }

    fn tick(self) -> Tick {
        self.tick
    }
}

/// A writer of events in one format. It decodes what it has encoded, and counts the events whose time the format
/// changes.
pub(super) struct Writer<E, D, K> {
    encoder: E,
    decoder: D,
    header: Vec<u8>,
    /// Whether the decoder reads the header, too.
    reads_header: bool,
    drops: bool,
    events: u64,
    omitted: Omitted,
    kind: PhantomData<K>,
}

impl<K: Written, E: EventFormat<K>, D: EventDecoder<K>> Writer<E, D, K> {
    /// Makes a writer that starts with `header`. The decoder reads back the encoder's bytes, so both must be of the
    /// same format. If `drops` is true, events that the format cannot express are dropped and counted. Otherwise, such
    /// an event causes an error.
    pub(super) fn new(encoder: E, decoder: D, header: Vec<u8>, drops: bool) -> Self {
        Self {
            encoder,
            decoder,
            header,
            reads_header: true,
            drops,
            events: 0,
            omitted: Omitted::default(),
            kind: PhantomData,
        }
    }

    /// Makes a writer, as [`new`](Self::new) does, with a decoder that reads what comes after the header.
    pub(super) fn after(header: Vec<u8>, encoder: E, decoder: D, drops: bool) -> Self {
        Self { reads_header: false, ..Self::new(encoder, decoder, header, drops) }
    }

    fn event(&mut self, event: K, output: &mut dyn Write) -> Result<()> {
        let mut buffer = [0; 4096];
        loop {
            let (written, is_done) = match self.encoder.encode(event, &mut buffer) {
                Ok(written) => (written, true),
                Err(FormatError::Full { written }) => (written, false),
                Err(_) if self.drops => {
                    self.omitted.drop_event();
                    return Ok(());
                }
                Err(error) => {
                    return Err(EventsKind::NoWord { event: self.events, error }.into());
                }
            };
            let bytes = &buffer[..written];
            output.write_all(bytes)?;
            for read in self.decoder.decode(bytes) {
                self.omitted.observe_time(read.tick(), event.tick());
            }
            if is_done {
                self.events += 1;
                return Ok(());
            }
        }
    }

    /// Writes the header at the first call, and nothing at later calls.
    fn begin(&mut self, output: &mut dyn Write) -> Result<()> {
        let header = std::mem::take(&mut self.header);
        if self.reads_header {
            self.decoder.decode(&header).for_each(drop);
        }
        Ok(output.write_all(&header)?)
    }
}

impl<K: Written, E: EventFormat<K>, D: EventDecoder<K>> EventWriter for Writer<E, D, K> {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()> {
        self.begin(output)?;
        match K::from_item(item) {
            Some(event) => self.event(event, output),
            None => self.omitted.leave_out(*item, self.drops),
        }
    }

    fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        self.begin(output)
    }

    fn notes(&self) -> Vec<String> {
        self.omitted.notes("word")
    }
}
