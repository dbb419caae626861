//! Estimates the sample rate of a recording, and finds unusual steps in its times.

use super::TableKind;
use crate::{Error, Result};
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

/// Two rates of one recording that contradict each other by a fifth or more. The times are those at which samples
/// arrived, in bursts or with much jitter, and not those at which the sensor took the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnevenRate {
    /// Number of samples through the length of the recording without gaps, in Hz.
    pub through_length: f64,
    /// Rate in Hz that the median step from one time to the next would give.
    pub by_median: f64,
}

impl fmt::Display for UnevenRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { through_length, by_median } = self;
        write!(
            f,
            "{through_length:.2} Hz by samples through length, {by_median:.2} Hz by the median step"
        )
    }
}

impl From<UnevenRate> for Error {
    fn from(uneven: UnevenRate) -> Self {
        TableKind::UnevenRate { uneven }.into()
    }
}

/// Watches the times of a recording for gaps, steps back, restarts and changes of rate.
#[derive(Clone, Debug)]
pub struct Clock {
    /// Rate in Hz that the user gave.
    given_rate: Option<f64>,
    /// Rate through the length of the first times, in Hz. It is used until further times are observed.
    first_rate: Option<f64>,
    /// Median step in µs from one time to the next that is later.
    usual_step: f64,
    /// Unit of the times in µs: all steps between the first times are multiples of it.
    resolution: f64,
    longest_step: f64,
    /// A step longer than this, in µs, ends a burst of samples. It is 0 if samples do not come in bursts.
    burst_step: f64,
    passage: Passage,
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

/// Factor by which the rate through the length and the rate by the median step may differ.
const EVEN: f64 = 1.2;
/// Above this share of all steps, gaps are not what is missing from a recording but how it is stamped, and their time
/// counts. So few samples that they have no more than [`FEW`] gaps show nothing.
const RARE: f64 = 0.05;
const FEW: u64 = 8;

/// Number of steps, and the time in µs that they took.
#[derive(Clone, Copy, Debug, Default)]
struct Passage {
    /// Steps and time from the start of the present run of samples to its latest burst. A run ends at a gap and at a
    /// restart. Only whole bursts count: their samples belong to the whole time until the next burst.
    whole: Count,
    /// Steps and time from the start of the present run to the latest sample.
    run: Count,
    /// Steps and time of the runs before the present one.
    before: Count,
    /// Number of gaps, and their length.
    gaps: Count,
}

#[derive(Clone, Copy, Debug, Default)]
struct Count {
    steps: u64,
    time: i64,
}

impl Count {
    fn plus(self, other: Self) -> Self {
        Self { steps: self.steps + other.steps, time: self.time.saturating_add(other.time) }
    }

    /// Returns the number of steps a second.
    fn rate(self) -> Option<f64> {
        (self.time > 0 && self.steps > 0).then(|| self.steps as f64 * 1e6 / self.time as f64)
    }
}

impl Passage {
    fn end_run(&mut self) {
        self.before = self.before.plus(self.whole);
        (self.run, self.whole) = (Count::default(), Count::default());
    }

    fn count(&self) -> Count {
        let count = self.before.plus(self.whole);
        let most = RARE * (count.steps + self.gaps.steps) as f64;
        let is_usual = self.gaps.steps > FEW && self.gaps.steps as f64 > most;
        if is_usual { count.plus(self.gaps) } else { count }
    }
}

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
    /// counts as a gap. If samples come in bursts, the usual step between bursts takes the place of the usual step.
    ///
    /// `rate` is the rate that the user gave: it stands in place of the rate that the times show.
    pub fn new(first_times: &[i64], rate: Option<f64>, steps: f64) -> Self {
        let are_sorted = !is_disordered(first_times);
        let mut sorted = first_times.to_vec();
        if !are_sorted {
            sorted.sort_unstable();
        }
        let (usual_step, samples_a_step) =
            usual_step(&sorted).or_else(|| Some((1e6 / rate?, 1.0))).unwrap_or((f64::NAN, 1.0));
        let burst = burst(&sorted, usual_step / samples_a_step);
        let mut clock = Self {
            given_rate: rate,
            first_rate: None,
            usual_step,
            resolution: resolution(&sorted),
            longest_step: burst.map_or(usual_step, |burst| burst.longest) * steps,
            burst_step: burst.map_or(0.0, |burst| burst.mean),
            passage: Passage::default(),
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
        };
        let mut first = clock.clone();
        first.observe(first_times);
        clock.first_rate = first.passage.count().rate();
        clock
    }

    /// Returns the sample rate in Hz, if it is known: the rate that the user gave or, without it, the number of samples
    /// through the length of the recording without gaps. As long as no times are observed, it is that of the first
    /// times.
    pub fn rate(&self) -> Option<f64> {
        self.given_rate.or_else(|| self.measured())
    }

    fn measured(&self) -> Option<f64> {
        // Samples that come in so few batches that no usual step is known have no rate either.
        let count = self.passage.count();
        (self.usual_step > 0.0).then(|| count.rate().or(self.first_rate)).flatten()
    }

