//! Estimates the sample rate of a recording, and finds unusual steps in its times.

use std::fmt;

/// The kind of an unusual step from one sample's time to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A step forward in time that exceeds the allowed length. The allowed length is a multiple of the usual step.
    Gap,
    /// A step back in time. The sample is earlier than the sample before it, so the samples are out of order.
    Backward,
    /// A long step back in time. The recorder's clock must have restarted, for example after a reboot. A new segment of
    /// the recording begins.
    Restart,
}

/// An unusual step from one sample's time to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The kind of the step.
    pub kind: Kind,
    /// Index of the first of the two samples.
    pub after: u64,
    /// Time from the first to the second sample, in µs; negative for a step back.
    pub microseconds: i64,
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} ms after sample {}", self.microseconds as f64 / 1e3, self.after)
    }
}

/// A change of the sample rate.
#[derive(Clone, Debug)]
struct Jump {
    /// New rate, in samples a second.
    rate: f64,
    /// Index of the first sample at the new rate.
    from: u64,
}

impl fmt::Display for Jump {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} Hz from about sample {}", self.rate, self.from)
    }
}

/// Watches the times of a recording for gaps, steps back, restarts and changes of rate.
#[derive(Clone, Debug)]
pub struct Clock {
    usual_step: f64,
    longest_step: f64,
    /// Longest step back, in µs, that is taken for samples out of order. A longer step back is taken for a restart of
    /// the recorder's clock.
    longest_back: f64,
    /// Mean number of samples that share a time. Above 1 if samples come in batches, otherwise 1.
    samples_a_step: f64,
    previous: Option<i64>,
    seen: u64,
    gaps: Listed<Step>,
    backward: Listed<Step>,
    restarts: Listed<Step>,
    repeated: u64,
    /// The earliest and the latest time of the current segment, in µs.
    span: Option<(i64, i64)>,
    /// Total length of the segments before the current one, in µs.
    before: i64,
    /// The times of the latest samples in µs, at most [`RUN`] + 1 times.
    run: Vec<i64>,
    /// Time between samples in µs, measured when the sample rate last changed.
    run_step: f64,
    jumps: Listed<Jump>,
    is_timed: bool,
}

/// Number of consecutive steps over which the sample rate is measured.
const RUN: usize = 64;
/// Longest step back that still counts as samples out of order, as a multiple of the usual step. A longer step back
/// counts as a restart of the recorder's clock.
const RESTART: f64 = 10.0;
/// Factor by which the sample rate must rise or fall before the change is reported.
const JUMP: f64 = 1.5;

/// The findings of one kind, such as gaps: the number of findings, and the first few findings.
#[derive(Clone, Debug)]
struct Listed<T> {
    count: u64,
    first: Vec<T>,
}

impl<T> Default for Listed<T> {
    fn default() -> Self {
        Self { count: 0, first: Vec::new() }
    }
}

impl Clock {
    /// Makes a clock. The usual step between the times of two samples is measured in `first_times`. If it cannot be
    /// measured, it is computed from `rate`, in samples a second. A step longer than `steps` times the usual step
    /// counts as a gap.
    pub fn new(first_times: &[i64], rate: Option<f64>, steps: f64) -> Self {
        let are_sorted = !is_disordered(first_times);
        let usual = if are_sorted {
            usual_step(first_times)
        } else {
            let mut sorted = first_times.to_vec();
            sorted.sort_unstable();
            usual_step(&sorted)
        };
        let (usual_step, samples_a_step) =
            usual.or_else(|| Some((1e6 / rate?, 1.0))).unwrap_or((f64::NAN, 1.0));
        Self {
            usual_step,
            longest_step: usual_step * steps,
            longest_back: if are_sorted { usual_step * RESTART } else { f64::INFINITY },
            samples_a_step,
            previous: None,
            seen: 0,
            gaps: Listed::default(),
            backward: Listed::default(),
            restarts: Listed::default(),
            repeated: 0,
            span: None,
            before: 0,
            run: Vec::with_capacity(RUN + 1),
            run_step: usual_step / samples_a_step,
            jumps: Listed::default(),
            is_timed: !first_times.is_empty(),
        }
    }

    /// Returns the sample rate in Hz, if it is known.
    pub fn rate(&self) -> Option<f64> {
        (self.usual_step > 0.0).then(|| 1e6 / self.usual_step * self.samples_a_step)
    }

    /// Returns the total length of all segments in seconds, without the unknown time between segments.
    pub fn seconds(&self) -> f64 {
        self.before.saturating_add(self.segment()) as f64 * 1e-6
    }

