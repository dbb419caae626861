//! Encodes and decodes recordings in memory, in order to draw and score the results.

use crate::Result;
use crate::brief::short;
use crate::fit::{Fit, explained, rounding};
use crate::input::TableKind;
use crate::input::{Clock, InputOptions, Kind};
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use catalogue::run::{Asked, Calibrated, Event, Known, SampleType, Settings, Shape, Words};
use std::ops::Range;

/// One channel of a recording, in memory.
#[derive(Clone)]
pub struct Recording {
    /// The finite samples.
    pub values: Vec<f64>,
    /// The samples' times in µs; empty if no times were recorded. If the recorder's clock restarted, later times are
    /// shifted such that they continue the earlier times with a step of the usual length.
    pub times: Vec<i64>,
    /// Index range of each segment. A restart of the recorder's clock begins a new segment.
    pub segments: Vec<Range<usize>>,
    /// Sample rate in Hz, if known.
    pub rate: Option<f64>,
    /// Name of the channel.
    pub name: String,
    /// Number of samples that were missing or not finite.
    rejected: usize,
    clock: Clock,
    /// Notes for the user on how the recording was read.
    notes: Vec<Words>,
}

impl Recording {
    /// Makes a recording of evenly spaced samples, which must be finite.
    pub fn of(name: String, values: Vec<f64>, rate: Option<f64>) -> Self {
        /// Limit on the time from one sample to the next, as a multiple of the usual time. A longer time counts as a
        /// gap. [`Clock::new`] needs this limit, but it has no effect here, because the samples have no times.
        const STEPS: f64 = 1.5;
        let clock = Clock::new(&[], rate, STEPS);
        let segments = between(Vec::new(), values.len());
        let (times, notes) = (Vec::new(), Vec::new());
        Self { values, times, segments, rate, name, rejected: 0, clock, notes }
    }

    /// Reads a recording of one channel.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, has several channels, or has no finite sample.
    pub fn read(input: &InputOptions) -> Result<Self> {
        input.single("this command")?;
        Self::read_all(input)?.pop().ok_or_else(|| TableKind::NoChannel.at(input.name()))
    }

    /// Reads a recording of every chosen channel. Rows in which any channel is not finite are left out.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, or if no row is finite in all columns.
    pub fn read_all(input: &InputOptions) -> Result<Vec<Self>> {
        let mut source = input.open()?;
        let all = source.rest()?;
        let rows = all.finite_rows();
        let mut clock = Clock::new(&all.times, input.rate, input.gap);
        let steps = clock.observe(&all.times);
        let restarts = steps.iter().filter(|step| step.kind == Kind::Restart);
        let starts = restarts.map(|step| step.after as usize + 1);
        let segments = between(starts.collect(), rows.len());
        let times = in_a_row(&all.times, &segments, clock.period());
        let times: Vec<i64> =
            times.into_iter().zip(&rows).filter(|(_, row)| **row).map(|(time, _)| time).collect();
        let finite = |row: usize| rows[..row].iter().filter(|row| **row).count();
        let segments = segments.into_iter().map(|own| finite(own.start)..finite(own.end));
        let segments: Vec<Range<usize>> = segments.filter(|own| !own.is_empty()).collect();
        let channels = all.kept(&rows).into_iter().zip(source.names());
        channels
            .map(|(values, name)| {
                if values.is_empty() {
                    let kind = TableKind::NoneFinite { samples: rows.len() };
                    return Err(kind.at(input.name()));
                }
                Ok(Self {
                    rejected: rows.len() - values.len(),
                    values,
                    times: times.clone(),
                    segments: segments.clone(),
                    rate: clock.rate(),
                    name: name.to_owned(),
                    clock: clock.clone(),
                    notes: source.notes().to_vec(),
                })
            })
            .collect()
    }

    /// Returns the recording with each sample replaced by the output of a filter. `start` makes a new filter for each
    /// segment.
    #[must_use]
    pub fn filtered<F: FnMut(f64) -> f64>(&self, mut start: impl FnMut() -> F) -> Self {
        let mut values = self.values.clone();
        for segment in &self.segments {
            let mut filter = start();
            for value in values.get_mut(segment.clone()).into_iter().flatten() {
                *value = filter(*value);
            }
        }
        Self {
            values,
            times: self.times.clone(),
            segments: self.segments.clone(),
            rate: self.rate,
            name: self.name.clone(),
            rejected: self.rejected,
            clock: self.clock.clone(),
            notes: self.notes.clone(),
        }
    }

    /// Returns notes on the recording, to be shown to the user.
    pub fn notes(&self) -> Vec<Words> {
        let mut notes = self.notes.clone();
        if self.rejected > 0 {
            let count = self.rejected;
            let what = "samples were not finite or missing and emitted nothing";
            notes.push(format!("{count} {what}").into());
        }
        notes.push(self.clock.to_string().into());
        notes
    }

