//! Bins: how often each address fired in a time step, for chips that take counts instead of events.

use core::num::NonZeroU32;

use super::{Event, Tick};

/// Counts the events of one time step for `N` addresses, 0 to `N - 1`.
///
/// - **Step:** 1 to 2³¹-1 µs; a longer one is cut to that. **Counts:** 0 to the [limit](Self::with_limit), 255 by
///   default.
/// - **Memory:** `N + 21` bytes, rounded up to words. **Work:** constant for each event.
/// - **Order:** give it events in the order of time. An event of a step that was already taken is late, and so is one
///   2³¹ µs (35.8 minutes) or more after the start of the step.
/// - **Polarity:** both polarities count alike; to count them apart, give each its own address.
/// - **Events left out** are counted by [`saturated`](Self::saturated), [`late`](Self::late) and
///   [`outside`](Self::outside).
///
/// ```
/// use core::num::NonZeroU32;
/// use spikewire::{Bins, Event, Polarity, Tick};
///
/// let mut bins = Bins::<2>::new(Tick::from_micros(0), NonZeroU32::new(1_000).unwrap());
/// let up = |micros, address| {
///     Event { tick: Tick::from_micros(micros), address, polarity: Polarity::Up }
/// };
///
/// let mut steps = Vec::new();
/// for event in [up(10, 0), up(999, 0), up(1_000, 1), up(3_500, 0)] {
///     while bins.add(event).is_err() { // the event belongs to a later step
///         steps.push(bins.take());
///     }
/// }
/// assert_eq!(steps, [[2, 0], [0, 1], [0, 0]]); // and [1, 0] is still being counted
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bins<const N: usize> {
    counts: [u8; N],
    limit: u8,
    start: Tick,
    step: u32,
    saturated: u32,
    late: u32,
    outside: u32,
}

/// The event lies after the time step: [`take`](Bins::take) its counts, then add it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepOver;

impl<const N: usize> Bins<N> {
    /// Empty, with a first time step that starts at this tick and lasts `step` µs.
    pub const fn new(start: Tick, step: NonZeroU32) -> Self {
        const { assert!(N >= 1 && N <= 1 << 16, "addresses have 16 bits") };
        let step = if step.get() > i32::MAX as u32 { i32::MAX as u32 } else { step.get() };
        Self { counts: [0; N], limit: u8::MAX, start, step, saturated: 0, late: 0, outside: 0 }
    }

    /// Sets the limit at which counts stop; 255 by default.
    #[must_use]
    pub const fn with_limit(self, limit: u8) -> Self {
        Self { limit, ..self }
    }

    /// Counts an event.
    ///
    /// # Errors
    /// Returns an error if the event lies after the time step and is not counted yet.
    pub fn add(&mut self, event: Event) -> Result<(), StepOver> {
        let since = event.tick.since(self.start);
        if since >= self.step as i32 {
            return Err(StepOver);
        }
        match self.counts.get_mut(usize::from(event.address)) {
            None => self.outside = self.outside.saturating_add(1),
            Some(_) if since < 0 => self.late = self.late.saturating_add(1),
            Some(count) if *count < self.limit => *count += 1,
            Some(_) => self.saturated = self.saturated.saturating_add(1),
        }
        Ok(())
    }

    /// Whether the time step is over at this tick, with or without events.
    pub fn is_over(&self, now: Tick) -> bool {
        now.since(self.start) >= self.step as i32
    }

    /// Returns the counts and begins the next time step.
    pub fn take(&mut self) -> [u8; N] {
        self.start += self.step;
        core::mem::replace(&mut self.counts, [0; N])
    }

    /// The tick at which the time step starts.
    pub const fn start(&self) -> Tick {
        self.start
    }

    /// How many events met a count at its limit.
    pub const fn saturated(&self) -> u32 {
        self.saturated
    }

    /// How many events lay before the time step: in a step already taken, or before the first.
    pub const fn late(&self) -> u32 {
        self.late
    }

    /// How many events had an address of `N` or above.
    pub const fn outside(&self) -> u32 {
        self.outside
    }
}
