//! Reads and writes whole streams of events in memory.

use super::{EventsKind, Format, Item};
use crate::Result;
use spikewire::Event;

/// The events of a whole stream.
#[derive(Clone, Debug, Default)]
pub struct Events {
    /// The events, in the order of the stream.
    pub events: Vec<Event>,
    /// Notes on losses and on everything that is not an event.
    pub notes: Vec<String>,
}

/// Reads all events from bytes. `format` is the name of the bytes' format, such as `es`, `evt2`, `link` or `edvs:e2`.
///
/// # Errors
/// Returns an error if the format is unknown, or if the bytes belong to a different format.
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
    let event = |item: &Item| match item {
        Item::Event(event) => Some(*event),
        _ => None,
    };
    let notes = tally.to_string().lines().map(str::to_owned).collect();
    Ok(Events { events: items.iter().filter_map(event).collect(), notes })
}

/// Writes events as bytes. `format` is the name of the bytes' format, such as `evt2`. Returns the bytes, and notes on
/// items that the format could not hold.
///
/// # Errors
/// Returns an error if the format is unknown, or if it cannot express an event.
pub fn write_events(events: &[Event], format: &str) -> Result<(Vec<u8>, Vec<String>)> {
    let mut writer = format.parse::<Format>()?.writer(false);
    let mut bytes: Vec<u8> = Vec::new();
    for event in events {
        writer.write(&Item::Event(*event), &mut bytes)?;
    }
    writer.finish(&mut bytes)?;
    Ok((bytes, writer.notes()))
}
