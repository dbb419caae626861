//! The rate of a recording, and the gaps in it.

use std::fmt;

/// A step in time that is too long, or does not go forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Gap {
    /// The sample before it.
    pub after: u64,
    /// How long it is, in µs.
    pub microseconds: i64,
}

/// Watches the times of a recording.
#[derive(Debug)]
pub(crate) struct Clock {
    usual_step: f64,
    longest_step: f64,
    previous: Option<i64>,
    seen: u64,
    count: u64,
    first: Vec<Gap>,
    is_timed: bool,
}

impl Clock {
    /// A clock that takes the usual step from the first times, or else from a given rate.
    pub(crate) fn new(first_times: &[i64], rate: Option<f64>, steps: f64) -> Self {
        let usual_step = median_step(first_times).or_else(|| Some(1e6 / rate?)).unwrap_or(f64::NAN);
        Self {
            usual_step,
            longest_step: usual_step * steps,
            previous: None,
            seen: 0,
            count: 0,
            first: Vec::new(),
            is_timed: !first_times.is_empty(),
        }
    }

    /// Samples a second, if anything is known of it.
    pub(crate) fn rate(&self) -> Option<f64> {
        (self.usual_step > 0.0).then(|| 1e6 / self.usual_step)
    }

    /// Takes the next times and gives the gaps among them.
    pub(crate) fn observe(&mut self, times: &[i64]) -> Vec<Gap> {
        const TOLD: usize = 5;
        let mut gaps = Vec::new();
        for &time in times {
            if let Some(previous) = self.previous {
                let microseconds = time - previous;
                if microseconds <= 0 || microseconds as f64 > self.longest_step {
                    gaps.push(Gap { after: self.seen - 1, microseconds });
                }
            }
            self.previous = Some(time);
            self.seen += 1;
        }
        self.count += gaps.len() as u64;
        let left = TOLD.saturating_sub(self.first.len());
        self.first.extend(gaps.iter().take(left));
        gaps
    }
}

/// What there is to report, or nothing.
impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_timed {
            return write!(f, "no times are recorded, so gaps cannot be seen");
        }
        let (usual, longest) = (self.usual_step / 1e3, self.longest_step / 1e3);
        write!(f, "{} gaps above {longest:.3} ms where {usual:.3} ms are usual", self.count)?;
        for (place, gap) in self.first.iter().enumerate() {
            let before = if place == 0 { ": " } else { ", " };
            write!(
                f,
                "{before}{:.3} ms after sample {}",
                gap.microseconds as f64 / 1e3,
                gap.after
            )?;
        }
        let more = self.count - self.first.len() as u64;
        if more > 0 { write!(f, ", and {more} more") } else { Ok(()) }
    }
}

fn median_step(times: &[i64]) -> Option<f64> {
    let mut steps: Vec<i64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).map(|&step| step as f64)
}

#[cfg(test)]
mod tests {
    use super::{Clock, Gap};

    #[test]
    fn long_and_backward_steps_are_gaps() {
        let times = [0, 10, 20, 30, 60, 70, 65, 75];
        let mut clock = Clock::new(&times, None, 1.5);
        let gaps = clock.observe(&times);
        assert_eq!(gaps, [Gap { after: 3, microseconds: 30 }, Gap { after: 5, microseconds: -5 }]);
        assert_eq!(clock.rate(), Some(1e5));
    }
}