    /// Returns the number of samples that were missing or not finite.
    pub fn rejected(&self) -> usize {
        self.rejected
    }

    /// Returns the duration in seconds, if it is known. The unknown time between segments is left out.
    pub fn seconds(&self) -> Option<f64> {
        if self.times.is_empty() {
            return Some(self.values.len() as f64 / self.rate?);
        }
        Some(self.clock.seconds())
    }
}

/// Returns the index range of each segment of a recording. `samples` is the number of samples. `bounds` holds the index
/// at which each segment begins, except for the first segment, which begins at 0.
fn between(mut bounds: Vec<usize>, samples: usize) -> Vec<Range<usize>> {
    bounds.insert(0, 0);
    bounds.push(samples);
    bounds.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// Shifts the times of each segment to close the gaps between segments. The earliest time of a segment is set to the
/// latest time of the preceding segment plus `period`. The first segment keeps its times. All times are in µs.
fn in_a_row(times: &[i64], segments: &[Range<usize>], period: i64) -> Vec<i64> {
    let mut all: Vec<i64> = Vec::with_capacity(times.len());
    let mut latest: Option<i64> = None;
    for own in segments.iter().filter_map(|segment| times.get(segment.clone())) {
        let Some(earliest) = own.iter().min() else { continue };
        let follow = |latest: i64| latest.saturating_add(period).saturating_sub(*earliest);
        let shift = latest.map_or(0, follow);
        all.extend(own.iter().map(|time| time.saturating_add(shift)));
        latest = own.iter().max().map(|time| time.saturating_add(shift));
    }
    all
}

/// A scheme's spikes and decoded values for a recording.
pub struct Trial {
    /// The scheme that encodes and decodes.
    pub scheme: Scheme,
    /// The values of all parameters of the scheme.
    pub settings: Settings,
    /// Number of neurons, and number of sub-timesteps into which a sample is divided.
    pub shape: Shape,
    /// Latency of the code: the number of samples by which the encoder's output lags behind its input.
    pub latency: usize,
    /// Notes for the user on whether the parameters suit the recording.
    pub notes: Vec<String>,
    /// The spikes.
    pub events: Vec<Event>,
    /// The decoded values, one for each sample.
    pub decoded: Vec<f64>,
}

impl Trial {
    /// Encodes and decodes a recording, each of its segments with a new codec.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid, or if the codec cannot decode its own events.
    pub fn new(
        scheme: Scheme,
        asked: &Asked,
        sample: SampleType,
        recording: &Recording,
    ) -> Result<Self> {
        let mut calibrated = Calibrated::new(sample);
        calibrated.observe(&recording.values);
        let asked = asked.channel(scheme.info(), 0, 1)?;
        let resolved = |first: &[f64]| {
            let known = Known { calibrated: Some(&calibrated), first, can_calibrate: true };
            let settings = scheme.resolve(sample, &asked, &known);
            settings.map_err(|error| explained(error.into(), sample, first))
        };
        let settings = resolved(&recording.values)?;
        let (mut latency, mut all, mut decoded) = (0, Vec::new(), Vec::new());
        for segment in &recording.segments {
            let values = &recording.values[segment.clone()];
            let mut codec = scheme.codec(&resolved(values)?)?;
            let mut events = Vec::new();
            codec.encode(values, &mut events);
            codec.finish(&mut events);
            let start = segment.start as u64;
            codec.decode(values.len(), &events, &mut decoded).map_err(|event| {
                let sample = start + event.sample;
                RequestKind::NotDecoded { scheme: scheme.name(), sample }
            })?;
            latency = codec.latency();
            all.extend(events.into_iter().map(|own| Event { sample: start + own.sample, ..own }));
        }
        let events: Vec<Event> = all;
        let mut fit = Fit::new(scheme, &settings);
        fit.observe(&recording.values);
        let mut notes: Vec<String> = rounding(&settings).into_iter().collect();
        let suits = fit.notes(&settings, events.len() as u64);
        notes.extend(suits.lines().map(str::to_owned));
        notes.extend(low(&recording.values, &decoded));
        let shape = scheme.shape(&settings)?;
        Ok(Self { scheme, settings, shape, latency, notes, events, decoded })
    }

    /// Returns the spiking efficiency, `(1 - spikes / samples) * 100`, in percent.
    pub fn efficiency(&self) -> f64 {
        (1.0 - self.events.len() as f64 / self.decoded.len() as f64) * 100.0
    }
}

/// Compares the mean of the decoded values with the mean of the signal. Returns a note if the two means differ by more
/// than the signal's standard deviation.
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
