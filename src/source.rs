//! Where a sink takes its events from.

use crate::Event;

/// A source of events: an `EventQueue`, as `&EVENTS`, or any iterator.
pub trait EventSource {
    /// The next event, if there is one now.
    fn next_event(&mut self) -> Option<Event>;

    /// How many events the source has lost; a change says that some are missing between the events
    /// before and after it.
    fn lost(&self) -> u32;
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
