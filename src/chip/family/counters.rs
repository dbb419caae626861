//! What a chip's driver counts.

/// What became of resets, time steps, events and words. All counts stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Resets: the first, and those that brought the chip into step again.
    pub resets: u32,
    /// Time steps that the chip did not get: after a silence of more than 255, and those under way at a
    /// reset.
    pub skipped_steps: u32,
    /// Events that were fed after their time step was over.
    pub late_events: u32,
    /// Events under way at a reset whose ACK was not seen. They are sent again. The chip may have taken
    /// them in the clocks between the look and the reset; one that waits in the queue had no time to act.
    pub repeated_events: u32,
    /// Words of [`send`](super::Running::send) under way at a reset whose ACK was not seen.
    pub dropped_words: u32,
    /// Outputs that waited at a reset.
    pub lost_outputs: u32,
    /// How often the queue was seen to become full, each time with the loss of any number of spikes that
    /// neurons send to each other. 0 without the [pin](super::AerPort::queue_full).
    pub overflows: u32,
}