    /// Returns the usual time between samples in µs, or 0 if it is unknown.
    pub fn period(&self) -> i64 {
        (self.usual_step / self.samples_a_step).round() as i64
    }

    /// Returns the number of gaps.
    pub fn gaps(&self) -> u64 {
        self.gaps.count
    }

    /// Returns the number of samples whose time is earlier than the time of the preceding sample. Restarts of the clock
    /// are not counted.
    pub fn steps_back(&self) -> u64 {
        self.backward.count
    }

    /// Returns the number of times that the clock restarted.
    pub fn restarts(&self) -> u64 {
        self.restarts.count
    }

    fn segment(&self) -> i64 {
        self.span.map_or(0, |(first, last)| last.saturating_sub(first))
    }

    /// Adds the times of the next samples, in µs. Returns the unusual steps from one time to the next.
    pub fn observe(&mut self, times: &[i64]) -> Vec<Step> {
        let mut steps = Vec::new();
        for &time in times {
            if let Some(previous) = self.previous {
                let microseconds = time.saturating_sub(previous);
                let kind = match microseconds {
                    0 => {
                        self.repeated += 1;
                        None
                    }
                    ..0 if -(microseconds as f64) > self.longest_back => Some(Kind::Restart),
                    ..0 => Some(Kind::Backward),
                    _ => (microseconds as f64 > self.longest_step).then_some(Kind::Gap),
                };
                if let Some(kind) = kind {
                    let step = Step { kind, after: self.seen - 1, microseconds };
                    let findings = match kind {
                        Kind::Gap => &mut self.gaps,
                        Kind::Backward => &mut self.backward,
                        Kind::Restart => &mut self.restarts,
                    };
                    findings.take(step);
                    steps.push(step);
                }
                if kind == Some(Kind::Restart) {
                    self.before = self.before.saturating_add(self.segment());
                    self.span = None;
                    self.run.clear();
                }
            }
            let (first, last) = self.span.unwrap_or((time, time));
            self.span = Some((first.min(time), last.max(time)));
            self.previous = Some(time);
            self.seen += 1;
            self.run.push(time);
            if self.run.len() > RUN {
                self.end_run();
                self.run.clear();
                self.run.push(time);
            }
        }
        steps
    }

    /// Measures the sample rate over the latest [`RUN`] steps. Records a change of rate only if both the median and the
    /// mean of these steps have changed. A gap changes only the mean. Steps that alternate between two lengths change
    /// only the median. Neither is a change of rate.
    fn end_run(&mut self) {
        let (Some((median, samples)), [first, .., last]) = (usual_step(&self.run), &*self.run)
        else {
            return;
        };
        // Samples come in batches so long that a run holds too few of them.
        if samples > 8.0 {
            return;
        }
        let step = median / samples;
        let mean = last.saturating_sub(*first) as f64 / RUN as f64;
        let is_longer = step.min(mean) > self.run_step * JUMP;
        let is_shorter = step.max(mean) < self.run_step / JUMP && mean > 0.0;
        if is_longer || is_shorter {
            self.jumps.take(Jump { rate: 1e6 / step, from: self.seen - 1 - RUN as u64 });
            self.run_step = step;
        }
    }
}

impl<T> Listed<T> {
    fn take(&mut self, step: T) {
        const LISTED: usize = 5;
        self.count += 1;
        if self.first.len() < LISTED {
            self.first.push(step);
        }
    }
}

impl<T: fmt::Display> fmt::Display for Listed<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, step) in self.first.iter().enumerate() {
            let before = if place == 0 { ": " } else { ", " };
            write!(f, "{before}{step}")?;
        }
        let more = self.count - self.first.len() as u64;
        if more > 0 { write!(f, ", and {more} more") } else { Ok(()) }
    }
}

/// Writes the findings for the user: gaps, changes of the sample rate, restarts, steps back and repeated times.
impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_timed {
            return write!(f, "no times are recorded, so gaps cannot be seen");
        }
        if self.usual_step > 0.0 {
            let (usual, longest) = (self.usual_step / 1e3, self.longest_step / 1e3);
            let (count, gaps) = (self.gaps.count, &self.gaps);
            write!(f, "{count} gaps above {longest:.3} ms where {usual:.3} ms are usual{gaps}")?;
        } else {
            write!(f, "no time comes after the one before, so gaps cannot be seen")?;
        }
        if self.jumps.count > 0 {
            write!(f, "; the rate jumps {} times{}", self.jumps.count, self.jumps)?;
        }
        if self.restarts.count > 0 {
            let (count, restarts) = (self.restarts.count, &self.restarts);
            write!(
                f,
                "; the clock starts anew {count} times, each a segment of its own{restarts}"
            )?;
        }
        if self.backward.count > 0 {
            write!(f, "; {} steps back in time{}", self.backward.count, self.backward)?;
        }
        if self.repeated > 0 {
            write!(f, "; {} times equal the one before, in whole µs", self.repeated)?;
        }
        Ok(())
    }
}

