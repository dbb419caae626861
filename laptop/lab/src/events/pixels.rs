//! Writes events in formats that have addresses or a camera's columns and rows: Event Stream, EVT2, EVT3. The first event
//! decides.

use super::bytes;
use super::prophesee::{self, Version};
use super::{EventWriter, EventsKind, Item, Size};
use crate::Result;
use spikewire_cameras::format::{Dvs, EventStream, Evt2Pixels, Evt3Pixels};
use std::io::Write;

/// A format with addresses or with columns and rows.
#[derive(Clone, Copy)]
pub(super) enum Format {
    EventStream,
    Evt2,
    Evt3,
}

/// A writer of one of these formats.
pub(super) struct Writer {
    format: Format,
    /// The size of the picture, from the format's settings.
    chosen: Option<Size>,
    /// The size of the picture, from the input.
    size: Option<Size>,
    drops: bool,
    /// The writer of the format for the kind of events that come; `None` before the first item.
    inner: Option<Box<dyn EventWriter>>,
}

impl Writer {
    /// Makes a writer. If `drops` is true, it drops and counts events that the format cannot express.
    pub(super) fn new(format: Format, chosen: Option<Size>, drops: bool) -> Self {
        Self { format, chosen, size: None, drops, inner: None }
    }

    fn begin(&self, has_pixels: bool) -> Result<Box<dyn EventWriter>> {
        let size = self.chosen.or(self.size);
        // Any pixel of these formats fits.
        let of_header = has_pixels.then(|| size.unwrap_or(Size { width: 2048, height: 2048 }));
        Ok(match self.format {
            Format::EventStream if has_pixels => {
                let Size { width, height } = size.ok_or(EventsKind::NoSize)?;
                let camera = Dvs::new(width, height);
                let header = camera.header().to_vec();
                Box::new(bytes::Writer::new(camera.encoder(), Dvs::decoder(), header, self.drops))
            }
            Format::EventStream => Box::new(bytes::Writer::new(
                EventStream::encoder(),
                EventStream::decoder(),
                EventStream::HEADER.to_vec(),
                self.drops,
            )),
            Format::Evt2 => Box::new(bytes::Writer::new(
                Evt2Pixels::encoder(),
                Evt2Pixels::file_decoder(),
                prophesee::header(Version::Evt2, of_header),
                self.drops,
            )),
            Format::Evt3 => {
                let header = prophesee::header(Version::Evt3, of_header);
                let (encoder, decoder) = (Evt3Pixels::encoder(), Evt3Pixels::decoder());
                Box::new(bytes::Writer::after(header, encoder, decoder, self.drops))
            }
        })
    }

    fn writer(&mut self, has_pixels: bool) -> Result<&mut Box<dyn EventWriter>> {
        let writer = match self.inner.take() {
            Some(writer) => writer,
            None => self.begin(has_pixels)?,
        };
        Ok(self.inner.insert(writer))
    }
}

impl EventWriter for Writer {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()> {
        self.writer(matches!(item, Item::Pixel(_)))?.write(item, output)
    }

    fn set_size(&mut self, size: Size) {
        self.size = Some(size);
    }

    fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        let has_pixels = self.chosen.or(self.size).is_some();
        self.writer(has_pixels)?.finish(output)
    }

    fn notes(&self) -> Vec<String> {
        self.inner.as_ref().map_or_else(Vec::new, |writer| writer.notes())
    }
}
