//! Encodes and decodes a recording as it is read, and measures the error of the decoded values.

use crate::Result;
use crate::brief::short;
use crate::fit::{Fit, explained, rounding};
use crate::scheme::Scheme;
use crate::slope::{Slope, Steps};
use crate::tune::RequestKind;
use catalogue::run::{Asked, Calibrated, Codec, Event, Known, SampleType, Settings};

/// A scheme on a recording whose samples come in pieces. Each segment of the recording has a new codec. Memory does not
/// grow with the recording.
pub(crate) struct Measure<'a> {
    scheme: Scheme,
    sample: SampleType,
    asked: Asked,
    calibrated: &'a Calibrated,
    /// Mean of all samples of the recording.
    mean: f64,
    /// Number of samples that the scheme needs to begin a segment.
    looks_back: usize,
    settings: Settings,
    fit: Fit,
    steps: Option<Steps>,
    codec: Option<Codec>,
    latency: usize,
    /// Index of the segment's first sample in the recording.
    start: u64,
    /// Number of samples of the segment that are decoded.
    done: u64,
    /// Samples of the segment that are not decoded yet, and their events so far.
    pending: Vec<f64>,
    events: Vec<Event>,
    /// Buffer for decoded values.
    decoded: Vec<f64>,
    sums: Sums,
}

/// Sums over the samples of a recording.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) samples: usize,
    pub(crate) spikes: usize,
    /// Sum of the squares of the errors.
    pub(crate) noise: f64,
    /// Sum of the squares of the differences from the mean.
    pub(crate) variance: f64,
    /// Sum of the differences between decoded values and samples.
    off: f64,
}

/// A function that receives the next events, with sample indices of the recording, and the next decoded values.
type Take<'a> = dyn FnMut(&[Event], &[f64]) + 'a;

impl<'a> Measure<'a> {
    /// Makes a measurement of a recording without samples yet. `mean` and `calibrated` are those of the whole
    /// recording, and `first` holds its first samples.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid.
    pub(crate) fn new(
        scheme: Scheme,
        asked: &Asked,
        sample: SampleType,
        (calibrated, mean): (&'a Calibrated, f64),
        first: &[f64],
    ) -> Result<Self> {
        let asked = asked.channel(scheme.info(), 0, 1)?;
        let settings = resolved(scheme, sample, &asked, calibrated, first)?;
        Ok(Self {
            scheme,
            sample,
            calibrated,
            mean,
            looks_back: scheme.looks_back(&asked).max(1),
            fit: Fit::new(scheme, &settings),
            steps: Steps::new(scheme, &settings),
            asked,
            settings,
            codec: None,
            latency: 0,
            start: 0,
            done: 0,
            pending: Vec::new(),
            events: Vec::new(),
            decoded: Vec::new(),
            sums: Sums::default(),
        })
    }

    /// Adds the next samples of the segment, which must be finite.
    ///
    /// # Errors
    /// Returns an error if the codec cannot decode its own events.
    pub(crate) fn observe(&mut self, values: &[f64], take: &mut Take) -> Result<()> {
        self.fit.observe(values);
        if let Some(steps) = &mut self.steps {
            steps.observe(values);
        }
        self.pending.extend_from_slice(values);
        match &mut self.codec {
            Some(codec) => {
                codec.encode(values, &mut self.events);
                self.decode(self.pending.len().saturating_sub(self.latency), take)
            }
            None if self.pending.len() < self.looks_back => Ok(()),
            None => self.begin(take),
        }
    }

    /// Begins a segment with the pending samples.
    fn begin(&mut self, take: &mut Take) -> Result<()> {
        let Self { scheme, sample, asked, calibrated, .. } = self;
        let settings = resolved(*scheme, *sample, asked, calibrated, &self.pending)?;
        let mut codec = scheme.codec(&settings)?;
        codec.encode(&self.pending, &mut self.events);
        self.latency = codec.latency();
        self.codec = Some(codec);
        self.decode(self.pending.len().saturating_sub(self.latency), take)
    }

    /// Ends the segment: encodes and decodes the pending samples.
    ///
    /// # Errors
    /// Returns an error if the codec cannot decode its own events.
    pub(crate) fn end_segment(&mut self, take: &mut Take) -> Result<()> {
        if self.codec.is_none() && !self.pending.is_empty() {
            self.begin(take)?;
        }
        if let Some(codec) = &mut self.codec {
            codec.finish(&mut self.events);
        }
        self.decode(self.pending.len(), take)?;
        if let Some(steps) = &mut self.steps {
            steps.end_segment();
        }
        self.codec = None;
        self.start += self.done;
        self.done = 0;
        Ok(())
    }

    /// Decodes the first `count` pending samples, whose events are complete.
    fn decode(&mut self, count: usize, take: &mut Take) -> Result<()> {
        let Some(codec) = &mut self.codec else { return Ok(()) };
        let start = self.start;
        self.decoded.clear();
        codec.decode(count, &self.events, &mut self.decoded).map_err(|event| {
            let sample = start + event.sample;
            RequestKind::NotDecoded { scheme: self.scheme.name(), sample }
        })?;
        self.done += count as u64;
        let end = self.events.partition_point(|event| event.sample < self.done);
        self.events[..end].iter_mut().for_each(|event| event.sample += start);
        take(&self.events[..end], &self.decoded);
        let sums = &mut self.sums;
        for (value, decoded) in self.pending.drain(..count).zip(&self.decoded) {
            sums.noise += (value - decoded) * (value - decoded);
            sums.variance += (value - self.mean) * (value - self.mean);
            sums.off += decoded - value;
        }
        sums.samples += count;
        sums.spikes += self.events.drain(..end).len();
        Ok(())
    }

    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the number of samples by which the encoder's output lags behind its input.
    pub(crate) fn latency(&self) -> usize {
        self.latency
    }

    pub(crate) fn sums(&self) -> Sums {
        self.sums
    }

    /// Compares the largest slope of the signal with the largest slope that the code can follow, if there is one.
    pub(crate) fn slope(&self, rate: Option<f64>) -> Option<Slope> {
        self.steps.as_ref().map(|steps| steps.slope(rate))
    }

    /// Returns notes for the user on whether the parameters suit the recording.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = rounding(&self.settings).into_iter().collect();
        let suits = self.fit.notes(&self.settings, self.sums.spikes as u64);
        notes.extend(suits.lines().map(str::to_owned));
        notes.extend(self.sums.low());
        notes
    }
}

