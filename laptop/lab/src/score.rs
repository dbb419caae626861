//! Scores a trial: counts its spikes, and measures the error of the decoded values.

use crate::Result;
use crate::brief::{brief, json};
use crate::flight::{self, Filtering, Flight};
use crate::input::InputOptions;
use crate::measure::{Measure, Sums};
use crate::passes::{First, each, pass};
use crate::scheme::Scheme;
use crate::slope::Slope;
use crate::trial::{Recording, Trial};
use catalogue::run::{Asked, SampleType, Settings, Words};
use serde::Serialize;
use serde_json::Value;
use spikewire::ConfigError;
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

/// Scores the channels of a flight on a recording: as its sender encodes them, behind its filter. The error is that against
/// the filtered signal, in the channels' units.
///
/// # Errors
/// Returns an error if the recording cannot be read or lacks a channel, or if the scheme cannot encode it.
pub fn score_flight(flight: &Flight, input: &InputOptions) -> Result<Vec<Scored>> {
    let scheme = Scheme::from(flight.run_time());
    let rate = flight.rate() as f32;
    let mut all = Vec::new();
    let recordings = Recording::read_all(&flight::input(flight, input)?)?;
    for (recording, channel) in recordings.iter().zip(&flight.channels) {
        let counts = channel.counts;
        let mut heard = recording.filtered(|| |value| value * counts);
        if let Some(filter) = flight.filter {
            let start = |_| filter.start(flight.sample, rate);
            let filters: Vec<Filtering> = heard
                .segments
                .iter()
                .map(start)
                .collect::<Result<_, ConfigError>>()
                .map_err(catalogue::run::Error::from)?;
            // A filter for each segment, as the sender starts anew after a gap.
            let mut filters = filters.into_iter();
            heard = heard.filtered(|| filters.next().unwrap_or_else(|| Box::new(|value| value)));
        }
        let trial = Trial::new(scheme, &flight.asked(channel), flight.sample, &heard)?;
        let mut figures = Figures::of(&heard, &trial);
        figures.rmse /= counts;
        if (counts - 1.0).abs() > 0.0 {
            figures.slope = None; // it is in counts
        }
        if flight.filter.is_some() {
            let what = "the RMSE is that against the samples behind the flight's filter";
            figures.notes.push(what.to_owned());
        }
        all.push(Scored {
            channel: channel.name.clone(),
            notes: recording
                .notes()
                .into_iter()
                .chain(flight::other_rate(flight, recording.rate))
                .collect(),
            schemes: vec![(scheme, Ok(figures))],
        });
    }
    Ok(all)
}

/// Scores schemes on one channel of a recording. The file is read twice, in constant memory: the first pass finds mean,
/// range and quantiles. Standard input and pipes, which can be read only once, are held in memory. The figures are the
/// same. In both cases the usual step of the times, by which gaps and restarts of the clock are found, is that of the
/// first [`CHUNK`](crate::input::CHUNK) samples, as for [`encode`](crate::encode).
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
    let (first, _) = First::read(input, schemes, asked, sample, |_| ())?;
    let mut all: Vec<Result<Measure>> =
        schemes.iter().map(|scheme| first.measure(*scheme, asked, sample)).collect();
    let passed = pass(input, |piece| {
        each(&mut all, |measure| measure.observe(piece.values, &mut |_, _| ()));
        if piece.is_end {
            each(&mut all, |measure| measure.end_segment(&mut |_, _| ()));
        }
    })?;
    let (rate, seconds) = (passed.rate(), passed.seconds());
    let figures = |scheme: Scheme, measure: &Measure| {
        let about = (measure.slope(rate), measure.notes());
        Figures::new(scheme, measure.settings(), measure.sums(), seconds, about)
    };
    Ok(Scored {
        channel: passed.channel,
        notes: passed.notes,
        schemes: schemes
            .iter()
            .zip(all)
            .map(|(scheme, own)| (*scheme, own.map(|own| figures(*scheme, &own))))
            .collect(),
    })
}
