//! Counts of items that an event format cannot hold.

use super::{EventsKind, Item};
use crate::Result;
use spikewire::Tick;

/// Counts of items that a writer left out, and of events whose time the format changed.
#[derive(Clone, Copy, Default)]
pub(super) struct Omitted {
    dropped: u64,
    retimed: u64,
    furthest: u32,
    /// Number of omitted keyframes, heartbeats and losses.
    others: u64,
}

impl Omitted {
    /// Counts an event that was dropped because the format cannot express it.
    pub(super) fn drop_event(&mut self) {
        self.dropped += 1;
    }

    /// Compares the time `event` of a written event with the time `read` that a reader gets from the file. Counts the
    /// event if the times differ, and records the largest difference.
    pub(super) fn observe_time(&mut self, read: Tick, event: Tick) {
        self.retimed += u64::from(read != event);
        self.furthest = self.furthest.max(read.since(event).unsigned_abs());
    }

    /// Counts an omitted item: an event of a camera's pixel if `drops` is true, or an item that is not an event. Restarts
    /// are not counted.
    ///
    /// # Errors
    /// Returns an error for an event of a pixel if `drops` is false.
    pub(super) fn leave_out(&mut self, item: Item, drops: bool) -> Result<()> {
        match item {
            Item::Pixel(_) if drops => self.drop_event(),
            Item::Pixel(_) => return Err(EventsKind::NoPixels.into()),
            other => self.others += u64::from(other != Item::Restart),
        }
        Ok(())
    }

    /// Formats the counts as notes for the user. The note on dropped events contains `what` in the text `no {what} for
    /// them`, for example `no key for them`.
    pub(super) fn notes(self, what: &str) -> Vec<String> {
        let Self { dropped, retimed, furthest, others } = self;
        let all = [
            (dropped, format!("{dropped} events dropped: no {what} for them")),
            (
                retimed,
                format!("{retimed} events will be read at another time, up to {furthest} µs away"),
            ),
            (others, format!("{others} keyframes and losses left out: no word for them")),
        ];
        all.into_iter().filter(|&(count, _)| count > 0).map(|(_, note)| note).collect()
    }
}