    /// Returns the rate through the length and the rate by the median step, if they differ by a fifth or more and the
    /// user gave no rate. A clock too coarse for the rate, such as one of whole milliseconds at 400 Hz, makes no
    /// difference.
    pub fn uneven(&self) -> Option<UnevenRate> {
        if self.given_rate.is_some() || !self.is_timed {
            return None;
        }
        let through_length = self.measured()?;
        let step = self.usual_step / self.samples_a_step;
        let by_median = 1e6 / step;
        let is_coarse = (1e6 / through_length - step).abs() < self.resolution;
        let is_other = is_other_rate(by_median, through_length);
        (is_other && !is_coarse).then_some(UnevenRate { through_length, by_median })
    }

    /// Returns the sample rate in Hz, if it is known, for what must rely on it: a period that is written, or advice.
    ///
    /// # Errors
    /// Returns an error that asks for the rate if the times contradict themselves (see [`uneven`](Self::uneven)).
    pub fn steady_rate(&self) -> Result<Option<f64>> {
        match self.uneven() {
            Some(uneven) => Err(uneven.into()),
            None => Ok(self.rate()),
        }
    }

    /// Returns the total length of all segments in seconds, without the unknown time between segments.
    pub fn seconds(&self) -> f64 {
        self.before.saturating_add(self.segment()) as f64 * 1e-6
    }

    /// Returns the time between samples in µs at the [`rate`](Self::rate), or 0 if it is unknown.
    pub fn period(&self) -> i64 {
        self.rate().map_or(0, |rate| (1e6 / rate).round() as i64)
    }

