//! Batches: items as the bytes of one transfer.

use crate::event::Source;

/// Turns items into the bytes of one transfer: the frames of a link's transmitter, an event format of
/// `spikewire-cameras`, or a protocol of your own.
///
/// ```
/// use spikewire::{Event, FromEvents, Polarity, Source, Tick, out::Batch};
///
/// /// A byte an event: its address.
/// struct Addresses;
///
/// impl Batch for Addresses {
///     const SHORTEST: usize = 1;
///
///     fn fill(&mut self, events: &mut impl Source, bytes: &mut [u8]) -> usize {
///         let pairs = bytes.iter_mut().zip(core::iter::from_fn(|| events.take_event()));
///         pairs.map(|(byte, event)| *byte = event.address as u8).count()
///     }
/// }
///
/// let event = Event { tick: Tick::from_micros(0), address: 5, polarity: Polarity::Up };
/// let mut source = FromEvents([event; 3].into_iter());
/// let mut bytes = [0; 2];
/// assert_eq!(Addresses.fill(&mut source, &mut bytes), 2);
/// assert_eq!(Addresses.fill(&mut source, &mut bytes), 1);
/// ```
pub trait Batch {
    /// The length of a buffer in which every event, keyframe or frame fits. In a shorter buffer the next item may
    /// not fit, and the batch then stays empty.
    const SHORTEST: usize;

    /// Takes items while they fit, writes their bytes, and returns how many bytes it wrote; 0 if there are no items.
    ///
    /// An item that was taken and does not fit is kept, and comes first in the next batch.
    fn fill(&mut self, events: &mut impl Source, bytes: &mut [u8]) -> usize;

    /// [Fills](Self::fill) the room that is left in a vector of `heapless`, and returns how many bytes it appended.
    #[cfg(feature = "heapless-09")]
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
