//! Reads and writes event formats that are a plain sequence of events: eDVS, Event Stream, EVT2.

use super::omitted::Omitted;
use super::{EventReader, EventWriter, EventsKind, Item, Tally};
use crate::Result;
use spikewire::{Event, Tick};
use spikewire_cameras::format::{EventDecoder, EventFormat, FormatError};
use std::io::Write;

/// Reads events with the decoder of one format.
pub(super) struct Reader<D> {
    decoder: D,
    hooks: Hooks<D>,
}

/// Functions that [`Reader`] calls on the decoder `D` of a format. They differ from format to format.
pub(super) struct Hooks<D> {
    /// Returns an error if the bytes that the decoder has read are not of its format.
    pub check: fn(&D) -> Result<()>,
    /// Sets the time of the events that follow. `None` for a format whose events have times of their own.
    pub set_arrival: Option<fn(&mut D, Tick)>,
}

impl<D: EventDecoder> Reader<D> {
    pub(super) fn new(decoder: D, hooks: Hooks<D>) -> Self {
        Self { decoder, hooks }
    }
}

impl<D: EventDecoder> EventReader for Reader<D> {
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        items.extend(self.decoder.decode(bytes).map(Item::Event));
        (self.hooks.check)(&self.decoder)
    }

    fn tally(&self) -> Tally {
        Tally {
            skipped: self.decoder.skipped().into(),
            is_cut: self.decoder.is_partial(),
            ..Tally::default()
        }
    }

    fn set_arrival(&mut self, tick: Tick) {
        if let Some(set) = self.hooks.set_arrival {
            set(&mut self.decoder, tick);
        }
    }
}

/// A writer of events in one format. It decodes what it has encoded, and counts the events whose time the format
/// changes.
pub(super) struct Writer<E, D> {
    encoder: E,
    decoder: D,
    header: &'static [u8],
    drops: bool,
    events: u64,
    omitted: Omitted,
}

impl<E: EventFormat, D: EventDecoder> Writer<E, D> {
    /// Makes a writer that starts with `header`. The decoder reads back the encoder's bytes, so both must be of the
    /// same format. If `drops` is true, events that the format cannot express are dropped and counted. Otherwise, such
    /// an event causes an error.
    pub(super) fn new(encoder: E, decoder: D, header: &'static [u8], drops: bool) -> Self {
        Self { encoder, decoder, header, drops, events: 0, omitted: Omitted::default() }
    }

    fn event(&mut self, event: Event, output: &mut dyn Write) -> Result<()> {
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
                self.omitted.observe_time(read.tick, event.tick);
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
        self.decoder.decode(header).for_each(drop);
        Ok(output.write_all(header)?)
    }
}

impl<E: EventFormat, D: EventDecoder> EventWriter for Writer<E, D> {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()> {
        self.begin(output)?;
        match *item {
            Item::Event(event) => self.event(event, output)?,
            other => self.omitted.leave_out(other),
        }
        Ok(())
    }

    fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        self.begin(output)
    }

    fn notes(&self) -> Vec<String> {
        self.omitted.notes("word")
    }
}
