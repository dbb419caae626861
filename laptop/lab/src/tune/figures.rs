//! The figures by which a report judges settings.

use super::{Problem, Stretch};
use crate::Result;
use catalogue::run::{Asked, Event, SampleType};
use realfft::RealFftPlanner;
use serde::Serialize;
use std::collections::HashMap;

/// Figures that rate settings, such as the RMSE and the number of spikes. They cover the scored samples of one or more
/// stretches (runs of samples that are coded in one piece).
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Figures {
    /// Number of samples.
    pub samples: usize,
    /// Number of spikes.
    pub spikes: usize,
    /// Efficiency in percent: 100 less the number of spikes for every 100 samples. For a code with at most one spike a
    /// sample, this is the percentage of samples without a spike.
    pub efficiency: f64,
    /// Root mean square error, in the signal's unit.
    pub rmse: f64,
    /// Signal-to-noise ratio in dB: the signal's variance over the mean square of the error.
    pub snr: f64,
    /// The largest error, in the signal's unit.
    pub worst: f64,
    /// Delay of the decoded values in samples, in addition to the code's latency. It is the lag at which signal and
    /// decoded values correlate most.
    pub lag: i64,
    /// RMSE of the low-pass filtered error, if a frequency limit for the filter was given and the sample rate is known.
    pub below: Option<f64>,
    /// Events a second, if the rate is known.
    pub events_per_second: Option<f64>,
    /// Entropy of the spikes, in bits a second. It is the entropy of one sample's code multiplied by the sample rate.
    pub bits_per_second: Option<f64>,
    /// Bits a second of the samples if they were sent without the code, rounded as coarsely as the code's error
    /// permits. The rounding step is chosen such that the rounding error has the same RMSE as the code.
    pub raw_bits_per_second: Option<f64>,
}

impl Figures {
    /// Computes the figures of settings on one or more stretches. `below` is the frequency in Hz below which the error
    /// is also measured.
    ///
    /// # Errors
    /// Returns an error if the options are invalid.
    pub fn new(
        problem: &Problem,
        options: &Asked,
        sample: SampleType,
        stretches: &[Stretch],
        below: Option<f64>,
    ) -> Result<Self> {
        let mut sums = Sums::default();
        let mut correlations = vec![0.0; 2 * FARTHEST + 1];
        let mut codes: HashMap<Vec<Event>, usize> = HashMap::new();
        for stretch in stretches {
            let (events, decoded, _) = problem.run(options, sample, stretch)?;
            let events: Vec<Event> = stretch.scored_events(&events).flatten().copied().collect();
            sums.spikes += events.len();
            count_codes(&events, stretch.samples(), &mut codes);
            sums.seconds = match sums.samples {
                0 => stretch.seconds(),
                _ => sums.seconds.zip(stretch.seconds()).map(|(all, own)| all + own),
            };
            for scored in &stretch.scored {
                let (values, decoded) = (&stretch.values[scored.clone()], &decoded[scored.clone()]);
                sums.observe(values, decoded);
                correlate(values, decoded, &mut correlations);
                if let (Some(limit), Some(rate)) = (below, stretch.rate) {
                    let off: Vec<f64> =
                        values.iter().zip(decoded).map(|(value, own)| own - value).collect();
                    sums.below += squares_below(&off, limit / rate);
                }
            }
        }
        let samples = sums.samples as f64;
        let mean_square = sums.squares / samples;
        let mean = sums.values / samples;
        let variance = sums.value_squares / samples - mean * mean;
        let rate = sums.seconds.map(|seconds| samples / seconds);
        let entropy: f64 = codes.values().map(|count| *count as f64 / samples).map(bits).sum();
        // Rounding to steps of this size gives the same RMSE; `raw` bits number the steps within the range.
        let step = (12.0 * mean_square).sqrt();
        let raw = ((sums.max - sums.min) / step + 1.0).log2();
        let best = |(place, _): (usize, &f64)| place as i64 - FARTHEST as i64;
        let lag = correlations.iter().enumerate().max_by(|a, b| {
            // Of two lags with the same correlation, the shorter one.
            a.1.total_cmp(b.1).then(best(*b).abs().cmp(&best(*a).abs()))
        });
        Ok(Self {
            samples: sums.samples,
            spikes: sums.spikes,
            efficiency: (1.0 - sums.spikes as f64 / samples) * 100.0,
            rmse: mean_square.sqrt(),
            snr: 10.0 * (variance / mean_square).log10(),
            worst: sums.worst,
            lag: lag.map_or(0, best),
            below: below.filter(|_| rate.is_some()).map(|_| (sums.below / samples).sqrt()),
            events_per_second: sums.seconds.map(|seconds| sums.spikes as f64 / seconds),
            bits_per_second: rate.map(|rate| entropy * rate),
            raw_bits_per_second: rate.filter(|_| raw.is_finite()).map(|rate| raw * rate),
        })
    }
}

/// Largest lag between the signal and the decoded values for which the correlation is computed, in samples. Lags in
/// both directions are tried.
const FARTHEST: usize = 100;