/// Returns whether the times are out of order: more than two steps from one time to the next go back, and the steps
/// back are more than a tenth of all steps that are not 0.
fn is_disordered(times: &[i64]) -> bool {
    const FEW: usize = 2;
    let steps = |is: fn(&[i64]) -> bool| times.windows(2).filter(|pair| is(pair)).count();
    let back = steps(|pair| pair[1] < pair[0]);
    back > FEW && back * 10 > steps(|pair| pair[1] != pair[0])
}

/// Returns the usual step in µs, and the mean number of samples in a batch. A batch is a run of samples with equal
/// times. The usual step is the median of the steps forward. The mean is the number of all steps, divided by the number
/// of steps forward. If the quotient is below 2, the samples do not come in batches, and the mean is returned as 1.
///
/// Returns `None` if no step goes forward, or if samples come in batches and fewer than three steps go forward.
fn usual_step(times: &[i64]) -> Option<(f64, f64)> {
    const FEWEST: usize = 3;
    let steps = times.windows(2).map(|pair| pair[1].saturating_sub(pair[0]));
    let mut forward: Vec<i64> = steps.filter(|&step| step > 0).collect();
    forward.sort_unstable();
    let usual = *forward.get(forward.len() / 2)? as f64;
    let samples = (times.len() - 1) as f64 / forward.len() as f64;
    if samples >= 2.0 && forward.len() < FEWEST {
        return None;
    }
    Some((usual, if samples >= 2.0 { samples } else { 1.0 }))
}

#[cfg(test)]
mod tests {
    use super::{Clock, Kind};

    #[test]
    fn messages_out_of_order_have_a_rate_and_a_length() {
        let mut times: Vec<i64> = (0..160).rev().map(|sample| sample * 6250).collect();
        times[80] = times[79] + 1;
        let mut clock = Clock::new(&times, None, 1.5);
        let steps = clock.observe(&times);
        assert!(steps.iter().all(|step| step.kind == Kind::Backward) && steps.len() == 158);
        assert_eq!(clock.rate(), Some(160.0));
        assert!((clock.seconds() - 0.99375).abs() < 1e-9);
        // If all times but one are equal, the rate is unknown.
        let mut same = vec![7; 160];
        same[159] = 8;
        assert_eq!(Clock::new(&same, None, 1.5).rate(), None);
    }

    #[test]
    fn times_of_batches_are_no_gaps() {
        for (batch, within) in [(4, 0.005), (100, 0.12)] {
            let times: Vec<i64> = (0..1000).map(|sample| sample / batch * 5000 * batch).collect();
            let mut clock = Clock::new(&times, None, 1.5);
            assert_eq!(clock.observe(&times), []);
            let rate = clock.rate().unwrap();
            assert!((rate / 200.0 - 1.0).abs() < within, "{rate}");
            assert!(!clock.to_string().contains("jumps"), "{clock}");
        }
    }

    #[test]
    fn rates_that_jump_for_a_while_are_reported() {
        let jumps_of = |steps: &[(usize, i64)]| {
            let steps = steps.iter().flat_map(|&(count, step)| std::iter::repeat_n(step, count));
            let mut time = 0;
            let times: Vec<i64> = steps
                .map(|step| {
                    time += step;
                    time
                })
                .collect();
            let mut clock = Clock::new(&times, None, 1.5);
            clock.observe(&times);
            clock.to_string().split_once("; ").map(|(_, jumps)| jumps.to_owned())
        };
        let jumps = "the rate jumps 2 times: 2000.00 Hz from about sample 320, 1000.00 Hz from about sample 512";
        assert_eq!(jumps_of(&[(321, 1000), (200, 500), (300, 1000)]).as_deref(), Some(jumps));
        let slower = "the rate jumps 1 times: 400.00 Hz from about sample 640";
        assert_eq!(jumps_of(&[(640, 1000), (100, 2500)]).as_deref(), Some(slower));
        // Without a jump: a change that is too short, a change that is too small, and a gap.
        for steady in
            [[(500, 1000), (20, 500)], [(500, 1000), (200, 1400)], [(500, 1000), (1, 1_000_000)]]
        {
            assert_eq!(jumps_of(&[steady[0], steady[1], (300, 1000)]), None, "{steady:?}");
        }
    }
}
