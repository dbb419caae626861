//! Encodes and decodes recordings in memory, in order to draw and score the results.

use crate::error::At;
use crate::input::{CHUNK, Chunk, Clock, InputOptions, Kind, TableKind, UnevenRate};
use crate::measure::{Measure, Sums};
use crate::scheme::Scheme;
use crate::slope::Slope;
use crate::unit::unit_of_name;
use crate::{Result, Spot};
use catalogue::run::{Asked, Calibrated, Event, SampleType, Settings, Shape, Words};
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
    /// Sample rate in Hz, if known: samples through the length without gaps, or the rate that the user gave. What relies
    /// on the rate asks for [`steady_rate`](Self::steady_rate).
    pub rate: Option<f64>,
    /// Name of the channel.
    pub name: String,
    /// Name by which the channel is found in the log again: `TOPIC.FIELD`, or `name` in a table.
    pub source: String,
    /// Unit of the samples, if the log gives it.
    pub unit: Option<String>,
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
        let source = name.clone();
        let unit = None;
        Self { values, times, segments, rate, name, source, unit, rejected: 0, clock, notes }
    }

    /// Reads a recording of one channel.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, has several channels, or has no finite sample.
    pub fn read(input: &InputOptions) -> Result<Self> {
        input.single("this command")?;
        let mut all = Self::read_all(input)?;
        if all.len() > 1 {
            let command = "this command".to_owned();
            return Err(TableKind::OneChannel { command, channels: all.len() }.into());
        }
        all.pop().ok_or_else(|| TableKind::NoChannel.at(input.name()))
    }

    /// Reads a recording of every chosen channel. Rows in which any channel is not finite are left out. The usual step
    /// of the times is that of the first [`CHUNK`] samples.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, or if no row is finite in all columns.
    pub fn read_all(input: &InputOptions) -> Result<Vec<Self>> {
        let mut source = input.open()?;
        let mut all = Chunk::default();
        source.next(&mut all)?;
        // As in files that are read in pieces, the first piece tells the usual step.
        let first = all.times.len();
        all.append(&mut source.rest()?);
        let rows = all.finite_rows();
        let mut clock = Clock::new(&all.times[..first], input.rate, input.gap);
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
        let topic = source.origin().iter().find(|(key, _)| *key == "topic").map(|(_, topic)| topic);
        let channels = all.kept(&rows).into_iter().zip(source.names()).zip(source.units());
        channels
            .map(|((values, name), unit)| {
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
                    source: match topic {
                        Some(topic) => format!("{topic}.{name}"),
                        None => name.to_owned(),
                    },
                    unit,
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
            source: self.source.clone(),
            unit: self.unit.clone(),
            rejected: self.rejected,
            clock: self.clock.clone(),
            notes: self.notes.clone(),
        }
    }

    /// Returns notes on the recording, to be shown to the user.
    pub fn notes(&self) -> Vec<Words> {
        notes(&self.notes, self.rejected, &self.clock)
    }

    /// Returns the number of samples that were missing or not finite.
    pub fn rejected(&self) -> usize {
        self.rejected
    }

    /// Returns the longest step in µs that is no gap, if the recording has times that go forward.
    pub(crate) fn longest_step(&self) -> Option<f64> {
        let longest = self.clock.longest_step();
        (self.times.len() > 1 && longest > 0.0).then_some(longest)
    }

    /// Returns the two rates of a recording whose times contradict themselves.
    pub fn uneven(&self) -> Option<UnevenRate> {
        self.clock.uneven()
    }

    /// Returns the sample rate in Hz, if it is known, for what must rely on it: a period that is written, or advice.
    ///
    /// # Errors
    /// Returns an error that asks for the rate if the times of the recording contradict themselves.
    pub fn steady_rate(&self) -> Result<Option<f64>> {
        self.clock.steady_rate().at(|| Spot::Part(self.name.clone()))?;
        Ok(self.rate)
    }

    /// Returns the unit of the samples, if the log gives it or the channel's name shows it.
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref().or_else(|| unit_of_name(&self.name))
    }

    /// Returns the duration in seconds, if it is known. The unknown time between segments is left out.
    pub fn seconds(&self) -> Option<f64> {
        if self.times.is_empty() {
            return Some(self.values.len() as f64 / self.rate?);
        }
        Some(self.clock.seconds())
    }
}

/// Returns notes for the user on a recording: those of its reader, the number of rejected samples, and its clock's.
pub(crate) fn notes(of_reader: &[Words], rejected: usize, clock: &Clock) -> Vec<Words> {
    let mut notes = of_reader.to_vec();
    if rejected > 0 {
        let what = "samples were not finite or missing and emitted nothing";
        notes.push(format!("{rejected} {what}").into());
    }
    notes.push(clock.to_string().into());
    notes
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
    /// Numbers of samples and spikes, and sums of the errors.
    pub(crate) sums: Sums,
    /// The largest slope of the recording, compared with the largest slope that the code can follow, if there is one.
    pub(crate) slope: Option<Slope>,
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
        let mut calibrated = Calibrated::of(sample, asked);
        calibrated.observe(&recording.values);
        let mean = recording.values.iter().sum::<f64>() / recording.values.len() as f64;
        let known = (&calibrated, mean);
        let mut measure = Measure::new(scheme, asked, sample, known, &recording.values)?;
        let (mut events, mut decoded) = (Vec::new(), Vec::new());
        let mut take = |new: &[Event], values: &[f64]| {
            events.extend_from_slice(new);
            decoded.extend_from_slice(values);
        };
        for segment in &recording.segments {
            for part in recording.values[segment.clone()].chunks(CHUNK) {
                measure.observe(part, &mut take)?;
            }
            measure.end_segment(&mut take)?;
        }
        let settings = measure.settings().clone();
        Ok(Self {
            scheme,
            shape: scheme.shape(&settings)?,
            settings,
            latency: measure.latency(),
            notes: measure.notes(),
            events,
            decoded,
            sums: measure.sums(),
            slope: measure.slope(recording.rate),
        })
    }

    /// Returns the spiking efficiency, `(1 - spikes / samples) * 100`, in percent.
    pub fn efficiency(&self) -> f64 {
        self.sums.efficiency()
    }
}
