//! Continues the times of 32-bit clocks that wrap around. A clock that counts µs wraps after 71.6 minutes, and a clock
//! that counts ms after 49.7 days.

use super::{Chunk, Source};
use crate::Result;
use catalogue::run::Words;

/// Ranges of 32-bit clocks, in µs: first for a clock that counts µs, then for a clock that counts ms.
const RANGES: [i64; 2] = [1 << 32, 1000 << 32];

/// Longest time between two samples, in µs, for which a wrap of the clock between these samples is recognised.
/// [`STEPS`] may raise this limit.
const SECOND: i64 = 1_000_000;
/// Multiple of the latest step forward in time. If this multiple is longer than [`SECOND`], it replaces [`SECOND`] as
/// the limit.
const STEPS: i64 = 4;

/// Extends the times of a clock beyond its 32 bits.
#[derive(Debug, Default)]
pub struct Rollover {
    previous: Option<i64>,
    /// The latest step forward from one time to the next, in µs.
    step: i64,
    samples: u64,
    /// Number of times that the clock wrapped around.
    count: i64,
    /// Range of the clock in µs: the time after which the clock wraps around.
    range: i64,
    /// Index of the last sample before the clock wrapped around for the first time.
    first: u64,
}

impl Rollover {
    /// Extends the time of the next sample beyond 32 bits, and returns it in µs. `shown` is the time on the 32-bit
    /// clock, in µs.
    pub fn take(&mut self, shown: i64) -> i64 {
        let previous = self.previous.unwrap_or(shown);
        let step = shown.saturating_sub(previous);
        let longest = SECOND.max(STEPS.saturating_mul(self.step));
        let is_over = |range: i64| {
            let (low, high) = if shown < 0 { (-range / 2, range / 2) } else { (0, range) };
            (low..high).contains(&shown)
                && (low..high).contains(&previous)
                && (1..=longest).contains(&(range - step.saturating_abs()))
        };
        let ranges = if self.count == 0 { RANGES } else { [self.range; 2] };
        match ranges.into_iter().find(|range| is_over(*range)) {
            Some(range) if step < 0 => {
                if self.count == 0 {
                    self.first = self.samples - 1;
                }
                self.count += 1;
                self.range = range;
            }
            // A sample from before the wrap, out of order.
            Some(_) if self.count > 0 => self.count -= 1,
            _ if step > 0 => self.step = step,
            _ => {}
        }
        self.previous = Some(shown);
        self.samples += 1;
        shown.saturating_add(self.count.saturating_mul(self.range))
    }

    /// Returns a note for the user, if the clock wrapped around.
    pub fn note(&self) -> Option<String> {
        let Self { count, first, .. } = self;
        (*count > 0).then(|| {
            format!(
                "the clock of 32 bits runs over {count} times, first after sample {first}; times go on behind it"
            )
        })
    }
}

/// A source of samples whose times continue to rise when the recorder's clock wraps around.
pub(super) struct Unwrapped {
    source: Box<dyn Source>,
    rollover: Rollover,
    notes: Vec<Words>,
}

impl Unwrapped {
    pub(super) fn new(source: Box<dyn Source>) -> Self {
        let notes = source.notes().to_vec();
        Self { source, rollover: Rollover::default(), notes }
    }
}

impl Source for Unwrapped {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        self.source.next(chunk)?;
        for time in &mut chunk.times {
            *time = self.rollover.take(*time);
        }
        self.notes = {
            let own = self.rollover.note().map(Words::from);
            self.source.notes().iter().cloned().chain(own).collect()
        };
        Ok(())
    }

    fn names(&self) -> Vec<&str> {
        self.source.names()
    }

    fn units(&self) -> Vec<Option<String>> {
        self.source.units()
    }

    fn origin(&self) -> &[(&'static str, String)] {
        self.source.origin()
    }

    fn notes(&self) -> &[Words] {
        &self.notes
    }
}

#[cfg(test)]
mod tests {
    use super::Rollover;

    fn unwrapped(times: impl Iterator<Item = i64>, shown: fn(i64) -> i64) -> Rollover {
        let mut rollover = Rollover::default();
        let mut first = None;
        for time in times {
            let taken = rollover.take(shown(time));
            let first = *first.get_or_insert(taken - time);
            assert_eq!(taken - time, first, "at {time}");
        }
        rollover
    }

    #[test]
    fn clocks_of_32_bits_go_on() {
        let three = 3 * (1_i64 << 32) / 5000;
        let hours = || (0..three).map(|sample| sample * 5000 + 17);
        assert_eq!(unwrapped(hours(), |time| time % (1 << 32)).count, 2);
        assert_eq!(unwrapped(hours(), |time| i64::from(time as i32)).count, 3);
        let days = (0..3_000_000).map(|sample| sample * 3_000_000);
        assert_eq!(unwrapped(days, |time| time % (1000 << 32)).count, 2);
    }

    #[test]
    fn a_sample_out_of_order_runs_over_once() {
        let mut rollover = Rollover::default();
        let end = 1 << 32;
        let shown = [end - 20, end - 10, 5, end - 2, 15, 25];
        let taken = shown.map(|time| rollover.take(time));
        assert_eq!(taken, [end - 20, end - 10, end + 5, end - 2, end + 15, end + 25]);
    }

    #[test]
    fn a_clock_of_ms_never_steps_back_by_a_range_of_us() {
        let (short, long) = (1 << 32, 1000 << 32);
        let mut rollover = Rollover::default();
        let shown = [long - 10, 5, short + 1, 10, short + 2, 10];
        let taken = shown.map(|time| rollover.take(time));
        assert_eq!(taken, shown.map(|time| if time == long - 10 { time } else { long + time }));
    }

    #[test]
    fn a_reboot_is_no_rollover() {
        for shown in [[4_000_000_000, 4_000_005_000, 0], [1 << 40, (1 << 40) + 5000, 5]] {
            let mut rollover = Rollover::default();
            assert_eq!(shown.map(|time| rollover.take(time)), shown);
            assert_eq!(rollover.note(), None);
        }
    }
}
