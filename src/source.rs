//! Where a sink takes its events from.

use crate::Event;

/// A source of events: an `EventQueue`, as `&EVENTS`, or any iterator.
pub trait EventSource {
    /// The next event, if there is one now.
    fn next_event(&mut self) -> Option<Event>;

    /// How many events the source has lost; a change says that some are missing between the events
    /// before and after it.
    fn lost(&self) -> u32;

    /// The number of the next event, if the source numbers them; see [`Mark`].
    fn place(&self) -> Option<u32> {
        None
    }
}

/// Iterators lose nothing.
impl<I: Iterator<Item = Event>> EventSource for I {
    fn next_event(&mut self) -> Option<Event> {
        self.next()
    }

    fn lost(&self) -> u32 {
        0
    }
}

/// Where a queue stood at one moment, so that a link's keyframe finds its place among the events: take
/// it from `EventQueue::mark` for a [`Bank::snapshot`](crate::Bank::snapshot).
///
/// The default is that of a source that neither loses nor numbers events. A keyframe's place is then
/// told by its tick, which takes events in the order of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Mark {
    /// How many events it had lost.
    pub lost: u32,
    /// How many it had taken in, which is the number of the next one to come; wraps.
    pub place: Option<u32>,
}
