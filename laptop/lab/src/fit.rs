//! Checks whether a sample type and parameters suit a recording.

use crate::Error;
use crate::brief::short;
use crate::resolution::{Resolution, held};
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use catalogue::run::{SampleType, Settings};
use std::fmt::Write;

/// Statistics of a channel: the range, the resolution, the number of samples that the sample type clamps, the number
/// outside the code's own range, and the number above the largest value that the code can represent.
pub struct Fit {
    scheme: Scheme,
    sample: SampleType,
    min: f64,
    max: f64,
    samples: u64,
    resolution: Resolution,
    saturated: u64,
    range: Option<Range>,
    outside: u64,
    reach: Option<f64>,
    beyond: u64,
}

impl Fit {
    /// Makes the statistics of a channel that has no samples yet.
    pub fn new(scheme: Scheme, settings: &Settings) -> Self {
        // A rate code's largest value is the sum of its taps above its shift.
        let reach = settings
            .number("shift")
            .ok()
            .zip(settings.numbers("taps").ok())
            .map(|(shift, taps)| shift + taps.iter().filter(|tap| **tap > 0.0).sum::<f64>());
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self {
            scheme,
            sample: settings.sample,
            min,
            max,
            samples: 0,
            resolution: Resolution::new(settings.sample),
            saturated: 0,
            range: Range::of(settings),
            outside: 0,
            reach,
            beyond: 0,
        }
    }

    /// Adds the next samples, which must be finite.
    pub fn observe(&mut self, values: &[f64]) {
        let (low, high) = self.sample.range();
        let reach = self.reach.unwrap_or(f64::INFINITY);
        for &value in values {
            self.min = self.min.min(value);
            self.max = self.max.max(value);
            self.saturated += u64::from(value < low || value > high);
            self.outside += u64::from(self.range.is_some_and(|range| !range.holds(value)));
            self.beyond += u64::from(value > reach);
        }
        self.samples += values.len() as u64;
        self.resolution.observe(values);
    }

    /// Returns notes for the user, a line each. `spikes` is the number of spikes that the channel emitted.
    pub fn notes(&self, settings: &Settings, spikes: u64) -> String {
        let mut notes = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut notes, settings, spikes);
        notes
    }

    fn write(&self, notes: &mut String, settings: &Settings, spikes: u64) -> std::fmt::Result {
        /// Smallest number of quantisation steps that a signal's range should span. A signal that spans fewer steps is
        /// mostly rounding noise.
        const STEPS: f64 = 16.0;
        let Self { sample, min, max, samples, saturated, .. } = *self;
        if samples == 0 {
            return Ok(());
        }
        if let Some(cut) = cut(sample, saturated) {
            writeln!(notes, "{cut}")?;
        }
        if let Some(outside) = self.range.and_then(|own| own.outside(self.outside, samples)) {
            writeln!(notes, "{outside}")?;
        }
        let range = max - min;
        let said =
            format!("the signal's range, {} ({} to {})", short(range), short(min), short(max));
        let step = sample.step();
        if let Some(lost) = self.resolution.lost() {
            writeln!(notes, "{lost}")?;
        } else if range > 0.0 && range < STEPS * step && self.resolution.is_rounded() {
            writeln!(
                notes,
                "{said}, is {} steps of {sample}, whose step is {step}; {}",
                short(range / step),
                self.resolution.holders()
            )?;
        }
        if let (0, Some(threshold)) = (spikes, threshold(self.scheme, settings))
            && threshold >= range
        {
            writeln!(notes, "no spike: the threshold, {}, is above {said}", short(threshold))?;
        }
        if let (1.., Some(reach)) = (self.beyond, self.reach) {
            writeln!(
                notes,
                "{} of {samples} samples are above {}, the shift and the filter's sum, which is the most \
                 that the code can mean: it decodes too low there; after a shape, `,sum={}` reaches the maximum",
                self.beyond,
                short(reach),
                short(range),
            )?;
        }
        Ok(())
    }
}

/// The range `min` to `max` of a code that spreads it over its neurons, its times or its chances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    min: f64,
    max: f64,
    sample: SampleType,
}

impl Range {
    /// Makes the range of a code that computes in this sample type.
    pub fn new(sample: SampleType, min: f64, max: f64) -> Self {
        Self { min: held(sample, min), max: held(sample, max), sample }
    }

    /// Returns the range of a code with these settings; `None` if the code has no range.
    pub fn of(settings: &Settings) -> Option<Self> {
        let (min, max) = (settings.number("min").ok()?, settings.number("max").ok()?);
        Some(Self::new(settings.sample, min, max))
    }

    /// Returns whether the value lies in the range once the sample type has rounded it, as it rounded the ends.
    pub fn holds(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&held(self.sample, value))
    }

    /// Returns a sentence which says that `count` of the samples lie outside the range, or `None` if `count` is 0.
    pub fn outside(&self, count: u64, samples: u64) -> Option<String> {
        let Self { min, max, .. } = *self;
        let percent = short(count as f64 * 100.0 / samples as f64);
        (count > 0).then(|| {
            format!(
                "{count} of {samples} samples, {percent} %, lie outside the code's range, min {} to max {}: the \
                 code clamps them or is silent there",
                short(min),
                short(max)
            )
        })
    }
}

/// Returns the threshold of a code that spikes when the signal changes; `None` for other codes.
fn threshold(scheme: Scheme, settings: &Settings) -> Option<f64> {
    settings.number("threshold").ok().filter(|_| scheme.info().has_first_value())
}

/// Returns a sentence which says that the sample type clamped `count` samples, or `None` if `count` is 0.
pub fn cut(sample: SampleType, count: u64) -> Option<String> {
    let (low, high) = sample.range();
    (count > 0)
        .then(|| format!("{count} samples were cut to the range of {sample}, {low} to {high}"))
}

/// Returns a sentence that names the parameters which the sample type rounded, or `None` if it rounded no parameter.
pub fn rounding(settings: &Settings) -> Option<String> {
    let (mut words, mut lists) = (Vec::new(), Vec::new());
    for (name, asked) in &settings.rounded {
        let (Some(asked), Ok(ran)) = (asked.numbers(), settings.numbers(name)) else { continue };
        match (asked, ran) {
            // A start value is rounded as every sample is, which needs no note.
            _ if ["start", "first"].contains(name) => {}
            ([asked], [ran]) => words.push(format!("{name} {} ran as {ran}", short(*asked))),
            _ => {
                let off = asked.iter().zip(ran).map(|(asked, ran)| (asked - ran).abs());
                let count = off.clone().filter(|off| *off > 0.0).count();
                let most = short(off.fold(0.0, f64::max));
                lists.push(format!("{count} {name} were rounded by at most {most}"));
            }
        }
    }
    words.extend(lists);
    (!words.is_empty()).then(|| format!("in {}, {}", settings.sample, words.join(", ")))
}

/// Adds a likely reason to an error about settings: the sample type is too coarse for the differences between
/// consecutive values. Returns the error unchanged if the sample type is fine enough.
pub fn explained(error: Error, sample: SampleType, values: &[f64]) -> Error {
    match Resolution::of(sample, values).lost() {
        Some(why) => {
            let parameter = error.parameter.clone();
            let kind = RequestKind::NotHeld { why, error: Box::new(error) };
            Error { parameter, ..kind.into() }
        }
        None => error,
    }
}
