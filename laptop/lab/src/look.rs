//! Summarises a channel before it is encoded: rate, noise, bandwidth, range, and whether it is fit for tuning.

use crate::brief::short;
use crate::trial::Recording;
use crate::tune::figures::power;
use crate::unit::Inertial;
use serde::Serialize;
use std::f64::consts::PI;

/// A summary of a channel's samples.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelSummary {
    /// Name of the channel.
    pub name: String,
    /// Unit of the samples, if the log gives it or the name shows it.
    pub unit: Option<String>,
    /// Number of finite samples.
    pub samples: usize,
    /// Number of samples that were missing or not finite.
    pub rejected: usize,
    /// Length in seconds, if the times or the rate are known.
    pub seconds: Option<f64>,
    /// Sample rate in Hz, if known.
    pub rate: Option<f64>,
    /// Standard deviation of the time between samples, in ms. Gaps are left out.
    pub jitter_ms: Option<f64>,
    /// Number of gaps: steps in time longer than 1.5 times the usual step or, if samples arrive in bursts, than 1.5 times
    /// the usual step from burst to burst.
    pub gaps: usize,
    /// Smallest sample.
    pub min: f64,
    /// Largest sample.
    pub max: f64,
    /// Standard deviation of the samples.
    pub deviation: f64,
    /// Standard deviation of the noise, measured where the channel is quietest.
    pub noise: f64,
    /// Frequency in Hz below which 99 % of the power around the mean lies.
    pub bandwidth: Option<f64>,
    /// Percentage of samples that are clipped. A sample is clipped if it has the lowest or the highest value and
    /// belongs to a run of three or more equal samples.
    pub clipped: f64,
    /// Lowest and highest sample in the quiet windows, in which the drone is taken to rest. [`resting`](Self::resting)
    /// defines quiet windows. `None` if all windows are quiet, or if no window is quiet.
    pub rest: Option<[f64; 2]>,
    /// Lowest and highest sample outside the quiet windows, where the drone is taken to fly. [`resting`](Self::resting)
    /// defines quiet windows. `None` if all windows are quiet, or if no window is quiet.
    pub flight: Option<[f64; 2]>,
    /// Percentage of windows of 64 samples in which the channel is quiet. A window is quiet if its standard deviation
    /// is at most four times the fifth percentile of all windows' standard deviations.
    pub resting: f64,
    /// Fitness for tuning.
    pub verdict: Verdict,
}

/// A channel's fitness for tuning, or the reason that it is unfit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Fit for tuning.
    Good,
    /// Too few samples for tuning.
    TooShort,
    /// All samples are equal.
    Constant,
    /// The channel holds nothing but white noise. The drone never flew, or there is no signal at all.
    OnlyNoise,
    /// More than a fifth of the samples are missing.
    FullOfHoles,
    /// More than a fiftieth of the samples have the lowest or the highest value, in runs of three or more samples.
    Clipped,
}

/// Largest standard deviation of a turn rate at rest, in rad/s, and of an acceleration at rest, in m/s².
const AT_REST: [f64; 2] = [0.01, 0.1];
/// Fewest samples of a channel that is fit for tuning.
const FEWEST: usize = 200;
/// Factor that tells a signal from noise. A white channel (one with a flat spectrum) counts as noise if its standard
/// deviation is below this multiple of the channel's `noise`.
const ABOVE_NOISE: f64 = 2.0;
/// Smallest spectral flatness with which a channel counts as white. Sensors at rest have a flatness of 0.67 to 0.95,
/// and flights with vibration have 0.2 to 0.33.
const WHITE: f64 = 0.6;
/// Number of samples in a window. Noise and movement are measured in each window.
const WINDOW: usize = 64;

