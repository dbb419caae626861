//! Summarises times that come one by one: the clock, and how often it wrapped around.

use super::{CHUNK, Clock, Rollover};

/// Times of a recording that is read once, without storing it.
pub(super) struct Times {
    gap: f64,
    /// The first times, from which the usual step is taken.
    first: Vec<i64>,
    clock: Option<Clock>,
    rollover: Rollover,
}

impl Times {
    /// Starts without times; steps above `gap` usual ones count as gaps.
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

    /// Returns the clock with length, rate and gaps, and how often it wrapped around.
    pub(super) fn finish(mut self) -> (Clock, Rollover) {
        let clock = self.clock.take().unwrap_or_else(|| self.started());
        (clock, self.rollover)
    }
}
