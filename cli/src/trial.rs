//! A recording there and back, for looking at and for scoring.

use crate::codec::{Calibrated, Codec, Event};
use crate::input::{Chunk, Clock, InputOptions};
use crate::options::SchemeOptions;
use crate::resolve::{Known, resolve};
use crate::sample_type::SampleType;
use crate::saturated::Saturated;
use crate::scheme::SchemeName;
use crate::settings::Settings;
use anyhow::{Result, anyhow, bail};

/// A recording in memory.
pub(crate) struct Recording {
    /// Its finite samples.
    pub values: Vec<f64>,
    /// Their times in µs, if recorded.
    pub times: Vec<i64>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
    /// How many samples were not finite.
    rejected: usize,
    clock: Clock,
}

impl Recording {
    /// Reads all of it.
    ///
    /// # Errors
    /// As reading does, or no finite sample.
    pub(crate) fn read(input: &InputOptions) -> Result<Self> {
        let Chunk { mut values, mut times } = input.read_all()?;
        let mut clock = Clock::new(&times, input.rate, input.gap);
        clock.observe(&times);
        let all = values.len();
        if !times.is_empty() {
            let mut is_finite = values.iter().map(|value| value.is_finite());
            times.retain(|_| is_finite.next().unwrap_or(false));
        }
        values.retain(|value| value.is_finite());
        if values.is_empty() {
            bail!("{}: no finite sample", input.input.display());
        }
        Ok(Self { rejected: all - values.len(), values, times, rate: clock.rate(), clock })
    }

    /// What a user should know of it in this sample type, a line each.
    pub(crate) fn notes(&self, sample: SampleType) -> String {
        let rejected = match self.rejected {
            0 => String::new(),
            count => format!("{count} samples were not finite and emitted nothing\n"),
        };
        let mut saturated = Saturated::new(sample);
        saturated.observe(&self.values);
        format!("{rejected}{saturated}{}\n", self.clock)
    }

    /// How long it is in seconds, if that is known.
    pub(crate) fn seconds(&self) -> Option<f64> {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => Some((last - first) as f64 * 1e-6),
            _ => Some(self.values.len() as f64 / self.rate?),
        }
    }
}

/// What a scheme made of a recording.
pub(crate) struct Trial {
    /// The scheme.
    pub scheme: SchemeName,
    /// Its parameters.
    pub settings: Settings,
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
        scheme: SchemeName,
        options: &SchemeOptions,
        sample: SampleType,
        recording: &Recording,
    ) -> Result<Self> {
        let mut calibrated = Calibrated::new(sample);
        calibrated.observe(&recording.values);
        let known =
            Known { calibrated: Some(&calibrated), first: &recording.values, can_calibrate: true };
        let settings = resolve(scheme, options, known)?;
        let mut codec = Codec::new(sample, &settings)?;
        let (mut events, mut decoded) = (Vec::new(), Vec::new());
        codec.encode(&recording.values, &mut events);
        codec.finish(&mut events);
        codec.decode(recording.values.len(), &events, &mut decoded).map_err(|event| {
            anyhow!("{}: sample {} does not decode", scheme.name(), event.sample)
        })?;
        Ok(Self { scheme, settings, events, decoded })
    }

    /// `(1 - spikes / samples) * 100`.
    pub(crate) fn efficiency(&self) -> f64 {
        (1.0 - self.events.len() as f64 / self.decoded.len() as f64) * 100.0
    }
}