#[derive(Default)]
struct Sums {
    samples: usize,
    spikes: usize,
    seconds: Option<f64>,
    squares: f64,
    below: f64,
    worst: f64,
    values: f64,
    value_squares: f64,
    min: f64,
    max: f64,
}

impl Sums {
    fn observe(&mut self, values: &[f64], decoded: &[f64]) {
        if self.samples == 0 {
            (self.min, self.max) = (f64::INFINITY, f64::NEG_INFINITY);
        }
        self.samples += values.len();
        for (value, decoded) in values.iter().zip(decoded) {
            let off = value - decoded;
            self.squares += off * off;
            self.worst = self.worst.max(off.abs());
            self.values += value;
            self.value_squares += value * value;
            (self.min, self.max) = (self.min.min(*value), self.max.max(*value));
        }
    }
}

/// Returns `-p log2 p`, where `p` is `part`; 0 if `p` is 0.
fn bits(part: f64) -> f64 {
    if part > 0.0 { -part * part.log2() } else { 0.0 }
}

/// Counts how often each code occurs. The code of a sample is the list of its events, which may be empty.
fn count_codes(events: &[Event], samples: usize, codes: &mut HashMap<Vec<Event>, usize>) {
    let groups = events.chunk_by(|a, b| a.sample == b.sample);
    let mut silent = samples;
    for group in groups {
        let code = group.iter().map(|event| Event { sample: 0, ..*event }).collect();
        *codes.entry(code).or_default() += 1;
        silent = silent.saturating_sub(1);
    }
    *codes.entry(Vec::new()).or_default() += silent;
}

/// Computes the correlation of a signal with its decoded values for each lag from `-FARTHEST` to `FARTHEST` samples.
/// Adds the results to `correlations`, which has an entry for each lag.
fn correlate(values: &[f64], decoded: &[f64], correlations: &mut [f64]) {
    let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
    let (center, middle) = (mean(values), mean(decoded));
    let samples = values.len();
    for (lag, sum) in (-(FARTHEST as i64)..).zip(correlations) {
        let (from, to) = ((-lag).max(0) as usize, lag.max(0) as usize);
        let count = samples.saturating_sub(from.max(to));
        let pairs = values.iter().skip(from).zip(decoded.iter().skip(to)).take(count);
        *sum += pairs.map(|(value, own)| (value - center) * (own - middle)).sum::<f64>();
    }
}

/// Returns the sum of squares after an ideal low-pass filter at `limit`, a share of the sample rate.
pub fn squares_below(values: &[f64], limit: f64) -> f64 {
    let power = power(values);
    let count = values.len();
    let kept = power.iter().enumerate().take_while(|(bin, _)| *bin as f64 / count as f64 <= limit);
    kept.map(|(_, power)| power).sum()
}

/// Returns the power spectrum, from frequency 0 to half the sample rate. Its entries add up to the sum of the squares
/// of `values`.
pub fn power(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    if count < 2 {
        return values.iter().map(|value| value * value).collect();
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(count);
    let mut spectrum = transform.make_output_vec();
    let mut input = values.to_vec();
    if transform.process(&mut input, &mut spectrum).is_err() {
        return Vec::new();
    }
    // Each bin counts for its mirror image too, except at 0 and at half the sample rate.
    let times = |bin: usize| if bin == 0 || bin * 2 == count { 1.0 } else { 2.0 };
    let bins = spectrum.iter().enumerate();
    bins.map(|(bin, value)| times(bin) * value.norm_sqr() / count as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::{FARTHEST, correlate, power, squares_below};
    use std::f64::consts::TAU;

    #[test]
    fn power_adds_up_to_the_squares() {
        for count in [1, 2, 7, 100, 101] {
            let values: Vec<f64> = (0..count).map(|i| f64::from(i * i % 17) - 3.0).collect();
            let squares: f64 = values.iter().map(|value| value * value).sum();
            assert!((power(&values).iter().sum::<f64>() - squares).abs() < 1e-9 * squares.max(1.0));
        }
    }

    /// A signal is the sum of two waves, with 5 and 40 cycles in 1000 samples. With a frequency limit between the two,
    /// only the slower wave is measured.
    #[test]
    fn a_limit_keeps_what_is_below() {
        let wave = |cycles: f64| move |i: i32| (TAU * cycles * f64::from(i) / 1000.0).sin();
        let both: Vec<f64> = (0..1000).map(|i| wave(5.0)(i) + 3.0 * wave(40.0)(i)).collect();
        assert!((squares_below(&both, 0.02) - 500.0).abs() < 1e-6);
        assert!((squares_below(&both, 0.5) - 5000.0).abs() < 1e-6);
    }

    #[test]
    fn a_late_copy_has_a_lag() {
        let signal: Vec<f64> = (0..500).map(|i| (f64::from(i) * 0.05).sin()).collect();
        let late: Vec<f64> = [0.0; 7].into_iter().chain(signal.iter().copied()).take(500).collect();
        let mut correlations = vec![0.0; 2 * FARTHEST + 1];
        correlate(&signal, &late, &mut correlations);
        let best = correlations.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
        assert_eq!(best, FARTHEST + 7);
    }
}
