//! The times of samples, from those of some of them.

use std::collections::VecDeque;

/// Times of samples in order, those not known evenly spaced between those that are.
pub struct Timeline {
    /// The usual step from sample to sample, in µs.
    step: f64,
    before: Option<(u64, i64)>,
    ahead: VecDeque<(u64, i64)>,
}

impl Timeline {
    /// A timeline that knows no time yet. Before the first and after the last known one, samples come at this rate.
    pub fn new(rate: Option<f64>) -> Self {
        Self { step: rate.map_or(0.0, |rate| 1e6 / rate), before: None, ahead: VecDeque::new() }
    }

    /// Takes the time of a sample. They come in order.
    pub fn learn(&mut self, sample: u64, time: i64) {
        if self.ahead.back().is_none_or(|&(last, _)| last < sample) {
            self.ahead.push_back((sample, time));
        }
    }

    /// The number of times that are known and were not asked for yet.
    pub fn ahead(&self) -> usize {
        self.ahead.len()
    }

    /// The time of a sample. Samples must be asked for in order.
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
