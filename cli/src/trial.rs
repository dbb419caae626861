//! A recording there and back, for looking at and for scoring.

use crate::brief::short;
use crate::fit::{Fit, rounded};
use crate::input::{Clock, InputOptions};
use crate::options::SchemeOptions;
use crate::scheme::Scheme;
use anyhow::{Context, Result, anyhow, bail};
use catalogue::run::{Calibrated, Event, Known, SampleType, Settings, Shape};

/// A recording in memory.
pub(crate) struct Recording {
    /// Its finite samples.
    pub values: Vec<f64>,
    /// Their times in µs, if recorded.
    pub times: Vec<i64>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
    /// What it is called.
    pub name: String,
    /// How many samples were not finite.
    rejected: usize,
    clock: Clock,
    /// How it was read.
    notes: Vec<String>,
}

impl Recording {
    /// Of samples in memory, all finite, evenly spaced.
    pub(crate) fn of(name: String, values: Vec<f64>, rate: Option<f64>) -> Self {
        /// No step is longer than another.
        const STEPS: f64 = 1.5;
        let clock = Clock::new(&[], rate, STEPS);
        Self { values, times: Vec::new(), rate, name, rejected: 0, clock, notes: Vec::new() }
    }

    /// Reads all of its one channel.
    ///
    /// # Errors
    /// As reading does, several channels, or no finite sample.
    pub(crate) fn read(input: &InputOptions) -> Result<Self> {
        input.single("this command")?;
        Self::read_all(input)?.pop().with_context(|| format!("{}: no channel", input.name()))
    }

    /// Reads all of every channel asked for.
    ///
    /// # Errors
    /// As reading does, or no row without a value that is not finite.
    pub(crate) fn read_all(input: &InputOptions) -> Result<Vec<Self>> {
        let mut source = input.open()?;
        let all = source.rest()?;
        let rows = all.finite_rows();
        let times: Vec<i64> =
            all.times.iter().zip(&rows).filter(|(_, row)| **row).map(|(time, _)| *time).collect();
        let names = source.origin().last().map_or(String::new(), |(_, name)| name.clone());
        let channels = all.kept(&rows).into_iter().zip(names.split(','));
        channels
            .map(|(values, name)| {
                if values.is_empty() {
                    bail!("{}: none of the {} samples is finite", input.name(), rows.len());
                }
                let mut clock = Clock::new(&all.times, input.rate, input.gap);
                clock.observe(&all.times);
                Ok(Self {
                    rejected: rows.len() - values.len(),
                    values,
                    times: times.clone(),
                    rate: clock.rate(),
                    name: name.to_owned(),
                    clock,
                    notes: source.notes().to_vec(),
                })
            })
            .collect()
    }

    /// What a user should know of it, a line each.
    pub(crate) fn notes(&self) -> String {
        let mut notes = self.notes.clone();
        if self.rejected > 0 {
            let count = self.rejected;
            notes.push(format!("{count} samples were not finite or missing and emitted nothing"));
        }
        notes.push(format!("{}\n", self.clock));
        notes.join("\n")
    }

    /// How many samples were missing or not finite.
    pub(crate) fn rejected(&self) -> usize {
        self.rejected
    }

    /// How long it is in seconds, if that is known.
    pub(crate) fn seconds(&self) -> Option<f64> {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => Some(last.saturating_sub(*first) as f64 * 1e-6),
            _ => Some(self.values.len() as f64 / self.rate?),
        }
    }
}

/// What a scheme made of a recording.
pub(crate) struct Trial {
    /// The scheme.
    pub scheme: Scheme,
    /// Its parameters, as they ran.
    pub settings: Settings,
    /// How many neurons and sub-timesteps it has.
    pub shape: Shape,
    /// How many samples after its own the code of a sample comes out.
    pub latency: usize,
    /// What a user should know of how the parameters suit the recording.
    pub notes: Vec<String>,
    /// The spikes.
    pub events: Vec<Event>,
    /// What they decode to, one value a sample.
    pub decoded: Vec<f64>,
}

impl Trial {
    /// Encodes and decodes the recording.
    ///
    /// # Errors
    /// The parameters make no sense.
    pub(crate) fn new(
        scheme: Scheme,
        options: &SchemeOptions,
        sample: SampleType,
        recording: &Recording,
    ) -> Result<Self> {
        let mut calibrated = Calibrated::new(sample);
        calibrated.observe(&recording.values);
        let known =
            Known { calibrated: Some(&calibrated), first: &recording.values, can_calibrate: true };
        let settings = scheme.resolve(options, &known)?;
        let (settings, rounding) = rounded(scheme, sample, &settings)?;
        let mut codec = scheme.codec(sample, &settings)?;
        let (mut events, mut decoded) = (Vec::new(), Vec::new());
        codec.encode(&recording.values, &mut events);
        codec.finish(&mut events);
        codec.decode(recording.values.len(), &events, &mut decoded).map_err(|event| {
            anyhow!("{}: sample {} does not decode", scheme.name(), event.sample)
        })?;
        let mut fit = Fit::new(scheme, sample, &settings);
        fit.observe(&recording.values);
        let mut notes: Vec<String> = rounding.into_iter().collect();
        let suits = fit.notes(&settings, events.len() as u64);
        notes.extend(suits.lines().map(str::to_owned));
        notes.extend(low(&recording.values, &decoded));
        let shape = scheme.shape(&settings)?;
        Ok(Self { scheme, settings, shape, latency: codec.latency(), notes, events, decoded })
    }

    /// `(1 - spikes / samples) * 100`.
    pub(crate) fn efficiency(&self) -> f64 {
        (1.0 - self.events.len() as f64 / self.decoded.len() as f64) * 100.0
    }
}

/// What to say where the decoded values are off on the whole, by more than the signal itself moves.
fn low(values: &[f64], decoded: &[f64]) -> Option<String> {
    let mean = |sum: f64| sum / values.len() as f64;
    let center = mean(values.iter().sum());
    let deviation = mean(values.iter().map(|value| (value - center).powi(2)).sum()).sqrt();
    let off = mean(values.iter().zip(decoded).map(|(value, decoded)| decoded - value).sum());
    (off.abs() > deviation).then(|| {
        let direction = if off < 0.0 { "low" } else { "high" };
        format!(
            "decodes {} too {direction} on average, where the signal's own deviation is {}",
            short(off.abs()),
            short(deviation)
        )
    })
}
