//! Times as they come one by one: the clock that they show, and where it ran over.

use super::{CHUNK, Clock, Rollover};

/// The times of a recording that is passed over.
pub(super) struct Times {
    gap: f64,
    /// The first times, which tell what is usual.
    first: Vec<i64>,
    clock: Option<Clock>,
    rollover: Rollover,
}

impl Times {
    /// No times yet; steps above this many usual ones are gaps.
    pub(super) fn new(gap: f64) -> Self {
        Self { gap, first: Vec::new(), clock: None, rollover: Rollover::default() }
    }

    /// Takes the next time, in µs.
    pub(super) fn observe(&mut self, time: i64) {
        let time = self.rollover.take(time);
        if let Some(clock) = &mut self.clock {
            clock.observe(&[time]);
            return;
        }
        self.first.push(time);
        if self.first.len() == CHUNK {
            self.clock = Some(self.started());
            self.first = Vec::new();
        }
    }

    fn started(&self) -> Clock {
        let mut clock = Clock::new(&self.first, None, self.gap);
        clock.observe(&self.first);
        clock
    }

    /// Length, rate and gaps, and how often the clock ran over.
    pub(super) fn finish(mut self) -> (Clock, Rollover) {
        let clock = self.clock.take().unwrap_or_else(|| self.started());
        (clock, self.rollover)
    }
}
