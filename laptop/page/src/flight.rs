//! A flight's file: of the axes that are drawn, and back into settings.

use crate::recording;
use crate::run::{Choice, texts};
use anyhow::{Context, Result};
use catalogue::run::Asked;
use lab::flight::{Flight, Parts, of_settings};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Channels that share a scheme, a filter and a rate in samples a second.
#[derive(Deserialize)]
pub(crate) struct Flown {
    choice: Choice,
    rate: Option<f64>,
    channels: Vec<Channel>,
}

#[derive(Deserialize)]
struct Channel {
    name: String,
    parameters: BTreeMap<String, String>,
}

/// The file's text.
///
/// # Errors
/// The recording has no rate, its times contradict themselves, or the channels cannot share a bank.
pub(crate) fn write(all: &Flown) -> Result<Value> {
    let mut channels = Vec::new();
    for Channel { name, parameters } in &all.channels {
        let choice = Choice { parameters: parameters.clone(), ..all.choice.clone() };
        let (_, _, mut asked) = choice.read()?;
        asked.paper = false;
        channels.push((name.clone(), asked));
    }
    let rate = recording::with(|open| Ok(open.recording.steady_rate()?))?.or(all.rate);
    Ok(json!({ "text": of(&all.choice, rate, channels)?.to_toml(&[]) }))
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
    Ok(Flight::new(parts)?)
}

/// Scheme, sample type and the parameters of each channel, as a choice has them.
///
/// # Errors
/// The text is no flight's file.
pub(crate) fn read(text: &str) -> Result<Value> {
    let flight = Flight::parse(text)?;
    let channels = flight.channels.iter().map(
        |channel| json!({ "source": channel.source, "parameters": texts(&flight.asked(channel)) }),
    );
    Ok(json!({
        "scheme": flight.scheme.name,
        "sample": flight.sample.to_string(),
        "channels": channels.collect::<Vec<_>>(),
        "filter": flight.filter,
        "keyframeMs": f64::from(flight.keyframe_every) * f64::from(flight.period.get()) * 1e-3,
    }))
}
