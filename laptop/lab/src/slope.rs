//! Checks whether a step code keeps up with a recording. The decoded value of a step code changes by at most one step
//! from sample to sample.

use crate::brief::short;
use crate::scheme::Scheme;
use crate::trial::Recording;
use catalogue::run::Settings;
use serde::Serialize;

/// The largest slope of a recording, compared with the largest slope that a code can follow.
#[derive(Clone, Debug, Serialize)]
pub struct Slope {
    /// Name of the scheme.
    #[serde(skip)]
    scheme: &'static str,
    /// Whether the code can follow the signal: no change from one sample to the next exceeds the threshold.
    follows: bool,
    /// Number of samples at which the signal changes by more than the threshold.
    steps_above_threshold: usize,
    /// `steps_above_threshold` as a share of the samples.
    part: f64,
    /// Largest slope that the code can follow: the threshold times the sample rate, or the threshold if the rate is
    /// unknown.
    fastest: f64,
    /// Largest slope of the signal, per second. If the sample rate is unknown, the slope is per sample.
    steepest: f64,
    /// Unit of time of `fastest` and `steepest`: `second` or `sample`.
    per: &'static str,
}

impl Slope {
    /// Compares the largest slope of the recording with the largest slope that the code can follow. Returns `None` if
    /// the decoded value of the code can move by more than one step from sample to sample.
    pub fn new(scheme: Scheme, recording: &Recording, settings: &Settings) -> Option<Self> {
        let threshold = settings.number(scheme.info().climbs_by?).ok()?;
        let segments = recording.segments.iter().map(|own| &recording.values[own.clone()]);
        let steps = segments.flat_map(|own| own.windows(2)).map(|pair| (pair[1] - pair[0]).abs());
        let above = steps.clone().filter(|step| *step > threshold).count();
        let (rate, per) = recording.rate.map_or((1.0, "sample"), |rate| (rate, "second"));
        Some(Self {
            scheme: scheme.name(),
            follows: above == 0,
            steps_above_threshold: above,
            part: above as f64 / recording.values.len() as f64,
            fastest: threshold * rate,
            steepest: steps.fold(0.0, f64::max) * rate,
            per,
        })
    }

    /// Returns the share of samples at which the signal changes by more than the threshold. The code cannot follow such
    /// a change.
    pub fn part(&self) -> f64 {
        self.part
    }

    /// Returns a sentence for the user. The sentence compares the signal's largest slope with the largest slope that
    /// the code can follow.
    pub fn words(&self) -> String {
        const FEW: f64 = 0.1;
        let Self { scheme, steps_above_threshold: above, part, per, .. } = self;
        let (fastest, steepest) = (short(self.fastest), short(self.steepest));
        if self.follows {
            return format!(
                "{scheme} follows this signal: it climbs up to {fastest} a {per}, the signal {steepest}"
            );
        }
        let percent = short((part * 1e4).round() / 1e2);
        let verdict = if *part > FEW {
            "cannot follow this signal"
        } else {
            "follows this signal but for short stretches"
        };
        format!(
            "{scheme} {verdict}: it climbs up to {fastest} a {per}, the signal {steepest}; {above} steps, {percent} % of \
             the samples, are larger than the threshold"
        )
    }
}
