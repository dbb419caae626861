//! Scores a trial: counts its spikes, and measures the error of the decoded values.

use crate::Result;
use crate::brief::{brief, json};
use crate::input::{CHUNK, Chunk, Clock, InputOptions, Kind, TableKind};
use crate::measure::{Measure, Sums};
use crate::scheme::Scheme;
use crate::slope::Slope;
use crate::trial::{Recording, Trial, notes};
use catalogue::run::{Asked, Calibrated, SampleType, Settings, Words};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The figures of a trial of one scheme on a recording.
#[derive(Debug, Serialize)]
pub struct Figures {
    /// Short name of the scheme.
    pub scheme: String,
    /// Number of samples.
    pub samples: usize,
    /// Number of spikes.
    pub spikes: usize,
    /// Spiking efficiency in percent, as [`Trial::efficiency`] defines it. If the code emits at most one spike a
    /// sample, the efficiency is the percentage of samples without a spike.
    pub efficiency: f64,
    /// Root mean square error, in the signal's unit.
    pub rmse: f64,
    /// Signal-to-noise ratio in dB: the signal's variance over the mean square of the error.
    pub snr: f64,
    /// Spikes a second, if the recording's length is known.
    pub spikes_per_second: Option<f64>,
    /// The parameters that were used, by their keys.
    pub parameters: BTreeMap<&'static str, Value>,
    /// The signal's largest slope, compared with the largest slope that the code can follow. `None` if the code can
    /// follow any slope.
    pub slope: Option<Slope>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// The parameters in short form.
    #[serde(skip)]
    pub brief: String,
}

impl Figures {
    /// Returns the figures of a trial, with the recording's length and largest slope.
    pub fn of(recording: &Recording, trial: &Trial) -> Self {
        let about = (trial.slope.clone(), trial.notes.clone());
        Self::new(trial.scheme, &trial.settings, trial.sums, recording.seconds(), about)
    }

    /// Computes the figures of a scheme from the sums over a recording. `seconds` is the recording's length.
    fn new(
        scheme: Scheme,
        settings: &Settings,
        sums: Sums,
        seconds: Option<f64>,
        (slope, notes): (Option<Slope>, Vec<String>),
    ) -> Self {
        let parameters = settings.entries();
        Self {
            scheme: scheme.name().to_owned(),
            samples: sums.samples,
            spikes: sums.spikes,
            efficiency: sums.efficiency(),
            rmse: (sums.noise / sums.samples as f64).sqrt(),
            snr: 10.0 * (sums.variance / sums.noise).log10(),
            spikes_per_second: seconds
                .filter(|seconds| *seconds > 0.0)
                .map(|seconds| sums.spikes as f64 / seconds),
            brief: brief(parameters),
            parameters: parameters.iter().map(|(key, value)| (*key, json(value))).collect(),
            slope,
            notes,
        }
    }
}

/// The figures of schemes on one channel of a recording.
#[derive(Debug)]
pub struct Scored {
    /// Name of the channel.
    pub channel: String,
    /// Notes for the user on the recording.
    pub notes: Vec<Words>,
    /// The figures of each scheme, or the reason that the scheme cannot encode the recording.
    pub schemes: Vec<(Scheme, Result<Figures>)>,
}

