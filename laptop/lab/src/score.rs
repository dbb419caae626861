//! Scores a trial: counts its spikes, and measures the error of the decoded values.

use crate::brief::{brief, json};
use crate::slope::Slope;
use crate::trial::{Recording, Trial};
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
    /// Computes the figures of a trial. The trial's decoded values are compared with the samples of the recording.
    pub fn of(recording: &Recording, trial: &Trial) -> Self {
        let samples = recording.values.len();
        let mean = recording.values.iter().sum::<f64>() / samples as f64;
        let mean_square = |differences: &mut dyn Iterator<Item = f64>| {
            differences.map(|difference| difference * difference).sum::<f64>() / samples as f64
        };
        let noise =
            mean_square(&mut recording.values.iter().zip(&trial.decoded).map(|(x, y)| x - y));
        let variance = mean_square(&mut recording.values.iter().map(|x| x - mean));
        let parameters = trial.settings.entries();
        Self {
            scheme: trial.scheme.name().to_owned(),
            samples,
            spikes: trial.events.len(),
            efficiency: trial.efficiency(),
            rmse: noise.sqrt(),
            snr: 10.0 * (variance / noise).log10(),
            spikes_per_second: recording
                .seconds()
                .filter(|seconds| *seconds > 0.0)
                .map(|seconds| trial.events.len() as f64 / seconds),
            brief: brief(parameters),
            parameters: parameters.iter().map(|(key, value)| (*key, json(value))).collect(),
            slope: Slope::new(trial.scheme, recording, &trial.settings),
            notes: trial.notes.clone(),
        }
    }
}