impl ChannelSummary {
    /// Summarises a recording, which must have at least one sample.
    pub fn of(recording: &Recording) -> Self {
        let values = &recording.values;
        let samples = values.len();
        let (min, max) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), own| {
                (min.min(*own), max.max(*own))
            });
        let deviation = deviation(values);
        let noise = noise(values);
        let (jitter_ms, gaps) = steps(recording);
        let quiet = quiet(values);
        let range = |is_quiet: bool| {
            let windows = values.chunks(WINDOW).zip(&quiet).filter(|(_, own)| **own == is_quiet);
            let inside = windows.flat_map(|(window, _)| window);
            let range = inside.fold(None, |range: Option<[f64; 2]>, own| {
                let [low, high] = range.unwrap_or([*own; 2]);
                Some([low.min(*own), high.max(*own)])
            });
            range.filter(|_| quiet.contains(&true) && quiet.contains(&false))
        };
        let resting = quiet.iter().filter(|own| **own).count() as f64 / quiet.len().max(1) as f64;
        let clipped = clipped(values, min, max);
        let rejected = recording.rejected();
        let verdict = if min == max {
            Verdict::Constant
        } else if samples < FEWEST {
            Verdict::TooShort
        } else if rejected * 5 > samples + rejected {
            Verdict::FullOfHoles
        } else if deviation < ABOVE_NOISE * noise && flatness(values) > WHITE {
            Verdict::OnlyNoise
        } else if clipped > 2.0 {
            Verdict::Clipped
        } else {
            Verdict::Good
        };
        Self {
            name: recording.name.clone(),
            unit: recording.unit().map(str::to_owned),
            samples,
            rejected,
            seconds: recording.seconds(),
            rate: recording.rate,
            jitter_ms,
            gaps,
            min,
            max,
            deviation,
            noise,
            bandwidth: recording.rate.map(|rate| bandwidth(values) * rate),
            clipped,
            rest: range(true),
            flight: range(false),
            resting: resting * 100.0,
            verdict,
        }
    }

    /// Returns a text for the user that says that a turn rate or an acceleration hardly moves. Returns `None` for any other
    /// channel.
    pub(crate) fn rest(&self, channel: &Inertial) -> Option<String> {
        let Self { name, deviation, .. } = self;
        let is_still = deviation / channel.per_si < AT_REST[usize::from(!channel.is_rate())];
        is_still.then(|| {
            format!(
                "{name} hardly moves, as at rest: its deviation is {} {}; what is tuned on it follows the noise",
                short(*deviation),
                channel.unit
            )
        })
    }

    /// Returns a text for the user that says why the channel is unfit for tuning. Returns `None` if the channel is fit.
    pub fn objection(&self) -> Option<String> {
        let Self { name, samples, min, rejected, deviation, noise, clipped, .. } = self;
        match self.verdict {
            Verdict::Good => None,
            Verdict::TooShort => {
                Some(format!("{name}: {samples} samples are too few; {FEWEST} say something"))
            }
            Verdict::Constant => {
                Some(format!("{name} never leaves {}: there is nothing to encode", short(*min)))
            }
            Verdict::OnlyNoise => Some(format!(
                "{name} is nothing but noise, or all on the ground: its deviation is {}, its noise {}; what is tuned on \
                 it follows the noise",
                short(*deviation),
                short(*noise)
            )),
            Verdict::FullOfHoles => Some(format!(
                "{name}: {rejected} of {} samples are missing or not finite",
                samples + rejected
            )),
            Verdict::Clipped => Some(format!(
                "{name}: {} % of the samples stand at the ends of the range: the sensor clips",
                short((clipped * 10.0).round() / 10.0)
            )),
        }
    }
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Returns an estimate of the noise's standard deviation: the tenth percentile of the estimates for all windows. The
/// estimate for a window is made from second differences, which are near 0 for a slow signal. For white noise, the
/// standard deviation of the second differences is √6 times that of the noise.
fn noise(values: &[f64]) -> f64 {
    let of = |window: &[f64]| {
        let second = window.windows(3).map(|own| (own[0] - 2.0 * own[1] + own[2]).powi(2));
        let count = second.len();
        (count > 0).then(|| (second.sum::<f64>() / count as f64 / 6.0).sqrt())
    };
    let mut all: Vec<f64> = values.chunks(WINDOW).filter_map(of).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 10).copied().unwrap_or_default()
}

