//! Reads and writes whole streams of events in memory.

use super::{EventsKind, Format, Item, Size};
use crate::Result;
use spikewire::Event;
use spikewire_cameras::frame::PixelEvent;

/// The events of a whole stream.
#[derive(Clone, Debug, Default)]
pub struct Events {
    /// The events that have an address, in the order of the stream.
    pub events: Vec<Event>,
    /// The events that have a column and a row. A stream has either these or the others.
    pub pixels: Vec<PixelEvent>,
    /// Notes on losses and on everything that is not an event.
    pub notes: Vec<String>,
}

/// Reads all events from bytes. `format` is the name of the bytes' format, such as `es`, `evt2`, `link` or `edvs:e2`.
///
/// # Errors
/// Returns an error if the format is unknown, if the bytes belong to a different format, or if events have a row that no
/// address holds.
pub fn read_events(bytes: &[u8], format: &str) -> Result<Events> {
    let format: Format = format.parse()?;
    let mut reader = format.reader("the bytes");
    let mut items = Vec::new();
    reader.read(bytes, &mut items)?;
    reader.finish(&mut items)?;
    let tally = reader.tally();
    let is_heard = tally.link.is_some_and(|link| link.frames > 0) || !items.is_empty();
    if tally.skipped > 0 && !is_heard {
        let (format, bytes) = (format.to_string(), bytes.len() as u64);
        return Err(EventsKind::OtherFormat { format, what: "event", bytes }.into());
    }
    if tally.far_rows > 0 {
        return Err(EventsKind::FarRows { events: tally.far_rows }.into());
    }
    let notes = tally.to_string().lines().map(str::to_owned).collect();
    let mut all = Events { notes, ..Events::default() };
    for item in items {
        match item {
            Item::Event(event) => all.events.push(event),
            Item::Pixel(event) => all.pixels.push(event),
            _ => {}
        }
    }
    Ok(all)
}

/// Writes events as bytes. `format` is the name of the bytes' format, such as `evt2`. Returns the bytes, and notes on
/// items that the format could not hold.
///
/// # Errors
/// Returns an error if the format is unknown, or if it cannot express an event.
pub fn write_events(events: &[Event], format: &str) -> Result<(Vec<u8>, Vec<String>)> {
    write(events.iter().copied().map(Item::Event), None, format)
}

/// Writes events of a camera as bytes. As [`write_events`]; a format whose header has the size of the picture takes it from
/// its settings, such as `es,width=320,height=240`, or from the largest column and row.
///
/// # Errors
/// See [`write_events`].
pub fn write_pixels(pixels: &[PixelEvent], format: &str) -> Result<(Vec<u8>, Vec<String>)> {
    let width = pixels.iter().map(|pixel| pixel.x).max().unwrap_or(0).saturating_add(1);
    let height = pixels.iter().map(|pixel| pixel.y).max().unwrap_or(0).saturating_add(1);
    write(pixels.iter().copied().map(Item::Pixel), Some(Size { width, height }), format)
}

fn write(
    items: impl Iterator<Item = Item>,
    size: Option<Size>,
    format: &str,
) -> Result<(Vec<u8>, Vec<String>)> {
    let mut writer = format.parse::<Format>()?.writer(false)?;
    if let Some(size) = size {
        writer.set_size(size);
    }
    let mut bytes: Vec<u8> = Vec::new();
    for item in items {
        writer.write(&item, &mut bytes)?;
    }
    writer.finish(&mut bytes)?;
    Ok((bytes, writer.notes()))
}
