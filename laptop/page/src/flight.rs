//! A flight's file: of the axes that are drawn, and back into settings.

use crate::recording;
use crate::run::{Choice, texts};
use anyhow::{Context, Result, bail};
use catalogue::run::Asked;
use lab::flight::{Channel, Flight, Parts, of_settings};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Channels that share a scheme, a filter and a rate in samples a second.
#[derive(Deserialize)]
pub(crate) struct Flown {
    choice: Choice,
    rate: Option<f64>,
    channels: Vec<Axis>,
}

/// A channel of the recording with its parameters.
#[derive(Deserialize)]
struct Axis {
    name: String,
    parameters: BTreeMap<String, String>,
    /// The channel's entry in the flight file that was opened, if it has one.
    entry: Option<Entry>,
}

/// Name, source and unit of a channel in a flight file. They are a part of the flight's fingerprint, so that a file that
/// was opened is written with the same ones.
#[derive(Deserialize, Serialize)]
struct Entry {
    name: String,
    source: String,
    unit: String,
}

/// Settings of the link that a flight file brings. The page does not code with them, and writes them again.
#[derive(Clone, Copy, Deserialize, Serialize)]
pub(crate) struct Link {
    clock_ppm: u32,
    step_bits: u8,
    gathering: u32,
    full_every: u32,
}

/// The file's text.
///
/// # Errors
/// The recording has no rate, its times contradict themselves, or the channels cannot share a bank.
pub(crate) fn write(all: &Flown) -> Result<Value> {
    let mut channels = Vec::new();
    for Axis { name, parameters, .. } in &all.channels {
        let choice = Choice { parameters: parameters.clone(), ..all.choice.clone() };
        let (_, _, mut asked) = choice.read()?;
        asked.paper = false;
        channels.push((name.clone(), asked));
    }
    let rate = recording::with(|open| Ok(open.recording.steady_rate()?))?.or(all.rate);
    let flight = of(&all.choice, rate, channels)?;
    let mut parts = Parts::clone(&flight);
    for (channel, axis) in parts.channels.iter_mut().zip(&all.channels) {
        if let Some(Entry { name, source, unit }) = &axis.entry {
            channel.name.clone_from(name);
            channel.source.clone_from(source);
            channel.unit.clone_from(unit);
        }
    }
    Ok(json!({ "text": Flight::new(parts)?.to_toml(&[]) }))
}

/// A flight of channels, each with its name and its parameters.
pub(crate) fn of(
    choice: &Choice,
    rate: Option<f64>,
    channels: Vec<(String, Asked)>,
) -> Result<Flight> {
    let rate = rate.context("a flight needs samples at a known rate: say how many a second")?;
    let (scheme, sample, _) = choice.read()?;
    let flight = of_settings(scheme, sample, rate, channels.into_iter())?;
    let mut parts = Parts::clone(&flight);
    parts.filter = choice.filter;
    if choice.keyframe_ms.is_some() {
        parts.keyframe_every = choice.keyframe_every(rate) as u32;
    }
    if let Some(link) = choice.link {
        parts.clock_ppm = link.clock_ppm;
        // Another scheme may have been chosen since the file was opened, and only step codes have step numbers.
        parts.step_bits = if scheme.info().has_first_value() { link.step_bits } else { 0 };
        parts.gathering = link.gathering;
        parts.full_every = link.full_every;
    }
    Ok(Flight::new(parts)?)
}

/// Returns scheme, sample type, link and the parameters of each channel, as a choice has them.
///
/// # Errors
/// Returns an error if the text is not a flight file, or if its samples are counts: the page codes values in their unit.
pub(crate) fn read(text: &str) -> Result<Value> {
    let flight = Flight::parse(text)?;
    let in_counts = flight.channels.iter().find(|channel| (channel.counts - 1.0).abs() > 0.0);
    if let Some(Channel { name, counts, .. }) = in_counts {
        bail!("{name} has {counts} counts in a unit, and the page codes values in the unit itself");
    }
    let channels = flight.channels.iter().map(|channel| {
        let Channel { name, source, unit, .. } = channel.clone();
        let entry = Entry { name, source, unit };
        json!({ "parameters": texts(&flight.asked(channel)), "entry": entry })
    });
    let Parts { clock_ppm, step_bits, gathering, full_every, .. } = *flight;
    let link = Link { clock_ppm, step_bits, gathering, full_every };
    Ok(json!({
        "scheme": flight.scheme.name,
        "sample": flight.sample.to_string(),
        "channels": channels.collect::<Vec<_>>(),
        "filter": flight.filter,
        "link": link,
        "keyframeMs": f64::from(flight.keyframe_every) * f64::from(flight.period.get()) * 1e-3,
    }))
}
