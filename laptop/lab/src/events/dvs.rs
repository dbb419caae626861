//! Reads Event Stream files: generic events, with addresses, and those of a camera (DVS), with columns and rows.

use super::{EventReader, EventsKind, Item, Size, Tally};
use crate::Result;
use spikewire_cameras::format::{Dvs, DvsDecoder, EventDecoder, EventStream, EventStreamDecoder};

/// Index of the byte in the header that says which events follow.
const TYPE: usize = 15;
const DVS: u8 = 1;

/// A reader of either type.
#[derive(Default)]
pub(super) struct Reader {
    /// The header up to its type.
    header: Vec<u8>,
    decoder: Option<Decoder>,
}

enum Decoder {
    Generic(EventStreamDecoder),
    Dvs(DvsDecoder),
}

impl Decoder {
    fn decode(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        let is_foreign = match self {
            Self::Generic(decoder) => {
                items.extend(decoder.decode(bytes).map(Item::Event));
                decoder.is_foreign()
            }
            Self::Dvs(decoder) => {
                items.extend(decoder.decode(bytes).map(Item::Pixel));
                decoder.is_foreign()
            }
        };
        if is_foreign { Err(EventsKind::NotAnEventStream.into()) } else { Ok(()) }
    }
}

impl EventReader for Reader {
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        if let Some(decoder) = &mut self.decoder {
            return decoder.decode(bytes, items);
        }
        self.header.extend(bytes);
        // The generic reader refuses the header of any other type.
        let decoder = match self.header.get(TYPE) {
            Some(&DVS) => Decoder::Dvs(Dvs::decoder()),
            _ => Decoder::Generic(EventStream::decoder()),
        };
        if self.header.len() <= TYPE {
            // Refuses bytes that are no header at once, as they may be all that come for a while.
            let mut decoder = decoder;
            return decoder.decode(&self.header, &mut vec![]);
        }
        let header = std::mem::take(&mut self.header);
        self.decoder.insert(decoder).decode(&header, items)
    }

    fn tally(&self) -> Tally {
        let (skipped, is_cut) = match &self.decoder {
            None => (0, !self.header.is_empty()),
            Some(Decoder::Generic(decoder)) => (decoder.skipped(), decoder.is_partial()),
            Some(Decoder::Dvs(decoder)) => (decoder.skipped(), decoder.is_partial()),
        };
        Tally { skipped: skipped.into(), is_cut, ..Tally::default() }
    }

    fn size(&self) -> Option<Size> {
        match &self.decoder {
            Some(Decoder::Dvs(decoder)) => {
                let (width, height) = decoder.size()?;
                Some(Size { width, height })
            }
            _ => None,
        }
    }
}
