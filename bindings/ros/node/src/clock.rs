//! Steps back, repeats and gaps in the stamps of samples.

use crate::counters::Counters;
use std::collections::VecDeque;

/// How many steps the usual one is the median of.
const STEPS: usize = 31;

/// Watches stamps, in nanoseconds.
pub(crate) struct Clock {
    /// A step above so many usual ones is a gap.
    gap: f64,
    steps: VecDeque<i64>,
    last: Option<i64>,
    /// A long step, and by how much the last sample is still late after it.
    late: Option<(i64, i64)>,
}

impl Clock {
    pub(crate) fn new(gap: f64) -> Self {
        Self { gap, steps: VecDeque::new(), last: None, late: None }
    }

    /// Takes the next stamp and counts what is wrong with the step to it.
    ///
    /// A long step is a gap unless short ones make up for it: then its sample only came late. So it is counted with a
    /// later sample.
    pub(crate) fn observe(&mut self, stamp: i64, counters: &mut Counters) {
        let Some(last) = self.last.replace(stamp) else { return };
        let step = stamp - last;
        if step < 0 {
            counters.add("steps back in time", 1, &format!("{:.6} s", seconds(-step)));
        } else if step == 0 {
            counters.add("repeated stamps", 1, &format!("{:.6} s", seconds(stamp)));
        }
        let usual = self.usual();
        if step > 0 {
            self.steps.truncate(STEPS - 1);
            self.steps.push_front(step);
        }
        let Some(usual) = usual else { return };
        let is_late = |late: i64| late as f64 > (self.gap - 1.0) * usual as f64;
        let own = step - usual;
        match self.late.take() {
            Some((_, late)) if !is_late(late + own) => return,
            Some((long, late)) if step >= 0 && 4 * step < 3 * usual => {
                self.late = Some((long, late + own));
                return;
            }
            Some((long, _)) => {
                let detail = format!("{:.6} s, usually {:.6} s", seconds(long), seconds(usual));
                counters.add("gaps", 1, &detail);
            }
            None => {}
        }
        self.late = is_late(own).then_some((step, own));
    }

    fn usual(&self) -> Option<i64> {
        let mut sorted: Vec<i64> = self.steps.iter().copied().collect();
        sorted.sort_unstable();
        (sorted.len() >= 3).then(|| sorted[sorted.len() / 2])
    }
}

fn seconds(nanoseconds: i64) -> f64 {
    nanoseconds as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::Clock;
    use crate::counters::Counters;

    #[test]
    fn steps() {
        let (mut clock, mut counters) = (Clock::new(1.5), Counters::default());
        for stamp in [0, 10, 20, 30, 40, 60, 70, 65, 75, 75, 85] {
            clock.observe(stamp * 1000, &mut counters);
        }
        assert_eq!(counters.to_string(), "1 gaps, 1 repeated stamps, 1 steps back in time");
    }

    #[test]
    fn samples_that_come_late_are_no_gap() {
        let (mut clock, mut counters) = (Clock::new(1.5), Counters::default());
        // One that is late alone, and four that wait for each other.
        for stamp in [0, 10, 20, 30, 40, 58, 60, 70, 80, 117, 118, 119, 120, 130] {
            clock.observe(stamp * 1000, &mut counters);
        }
        assert!(counters.counts().is_empty(), "{counters}");
        // One that is late and three that are lost.
        for stamp in [178, 180, 190] {
            clock.observe(stamp * 1000, &mut counters);
        }
        assert_eq!(counters.to_string(), "1 gaps");
    }

    #[test]
    fn a_rate_that_changes_is_told_until_it_is_usual() {
        let (mut clock, mut counters) = (Clock::new(1.5), Counters::default());
        let mut stamp = 0;
        for step in [1000; 40].into_iter().chain([2000; 40]) {
            stamp += step;
            clock.observe(stamp, &mut counters);
        }
        assert!((1..=17).contains(&counters.counts()["gaps"]), "{counters}");
    }
}
