//! The counters of a chip's driver.

/// Counts of resets, and of time steps, events and words that were lost or late. All saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Resets, with the first one.
    pub resets: u32,
    /// Time steps that were not sent to the chip: those beyond 255 at a time, and those under way at a reset.
    pub skipped_steps: u32,
    /// Events that were fed after their time step was over.
    pub late_events: u32,
    /// Events that were fed and left out, as they have no input.
    pub unmapped_events: u32,
    /// Events under way at a reset, with no ACK seen. They are sent again. The chip may have taken such an event just
    /// before the reset; if the event waited in the queue, it did not act.
    pub repeated_events: u32,
    /// Words of [`send`](super::Running::send) under way at a reset, with no ACK seen. They are lost.
    pub dropped_words: u32,
    /// Outputs that waited at a reset, and were lost.
    pub lost_outputs: u32,
    /// How often the queue was seen to become full. Each time any number of spikes between neurons may have been lost.
    /// 0 without the [pin](super::AerPort::queue_full).
    pub overflows: u32,
}
