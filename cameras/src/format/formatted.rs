//! Batches of events in an event format, for sinks.

use super::{EventFormat, FormatError};
use spikewire::{Event, Source, out::Batch};

/// Events in an event format, one after the other: a batch for the [sinks](spikewire::out). Event formats cannot carry keyframes and breaks, which are left
/// out.
///
/// ```
/// use spikewire::{Event, FromEvents, Polarity, Tick, out::Batch};
/// use spikewire_cameras::format::{Edvs, EdvsTime, Formatted};
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
