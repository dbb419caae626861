//! Events to the bytes of one transfer.

use crate::format::{EventFormat, FormatError};
use crate::{Event, EventSource};

/// Turns events into the bytes of one transfer: an [event format](crate::format) by way of
/// [`Formatted`], or the frames of a link's transmitter.
pub trait Batch {
    /// The bytes in which any event, keyframe or frame fits. A batch of fewer may be too short for the
    /// next one, and then stays empty.
    const SHORTEST: usize;

    /// Takes events while they fit, writes their bytes, and returns how many bytes there are; 0 if
    /// there is nothing to send.
    ///
    /// An event that was taken and does not fit is held, and comes first in the next batch.
    fn fill(&mut self, events: &mut impl EventSource, bytes: &mut [u8]) -> usize;
}

impl<B: Batch> Batch for &mut B {
    const SHORTEST: usize = B::SHORTEST;

    fn fill(&mut self, events: &mut impl EventSource, bytes: &mut [u8]) -> usize {
        (**self).fill(events, bytes)
    }
}

/// Events one after the other in an event format.
///
/// ```
/// use spikewire::{Event, Polarity, format::{Edvs, EdvsTime}, sink::{Batch, Formatted}};
///
/// let event = Event { tick: 0, address: 0x0102, polarity: Polarity::Up };
/// let mut batch = Formatted::new(Edvs::new(EdvsTime::None).encoder());
/// let mut bytes = [0; 5];
/// assert_eq!(batch.fill(&mut [event; 3].into_iter(), &mut bytes), 4);
/// assert_eq!(batch.fill(&mut core::iter::empty(), &mut bytes), 2); // the third was held
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Formatted<F> {
    format: F,
    held: Option<Event>,
    unspeakable: u32,
}

impl<F: EventFormat> Formatted<F> {
    /// Events in this format.
    pub const fn new(format: F) -> Self {
        Self { format, held: None, unspeakable: 0 }
    }

    /// The format, for its counters.
    pub const fn format(&self) -> &F {
        &self.format
    }

    /// How many events were dropped because the format has no word for their address.
    pub const fn unspeakable(&self) -> u32 {
        self.unspeakable
    }
}

impl<F: EventFormat> Batch for Formatted<F> {
    const SHORTEST: usize = F::LONGEST;

    fn fill(&mut self, events: &mut impl EventSource, bytes: &mut [u8]) -> usize {
        let mut written = 0;
        while let Some(event) = self.held.take().or_else(|| events.next_event()) {
            let rest = bytes.get_mut(written..).unwrap_or_default();
            match self.format.encode(event, rest) {
                Ok(length) => written += length,
                Err(FormatError::Full { written: more }) => {
                    self.held = Some(event);
                    written += more;
                    break;
                }
                Err(FormatError::Address { .. }) => {
                    self.unspeakable = self.unspeakable.saturating_add(1);
                }
            }
        }
        written
    }
}
