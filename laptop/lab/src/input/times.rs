//! Summarises the times of a recording: duration, sample rate, gaps, and wraps of the recorder's clock. The times are
//! added one by one.

use super::{CHUNK, Clock, Rollover};

/// Summary of the times of a recording. The times are added one by one, and are not all stored.
pub(super) struct Times {
    gap: f64,
    /// The first times, from which the usual step is computed.
    first: Vec<i64>,
    clock: Option<Clock>,
    rollover: Rollover,
}

impl Times {
    /// Makes a summary that contains no times yet. A step from one time to the next counts as a gap if it is longer
    /// than `gap` times the usual step.
    pub(super) fn new(gap: f64) -> Self {
        Self { gap, first: Vec::new(), clock: None, rollover: Rollover::default() }
    }

    /// Adds the next time in µs, as shown on the recorder's clock.
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

    /// Returns two results: the duration, sample rate and gaps that the times show, and the wraps of the recorder's
    /// 32-bit clock.
    pub(super) fn finish(mut self) -> (Clock, Rollover) {
        let clock = self.clock.take().unwrap_or_else(|| self.started());
        (clock, self.rollover)
    }
}