    /// Returns the longest step in µs that is no gap, or NaN if no usual step is known.
    pub(crate) fn longest_step(&self) -> f64 {
        self.longest_step
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
                self.pass(time, kind);
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

    /// Counts the step to `time`. The step lasts as long as the span of the segment's times grows by it, at either end,
    /// so that samples out of order count but take no time of their own.
    fn pass(&mut self, time: i64, kind: Option<Kind>) {
        let Some((first, last)) = self.span.filter(|_| kind != Some(Kind::Restart)) else {
            self.passage.end_run();
            return;
        };
        let growth = time.saturating_sub(last).max(first.saturating_sub(time)).max(0);
        let step = Count { steps: 1, time: growth };
        // Times that are out of order grow their span unevenly.
        if growth as f64 > self.longest_step && self.longest_back.is_finite() {
            self.passage.gaps = self.passage.gaps.plus(step);
            self.passage.end_run();
            return;
        }
        self.passage.run = self.passage.run.plus(step);
        if growth as f64 > self.burst_step {
            self.passage.whole = self.passage.run;
        }
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
        if let Some(uneven) = self.uneven() {
            write!(f, "; the rate is uncertain: {uneven}")?;
        }
        if let (Some(given), Some(measured)) = (self.given_rate, self.measured())
            && is_other_rate(given, measured)
        {
            write!(
                f,
                "; the rate that is given, {given:.2} Hz, is not that of samples through length, {measured:.2} Hz"
            )?;
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

/// Returns whether two rates differ by a fifth or more.
pub(crate) fn is_other_rate(rate: f64, other: f64) -> bool {
    !(1.0 / EVEN..EVEN).contains(&(rate / other))
}

/// A burst of samples whose times follow each other more closely than the samples were taken.
#[derive(Clone, Copy, Debug)]
struct Burst {
    /// Mean step between times, in µs.
    mean: f64,
    /// Usual longest step between times, in µs: that from one burst to the next.
    longest: f64,
}

/// Returns the mean step between sorted times in µs, taken over as many samples as a long burst has. It is the median of
/// such means, so that a few gaps do not count.
fn mean_step(times: &[i64]) -> Option<f64> {
    /// A longest burst, such as a sensor's queue that is read 50 times a second at 8 kHz, has fewer samples.
    const WINDOW: usize = 256;
    let window = (times.len() / 8).clamp(1, WINDOW);
    let pairs = times.iter().zip(times.get(window..)?);
    let mut means: Vec<i64> = pairs.map(|(first, last)| last.saturating_sub(*first)).collect();
    means.sort_unstable();
    Some(*means.get(means.len() / 2)? as f64 / window as f64)
}

/// Returns whether the sensor's own stamps are to be preferred to the times at which its samples arrived, both in µs:
/// they go forward at least as often, never go back, and show the same mean step within a factor of 2, unless the times
/// of arrival do not go forward at all.
pub(super) fn prefers_stamps(stamps: &[i64], arrivals: &[i64]) -> bool {
    const ALIKE: std::ops::RangeInclusive<f64> = 0.5..=2.0;
    let forward = |times: &[i64]| times.windows(2).filter(|pair| pair[0] < pair[1]).count();
    if stamps.len() != arrivals.len() || !stamps.is_sorted() || forward(stamps) < forward(arrivals)
    {
        return false;
    }
    match (mean_step(stamps), mean_step(arrivals)) {
        (Some(own), Some(arrival)) => {
            own > 0.0 && (arrival == 0.0 || ALIKE.contains(&(own / arrival)))
        }
        _ => false,
    }
}

/// Finds bursts in sorted times whose median step is `usual`. Returns `None` if the mean step is that of the median
/// within a fifth.
fn burst(times: &[i64], usual: f64) -> Option<Burst> {
    let mean = mean_step(times)?;
    if mean <= 0.0 || !is_other_rate(mean, usual) || usual.is_nan() {
        return None;
    }
    let mut steps: Vec<i64> =
        times.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
    steps.sort_unstable();
    let above = steps.partition_point(|step| *step as f64 <= mean);
    let between = *steps.get(above + (steps.len() - above) / 2)?;
    // Steps at random have no length that is usual between bursts; of them, one in twenty is longer than this one.
    let long = *steps.get(steps.len() * 19 / 20)?;
    Some(Burst { mean, longest: between.max(long) as f64 })
}

/// Returns the greatest common divisor of the steps between times, in µs, and 0 if there is none.
fn resolution(times: &[i64]) -> f64 {
    let mut common = 0_u64;
    for pair in times.windows(2) {
        let mut step = pair[0].abs_diff(pair[1]);
        while step > 0 {
            (common, step) = (step, common % step);
        }
    }
    common as f64
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
    use super::{Clock, Kind, prefers_stamps};

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
    fn the_rate_is_samples_through_length_without_gaps() {
        let clock_of = |times: &[i64]| {
            let mut clock = Clock::new(times, None, 1.5);
            clock.observe(times);
            clock
        };
        let is_near = |clock: &Clock, rate: f64| (clock.rate().unwrap() / rate - 1.0).abs() < 0.002;
        // Packets of 8 samples, stamped on arrival.
        let packets: Vec<i64> = (0..16_000).map(|at| at / 8 * 10_000 + at % 8 * 50).collect();
        let clock = clock_of(&packets);
        let uneven = clock.uneven().unwrap();
        assert!(is_near(&clock, 800.0) && clock.gaps() == 0, "{clock}");
        assert_eq!((uneven.by_median.round(), clock.period()), (20_000.0, 1250));
        assert!(clock.steady_rate().is_err());
        let mut given = Clock::new(&packets, Some(800.0), 1.5);
        given.observe(&packets);
        assert_eq!((given.uneven(), given.steady_rate().unwrap()), (None, Some(800.0)));
        // A packet that is lost is a gap, and takes no part.
        let lost: Vec<i64> =
            packets.iter().map(|time| time + if *time > 5_000_000 { 400_000 } else { 0 }).collect();
        let clock = clock_of(&lost);
        assert!(is_near(&clock, 800.0) && clock.gaps() == 1, "{clock}");
        // Evenly stamped, with two gaps.
        let gaps: Vec<i64> = (0..3000).map(|at| at * 5000 + at / 1000 * 700_000).collect();
        let clock = clock_of(&gaps);
        assert_eq!((clock.rate(), clock.gaps(), clock.uneven()), (Some(200.0), 2, None));
        // Whole milliseconds at 400 Hz: the median step is 2 or 3 ms.
        let coarse: Vec<i64> = (0..4000).map(|at| at * 5 / 2 * 1000).collect();
        let clock = clock_of(&coarse);
        assert!(is_near(&clock, 400.0) && clock.uneven().is_none(), "{clock}");
        // A rate that falls to less than half for good: most steps would be gaps.
        let slower: Vec<i64> =
            (0..20_000).map(|at| at * 1000 + (at - 9000).max(0) * 1500).collect();
        let clock = clock_of(&slower);
        assert!(clock.uneven().is_some() && clock.rate().unwrap() < 600.0, "{clock}");
        // Steps at random, as of packets on a busy line: one in some hundred is a gap.
        let mut state = 1_u32;
        let mut time = 0;
        let mut at_random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            time += (-(f64::from(state >> 8) + 0.5).ln() + 24.0 * 2_f64.ln()) as i64 * 1000;
            time
        };
        let random: Vec<i64> = (0..20_000).map(|_| at_random()).collect();
        let mean = (random[19_999] - random[0]) as f64 / 19_999.0;
        let rate = clock_of(&random).rate().unwrap();
        assert!((rate * mean / 1e6 - 1.0).abs() < 0.15, "{rate} of {}", 1e6 / mean);
    }

    #[test]
    fn stamps_are_preferred_to_arrivals_if_they_are_times() {
        let stamps: Vec<i64> = (0..400).map(|at| at * 4000).collect();
        let arrivals: Vec<i64> = (0..400).map(|at| at / 8 * 32_000 + 5000).collect();
        assert!(prefers_stamps(&stamps, &arrivals) && prefers_stamps(&stamps, &[0; 400]));
        let backward: Vec<i64> = stamps.iter().rev().copied().collect();
        let other: Vec<i64> = stamps.iter().map(|time| time * 1000).collect();
        for odd in [&[0; 400][..], &backward, &other, &stamps[1..]] {
            assert!(!prefers_stamps(odd, &arrivals), "{odd:?}");
        }
        // Coarser than the times of arrival.
        let coarse: Vec<i64> = stamps.iter().map(|time| time / 20_000 * 20_000).collect();
        assert!(!prefers_stamps(&coarse, &stamps));
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