impl Sums {
    /// Returns the spiking efficiency, `(1 - spikes / samples) * 100`, in percent.
    pub(crate) fn efficiency(&self) -> f64 {
        (1.0 - self.spikes as f64 / self.samples as f64) * 100.0
    }

    /// Compares the mean of the decoded values with the mean of the signal. Returns a note if the two means differ by
    /// more than the signal's standard deviation.
    fn low(&self) -> Option<String> {
        let deviation = (self.variance / self.samples as f64).sqrt();
        let off = self.off / self.samples as f64;
        (off.abs() > deviation).then(|| {
            let direction = if off < 0.0 { "low" } else { "high" };
            format!(
                "decodes {} too {direction} on average, where the signal's own deviation is {}",
                short(off.abs()),
                short(deviation)
            )
        })
    }
}

/// Returns the settings of a segment that begins with the samples `first`.
fn resolved(
    scheme: Scheme,
    sample: SampleType,
    asked: &Asked,
    calibrated: &Calibrated,
    first: &[f64],
) -> Result<Settings> {
    let known = Known { calibrated: Some(calibrated), first, can_calibrate: true };
    let settings = scheme.resolve(sample, asked, &known);
    settings.map_err(|error| explained(error.into(), sample, first))
}

#[cfg(test)]
mod tests {
    use super::{Measure, resolved};
    use crate::scheme::Scheme;
    use catalogue::run::{Asked, Calibrated, Event, SampleType};

    /// A recording that comes in pieces has the events and values that one codec gives for the whole.
    #[test]
    fn pieces_are_measured_as_the_whole() {
        let values: Vec<f64> = (0..1500).map(|sample| (f64::from(sample) * 0.05).sin()).collect();
        let (sample, mut asked) = (SampleType::F32, Asked::default());
        asked.paper = true;
        let mut calibrated = Calibrated::of(sample, &asked);
        calibrated.observe(&values);
        for scheme in Scheme::all() {
            let own = asked.channel(scheme.info(), 0, 1).unwrap();
            let settings = resolved(scheme, sample, &own, &calibrated, &values).unwrap();
            let mut codec = scheme.codec(&settings).unwrap();
            let (mut events, mut decoded) = (Vec::new(), Vec::new());
            codec.encode(&values, &mut events);
            codec.finish(&mut events);
            codec.decode(values.len(), &events, &mut decoded).unwrap();
            for length in [1, 7, values.len()] {
                let known = (&calibrated, 0.0);
                let mut measure = Measure::new(scheme, &asked, sample, known, &values).unwrap();
                let (mut all, mut follows) = (Vec::new(), Vec::new());
                let mut take = |new: &[Event], values: &[f64]| {
                    all.extend_from_slice(new);
                    follows.extend_from_slice(values);
                };
                for piece in values.chunks(length) {
                    measure.observe(piece, &mut take).unwrap();
                }
                measure.end_segment(&mut take).unwrap();
                assert_eq!(all, events, "{} {length}", scheme.name());
                assert_eq!(follows, decoded, "{} {length}", scheme.name());
            }
        }
    }
}
