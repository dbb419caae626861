//! The counters of a chip's driver.

/// The driver's counters. They count resets, overflows of the chip's queue, and the time steps, events, words and
/// outputs that were late, sent again, skipped or lost. Each counter saturates at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Number of resets, including the first one.
    pub resets: u32,
    /// Number of time steps that the driver skipped or dropped. If more than 255 time steps are due at a call of
    /// [`advance`](super::Running::advance) or [`feed`](super::Running::feed), the call skips the oldest ones. A reset
    /// drops a time step that the chip has not acknowledged.
    pub skipped_steps: u32,
    /// Number of events that were fed after their time step was over.
    pub late_events: u32,
    /// Number of events that were dropped because the network has no input for them.
    pub unmapped_events: u32,
    /// Number of events that were sent again after a reset, because no ACK had been seen for them. The chip may have
    /// taken such an event just before the reset; if the event was still in the chip's queue, it had no effect.
    pub repeated_events: u32,
    /// Number of words from [`send`](super::Running::send) that a reset dropped. The driver had not seen an ACK for
    /// these words.
    pub dropped_words: u32,
    /// Number of outputs lost at resets: the chip had raised REQ for the output, but the driver had not read it yet.
    pub lost_outputs: u32,
    /// Number of times that the driver saw the chip's queue become full. Each time, any number of spikes between
    /// neurons may be lost. Always 0 if the pin [`SCHED_FULL`](super::AerPort::queue_full) is not wired.
    pub overflows: u32,
}
