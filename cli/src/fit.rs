//! Whether a sample type and the parameters suit a recording.

use crate::brief::short;
use crate::sample_type::{SampleType, for_sample_type};
use crate::settings::{Rate, Settings};
use spikewire::Sample;
use std::fmt::Write;

/// The range of a channel's samples, and how many of them a type cannot hold or a code not reach.
pub(crate) struct Fit {
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
    pub(crate) fn new(sample: SampleType, settings: &Settings) -> Self {
        let reach = match settings {
            Settings::Rate(Rate { taps, shift, .. }) => {
                Some(shift + taps.iter().filter(|tap| **tap > 0.0).sum::<f64>())
            }
            _ => None,
        };
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { sample, min, max, samples: 0, saturated: 0, reach, beyond: 0 }
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
        if let (0, Some(threshold)) = (spikes, threshold(settings))
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
fn threshold(settings: &Settings) -> Option<f64> {
    match settings {
        Settings::Contrast(contrast) => Some(contrast.threshold),
        Settings::StepForward(step_forward) => Some(step_forward.threshold),
        Settings::MovingWindow(moving_window) => Some(moving_window.threshold),
        _ => None,
    }
}

/// The settings that a type runs with, and what of them was rounded, in words.
///
/// # Errors
/// A threshold or step that becomes 0, in words.
pub(crate) fn rounded(
    sample: SampleType,
    settings: &Settings,
) -> anyhow::Result<(Settings, Option<String>)> {
    if sample == SampleType::F32 {
        return Ok((settings.clone(), None));
    }
    let one = sample.one();
    let nearest = |value: f64| {
        for_sample_type!(sample, S => <S as Sample>::from_f64(value * one).to_f64()) / one
    };
    let (mut rounded, mut told, mut vanished) = (settings.clone(), Vec::new(), None);
    let (mut listed, mut count, mut most) = ("", 0, 0.0_f64);
    rounded.visit(|name, value| {
        let (asked, ran) = (*value, nearest(*value));
        *value = ran;
        if asked == ran {
            return;
        }
        match name {
            // Samples are rounded like that, too.
            "start" | "first" => {}
            "taps" | "centres" => {
                (listed, count) = (name, count + 1);
                most = most.max((asked - ran).abs());
            }
            "threshold" | "step" if ran == 0.0 && asked > 0.0 => vanished = Some((name, asked)),
            _ => told.push(format!("{name} {} ran as {ran}", short(asked))),
        }
    });
    if let Some((name, asked)) = vanished {
        anyhow::bail!(
            "{name} {asked} is 0 in {sample}, whose step is {}; a type with more bits after the point, or \
             f32, would hold it",
            sample.step()
        );
    }
    if count > 0 {
        told.push(format!("{count} {listed} were rounded by at most {}", short(most)));
    }
    Ok((rounded, (!told.is_empty()).then(|| format!("in {sample}, {}", told.join(", ")))))
}
