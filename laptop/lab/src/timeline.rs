//! Interpolates the unknown times of samples between known times.

use std::collections::VecDeque;

/// The times of consecutive samples. Unknown times are spaced evenly between known times.
pub struct Timeline {
    /// Usual time between samples, in µs.
    step: f64,
    before: Option<(u64, i64)>,
    ahead: VecDeque<(u64, i64)>,
}

impl Timeline {
    /// Makes a timeline without known times. `rate` is the usual sample rate, in samples a second. It gives the times
    /// of samples before the first known time and after the last. If `rate` is `None`, these samples get the nearest
    /// known time.
    pub fn new(rate: Option<f64>) -> Self {
        Self { step: rate.map_or(0.0, |rate| 1e6 / rate), before: None, ahead: VecDeque::new() }
    }

    /// Adds the known time of a sample, in µs; samples must be added in order.
    pub fn learn(&mut self, sample: u64, time: i64) {
        if self.ahead.back().is_none_or(|&(last, _)| last < sample) {
            self.ahead.push_back((sample, time));
        }
    }

    /// Counts the samples whose time is known and that come after the sample last passed to [`at`](Self::at).
    pub fn ahead(&self) -> usize {
        self.ahead.len()
    }

    /// Returns the time of a sample in µs. Calls must pass samples in rising order.
    pub fn at(&mut self, sample: u64) -> i64 {
        while let Some(&known) = self.ahead.front().filter(|(known, _)| *known <= sample) {
            self.before = Some(known);
            self.ahead.pop_front();
        }
        let steps = |from: u64, to: u64| to as f64 - from as f64;
        match (self.before, self.ahead.front()) {
            (Some((first, start)), Some(&(last, end))) => {
                let part = steps(first, sample) / steps(first, last);
                start.saturating_add((part * (end as f64 - start as f64)).round() as i64)
            }
            (Some((known, time)), None) | (None, Some(&(known, time))) => {
                time.saturating_add((steps(known, sample) * self.step).round() as i64)
            }
            (None, None) => (sample as f64 * self.step).round() as i64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Timeline;

    #[test]
    fn times_between_are_evenly_spaced() {
        let mut timeline = Timeline::new(Some(100_000.0));
        for (sample, time) in [(2, 100), (4, 140), (4, 140), (5, 120)] {
            timeline.learn(sample, time);
        }
        let times: Vec<i64> = (0..8).map(|sample| timeline.at(sample)).collect();
        assert_eq!(times, [80, 90, 100, 120, 140, 120, 130, 140]);
    }
}
