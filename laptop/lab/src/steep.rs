//! Whether a code that climbs by a step a sample at most keeps up with a recording.

use crate::brief::short;
use crate::scheme::Scheme;
use crate::trial::Recording;
use catalogue::run::Settings;
use serde::Serialize;

/// The slope of a recording, beside that which the code follows.
#[derive(Clone, Debug, Serialize)]
pub struct Steep {
    /// The scheme.
    #[serde(skip)]
    scheme: &'static str,
    /// Whether no step from sample to sample is larger than the threshold.
    follows: bool,
    /// The number of steps that are larger.
    steps_above_threshold: usize,
    /// That number as a part of the samples.
    part: f64,
    /// Threshold times rate, or the threshold where no rate is known.
    fastest: f64,
    /// The steepest slope of the signal, likewise.
    steepest: f64,
    /// The unit of both slopes' denominator: `second` or `sample`.
    per: &'static str,
}

impl Steep {
    /// The slopes of a code that climbs by a step a sample at most; `None` for others.
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

    /// The part of the samples at which the signal takes a larger step than the code can.
    pub fn part(&self) -> f64 {
        self.part
    }

    /// A sentence on both slopes.
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