/// Returns the spectral flatness: the ratio of the geometric to the arithmetic mean of the power over frequency,
/// averaged over windows. The flatness is near 1 for white noise, and near 0 for motors and manoeuvres, whose power
/// lies at few frequencies.
fn flatness(values: &[f64]) -> f64 {
    let mut sums = vec![0.0; WINDOW / 2];
    for start in (0..).step_by(WINDOW / 2) {
        let Some(window) = values.get(start..start + WINDOW) else { break };
        let mean = window.iter().sum::<f64>() / WINDOW as f64;
        let hann = |place: usize| (PI * place as f64 / (WINDOW - 1) as f64).sin().powi(2);
        let tapered: Vec<f64> =
            window.iter().zip(0..).map(|(own, place)| (own - mean) * hann(place)).collect();
        // The bin of frequency 0 is skipped, because the taper leaks the mean into it.
        for (sum, power) in sums.iter_mut().zip(power(&tapered).into_iter().skip(1)) {
            *sum += power;
        }
    }
    let count = sums.len() as f64;
    let arithmetic = sums.iter().sum::<f64>() / count;
    let logarithm = sums.iter().map(|sum| sum.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / count;
    if arithmetic > 0.0 { logarithm.exp() / arithmetic } else { 1.0 }
}

/// Returns for each window whether the channel is quiet. The channel is quiet in a window whose standard deviation is
/// at most four times the fifth percentile of all windows' standard deviations.
fn quiet(values: &[f64]) -> Vec<bool> {
    const QUIET: f64 = 4.0;
    let deviations: Vec<f64> = values.chunks(WINDOW).map(deviation).collect();
    let mut sorted = deviations.clone();
    sorted.sort_by(f64::total_cmp);
    let least = sorted.get(sorted.len() / 20).copied().unwrap_or_default();
    deviations.into_iter().map(|own| own <= QUIET * least).collect()
}

/// Returns the percentage of samples that equal `min` or `max` and stand in runs of three or more.
fn clipped(values: &[f64], min: f64, max: f64) -> f64 {
    let is_same_end = |a: &f64, b: &f64| a == b && (*a == min || *a == max);
    let runs = values.chunk_by(is_same_end).map(<[f64]>::len).filter(|length| *length >= 3);
    100.0 * runs.sum::<usize>() as f64 / values.len() as f64
}

/// Returns the bandwidth, as a share of the sample rate: 99 % of the signal's power lies below this frequency. The mean
/// of the signal does not count as power.
fn bandwidth(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let around: Vec<f64> = values.iter().map(|own| own - mean).collect();
    let power = power(&around);
    let most = 0.99 * power.iter().sum::<f64>();
    let mut sum = 0.0;
    let bin = power.iter().position(|own| {
        sum += own;
        sum >= most
    });
    bin.unwrap_or_default() as f64 / values.len() as f64
}

/// Returns the standard deviation of the time between samples in ms, and the number of gaps. The standard deviation
/// leaves out the gaps.
fn steps(recording: &Recording) -> (Option<f64>, usize) {
    let (mut regular, mut gaps) = (Vec::new(), 0);
    let Some(longest) = recording.longest_step() else { return (None, 0) };
    for pair in recording.times.windows(2) {
        let step = (pair[1] - pair[0]) as f64;
        if step > longest {
            gaps += 1;
        } else {
            regular.push(step * 1e-3);
        }
    }
    (Some(deviation(&regular)), gaps)
}

#[cfg(test)]
mod tests {
    use super::{bandwidth, clipped, flatness, noise, quiet};

    fn white(count: usize) -> Vec<f64> {
        let mut state = 1_u32;
        let next = |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) - 0.5
        };
        (0..count).map(next).collect()
    }

    /// The estimated standard deviation of uniform noise of width 1 is within 25 % of the true one, √(1/12). The same
    /// holds if a slow wave of amplitude 40 is added to the noise.
    #[test]
    fn noise_is_found_under_a_wave() {
        let noisy = white(6400);
        let expected = (1.0_f64 / 12.0).sqrt();
        assert!((noise(&noisy) / expected - 1.0).abs() < 0.25);
        let wave = noisy.iter().zip(0..).map(|(own, i)| own + 40.0 * (f64::from(i) * 0.01).sin());
        assert!((noise(&wave.collect::<Vec<_>>()) / expected - 1.0).abs() < 0.25);
    }

    #[test]
    fn white_noise_is_flat_and_vibration_is_not() {
        let noisy = white(6400);
        assert!(flatness(&noisy) > 0.9);
        let shaken: Vec<f64> = noisy
            .iter()
            .zip(0..)
            .map(|(own, i)| {
                own + 0.6 * (f64::from(i) * 2.3).sin() + 0.4 * (f64::from(i) * 1.9).sin()
            })
            .collect();
        assert!(flatness(&shaken) < 0.6);
    }

    #[test]
    fn bandwidth_clipping_and_rest() {
        let wave: Vec<f64> =
            (0..1000).map(|i| (f64::from(i) * std::f64::consts::TAU * 0.02).sin()).collect();
        assert!((bandwidth(&wave) - 0.02).abs() < 1e-9);
        let cut: Vec<f64> = wave.iter().map(|own| own.clamp(-0.5, 0.5)).collect();
        assert!(clipped(&wave, -1.0, 1.0) == 0.0 && clipped(&cut, -0.5, 0.5) > 50.0);
        let still = white(640).into_iter().map(|own| own * 0.01);
        let both: Vec<f64> = still.chain(wave.iter().copied().take(640)).collect();
        assert_eq!(quiet(&both), [[true; 10], [false; 10]].concat());
    }
}