/// Scores schemes on one channel of a recording. The file is read twice, in constant memory: the first pass finds mean,
/// range and quantiles. Standard input and pipes, which can be read only once, are held in memory. The figures are the
/// same. In both cases the usual step of the times, by which gaps and restarts of the clock are found, is that of the
/// first [`CHUNK`] samples, as for [`encode`](crate::encode).
///
/// # Errors
/// Returns an error if the input cannot be read, has several channels, or has no finite sample.
pub fn score(
    input: &InputOptions,
    schemes: &[Scheme],
    asked: &Asked,
    sample: SampleType,
) -> Result<Scored> {
    if input.is_read_once() {
        let recording = Recording::read(input)?;
        let figures = |scheme: &Scheme| {
            let trial = Trial::new(*scheme, asked, sample, &recording);
            (*scheme, trial.map(|trial| Figures::of(&recording, &trial)))
        };
        let schemes = schemes.iter().map(figures).collect();
        return Ok(Scored { channel: recording.name.clone(), notes: recording.notes(), schemes });
    }
    input.single("this command")?;
    let looks_back = schemes.iter().map(|scheme| scheme.looks_back(asked)).max().unwrap_or(0);
    let First { calibrated, mean, values } = First::read(input, asked, sample, looks_back)?;
    let known = (&calibrated, mean);
    let mut all: Vec<Result<Measure>> =
        schemes.iter().map(|scheme| Measure::new(*scheme, asked, sample, known, &values)).collect();
    let (mut source, mut chunk) = (input.open()?, Chunk::default());
    source.next(&mut chunk)?;
    let mut clock = Clock::new(&chunk.times, input.rate, input.gap);
    let is_timed = !chunk.times.is_empty();
    let (mut read, mut samples) = (0, 0);
    while !chunk.is_empty() {
        let rows = chunk.finite_rows();
        let column = chunk.columns.first().map_or(&[][..], Vec::as_slice);
        let mut start = 0;
        let steps = clock.observe(&chunk.times);
        let restarts = steps.iter().filter(|step| step.kind == Kind::Restart);
        let ends = restarts.map(|step| ((step.after + 1 - read) as usize, true));
        for (end, is_restart) in ends.chain([(rows.len(), false)]) {
            let own = column[start..end].iter().zip(&rows[start..end]);
            let finite: Vec<f64> = own.filter(|(_, row)| **row).map(|(value, _)| *value).collect();
            samples += finite.len();
            each(&mut all, |measure| measure.observe(&finite, &mut |_, _| ()));
            if is_restart {
                each(&mut all, |measure| measure.end_segment(&mut |_, _| ()));
            }
            start = end;
        }
        read += rows.len() as u64;
        source.next(&mut chunk)?;
    }
    each(&mut all, |measure| measure.end_segment(&mut |_, _| ()));
    let rate = clock.rate();
    let seconds =
        if is_timed { Some(clock.seconds()) } else { rate.map(|rate| samples as f64 / rate) };
    let figures = |scheme: Scheme, measure: &Measure| {
        let about = (measure.slope(rate), measure.notes());
        Figures::new(scheme, measure.settings(), measure.sums(), seconds, about)
    };
    Ok(Scored {
        channel: source.names().first().copied().unwrap_or_default().to_owned(),
        notes: notes(source.notes(), read as usize - samples, &clock),
        schemes: schemes
            .iter()
            .zip(all)
            .map(|(scheme, own)| (*scheme, own.map(|own| figures(*scheme, &own))))
            .collect(),
    })
}

/// Results of a first pass over one channel of a recording.
struct First {
    calibrated: Calibrated,
    mean: f64,
    /// The first finite samples.
    values: Vec<f64>,
}

impl First {
    /// Reads the recording; keeps the first `count` finite samples, and [`CHUNK`] at least.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, or has no finite sample.
    fn read(input: &InputOptions, asked: &Asked, sample: SampleType, count: usize) -> Result<Self> {
        let mut calibrated = Calibrated::of(sample, asked);
        let (mut values, mut sum, mut finite, mut samples) = (Vec::new(), 0.0, 0, 0);
        let (mut source, mut chunk) = (input.open()?, Chunk::default());
        loop {
            source.next(&mut chunk)?;
            if chunk.is_empty() {
                break;
            }
            let own = chunk.kept(&chunk.finite_rows()).into_iter().next().unwrap_or_default();
            calibrated.observe(&own);
            sum = own.iter().fold(sum, |sum, value| sum + value);
            let missing = count.max(CHUNK).saturating_sub(values.len());
            values.extend(own.iter().take(missing));
            finite += own.len();
            samples += chunk.len();
        }
        if values.is_empty() {
            return Err(TableKind::NoneFinite { samples }.at(input.name()));
        }
        Ok(Self { calibrated, mean: sum / finite as f64, values })
    }
}

/// Calls `work` on every measurement that has not failed, in parallel.
fn each<'a>(all: &mut [Result<Measure<'a>>], work: impl Fn(&mut Measure<'a>) -> Result<()> + Sync) {
    all.par_iter_mut().for_each(|own| {
        if let Ok(measure) = own
            && let Err(error) = work(measure)
        {
            *own = Err(error);
        }
    });
}
