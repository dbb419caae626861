//! Whether a sample type and the parameters suit a recording.

use crate::brief::short;
use crate::scheme::Scheme;
use catalogue::run::{Ran, SampleType, Settings};
use std::fmt::Write;

/// The range of a channel's samples, and how many of them a type cannot hold or a code not reach.
pub(crate) struct Fit {
    scheme: Scheme,
    sample: SampleType,
    min: f64,
    max: f64,
    samples: u64,
    saturated: u64,
    reach: Option<f64>,
    beyond: u64,
}

impl Fit {
    /// For a channel that has no samples yet.
    pub(crate) fn new(scheme: Scheme, sample: SampleType, settings: &Settings) -> Self {
        // A rate code adds up its filters on its shift.
        let reach = settings
            .number("shift")
            .zip(settings.numbers("taps"))
            .map(|(shift, taps)| shift + taps.iter().filter(|tap| **tap > 0.0).sum::<f64>());
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { scheme, sample, min, max, samples: 0, saturated: 0, reach, beyond: 0 }
    }

    /// Takes the next samples, all finite.
    pub(crate) fn observe(&mut self, values: &[f64]) {
        let (low, high) = self.sample.range();
        let reach = self.reach.unwrap_or(f64::INFINITY);
        for &value in values {
            self.min = self.min.min(value);
            self.max = self.max.max(value);
            self.saturated += u64::from(value < low || value > high);
            self.beyond += u64::from(value > reach);
        }
        self.samples += values.len() as u64;
    }

    /// What a user should know, a line each.
    pub(crate) fn notes(&self, settings: &Settings, spikes: u64) -> String {
        let mut notes = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut notes, settings, spikes);
        notes
    }

    fn write(&self, notes: &mut String, settings: &Settings, spikes: u64) -> std::fmt::Result {
        /// A signal of fewer steps is mostly rounding.
        const STEPS: f64 = 16.0;
        let Self { sample, min, max, samples, saturated, .. } = *self;
        if samples == 0 {
            return Ok(());
        }
        if saturated > 0 {
            let (low, high) = sample.range();
            writeln!(
                notes,
                "{saturated} samples were cut to the range of {sample}, {low} to {high}"
            )?;
        }
        let range = max - min;
        let said =
            format!("the signal's range, {} ({} to {})", short(range), short(min), short(max));
        let step = sample.step();
        if range > 0.0 && range < STEPS * step {
            writeln!(
                notes,
                "{said}, is {} steps of {sample}, whose step is {step}: a type with more bits after the \
                 point, or f32, would suit it",
                short(range / step)
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

/// The threshold of a code that spikes on changes.
fn threshold(scheme: Scheme, settings: &Settings) -> Option<f64> {
    settings.number("threshold").filter(|_| scheme.info().has_first_value)
}

/// The settings that a type runs with, and what of them was rounded, in words.
///
/// # Errors
/// A parameter that becomes 0 or makes no sense, in words.
pub(crate) fn rounded(
    scheme: Scheme,
    sample: SampleType,
    settings: &Settings,
) -> anyhow::Result<(Settings, Option<String>)> {
    let (rounded, all) = scheme.rounded(sample, settings)?;
    let (mut told, mut lists) = (Vec::new(), Vec::new());
    for Ran { name, asked, ran } in all {
        match (&asked[..], &ran[..]) {
            // Samples are rounded like that, too.
            _ if ["start", "first"].contains(&name) => {}
            ([asked], [ran]) => told.push(format!("{name} {} ran as {ran}", short(*asked))),
            _ => {
                let off = asked.iter().zip(&ran).map(|(asked, ran)| (asked - ran).abs());
                let count = off.clone().filter(|off| *off > 0.0).count();
                let most = short(off.fold(0.0, f64::max));
                lists.push(format!("{count} {name} were rounded by at most {most}"));
            }
        }
    }
    told.extend(lists);
    Ok((rounded, (!told.is_empty()).then(|| format!("in {sample}, {}", told.join(", ")))))
}
