//! Batches: items as the bytes of one transfer.

use super::format::{EventFormat, FormatError};
use crate::event::{Event, Source};

/// Turns items into the bytes of one transfer: an [event format](crate::format) by way of
/// [`Formatted`], or the frames of a link's transmitter.
pub trait Batch {
    /// The length of a buffer in which every event, keyframe or frame fits. In a shorter buffer the next item may
    /// not fit, and the batch then stays empty.
    const SHORTEST: usize;

    /// Takes items while they fit, writes their bytes, and returns how many bytes it wrote; 0 if there are no items.
    ///
    /// An item that was taken and does not fit is kept, and comes first in the next batch.
    fn fill(&mut self, events: &mut impl Source, bytes: &mut [u8]) -> usize;

    /// [Fills](Self::fill) the room that is left in a vector of `heapless`, and returns how many bytes it appended.
    #[cfg(feature = "heapless")]
    fn fill_vec(&mut self, events: &mut impl Source, bytes: &mut heapless::VecView<u8>) -> usize {
        let before = bytes.len();
        let capacity = bytes.capacity();
        if bytes.resize(capacity, 0).is_err() {
            return 0;
        }
        let written = self.fill(events, bytes.get_mut(before..).unwrap_or_default());
        bytes.truncate(before.saturating_add(written));
        written
    }
}

impl<B: Batch> Batch for &mut B {
    const SHORTEST: usize = B::SHORTEST;

    fn fill(&mut self, events: &mut impl Source, bytes: &mut [u8]) -> usize {
        (**self).fill(events, bytes)
    }
}

/// Events in an event format, one after the other. Event formats cannot carry keyframes and breaks, which are left
/// out.
///
/// ```
/// use spikewire::{Event, FromEvents, Polarity, Tick};
/// use spikewire::{format::{Edvs, EdvsTime}, out::{Batch, Formatted}};
///
/// let event = Event { tick: Tick::from_micros(0), address: 0x0102, polarity: Polarity::Up };
/// let mut batch = Formatted::new(Edvs::new(EdvsTime::None).encoder());
/// let mut source = FromEvents([event; 3].into_iter());
/// let mut bytes = [0; 5];
/// assert_eq!(batch.fill(&mut source, &mut bytes), 4);
/// assert_eq!(batch.fill(&mut source, &mut bytes), 2); // the third, which did not fit before
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Formatted<F> {
    format: F,
    held: Option<Event>,
    unencodable: u32,
}

impl<F: EventFormat> Formatted<F> {
    /// A batch of events in this format.
    pub const fn new(format: F) -> Self {
        Self { format, held: None, unencodable: 0 }
    }

    /// The format, for its counters.
    pub const fn format(&self) -> &F {
        &self.format
    }

    /// How many events were dropped because the format has no word for their address.
    pub const fn unencodable(&self) -> u32 {
        self.unencodable
    }
}

impl<F: EventFormat> Batch for Formatted<F> {
    const SHORTEST: usize = F::LONGEST;

    fn fill(&mut self, events: &mut impl Source, bytes: &mut [u8]) -> usize {
        let mut written = 0_usize;
        while let Some(event) = self.held.take().or_else(|| events.take_event()) {
            let rest = bytes.get_mut(written..).unwrap_or_default();
            match self.format.encode(event, rest) {
                Ok(length) => written = written.wrapping_add(length),
                Err(FormatError::Full { written: more }) => {
                    self.held = Some(event);
                    written = written.wrapping_add(more);
                    break;
                }
                Err(FormatError::Address { .. } | FormatError::Pixel { .. }) => {
                    self.unencodable = self.unencodable.saturating_add(1);
                }
            }
        }
        written
    }
}
