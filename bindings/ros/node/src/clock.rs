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
}

impl Clock {
    pub(crate) fn new(gap: f64) -> Self {
        Self { gap, steps: VecDeque::new(), last: None }
    }

    /// Takes the next stamp and counts what is wrong with the step to it.
    pub(crate) fn observe(&mut self, stamp: i64, counters: &mut Counters) {
        let Some(last) = self.last.replace(stamp) else { return };
        let seconds = |nanoseconds: i64| nanoseconds as f64 / 1e9;
        let step = stamp - last;
        if step < 0 {
            return counters.add("steps back in time", 1, &format!("{:.6} s", seconds(-step)));
        }
        if step == 0 {
            return counters.add("repeated stamps", 1, &format!("{:.6} s", seconds(stamp)));
        }
        let usual = self.usual();
        self.steps.truncate(STEPS - 1);
        self.steps.push_front(step);
        if let Some(usual) = usual.filter(|usual| step as f64 > self.gap * *usual as f64) {
            let detail = format!("{:.6} s, usually {:.6} s", seconds(step), seconds(usual));
            counters.add("gaps", 1, &detail);
        }
    }

    fn usual(&self) -> Option<i64> {
        let mut sorted: Vec<i64> = self.steps.iter().copied().collect();
        sorted.sort_unstable();
        (sorted.len() >= 3).then(|| sorted[sorted.len() / 2])
    }
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
