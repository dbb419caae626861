//! A flight's file: of the axes that are drawn, and back into settings.

use crate::run::{Choice, texts};
use anyhow::{Context, Result};
use lab::flight::{Flight, of_settings};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Channels that share a scheme and a rate in samples a second.
#[derive(Deserialize)]
pub(crate) struct Flown {
    scheme: String,
    sample: String,
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
/// The recording has no rate, or the channels cannot share a bank.
pub(crate) fn write(all: &Flown) -> Result<Value> {
    let rate = all.rate.context("a flight needs samples at a known rate: say how many a second")?;
    let mut channels = Vec::new();
    let mut shared = None;
    for Channel { name, parameters } in &all.channels {
        let choice = Choice {
            scheme: all.scheme.clone(),
            sample: all.sample.clone(),
            parameters: parameters.clone(),
        };
        let (scheme, sample, mut asked) = choice.read()?;
        asked.paper = false;
        shared = Some((scheme, sample));
        channels.push((name.clone(), asked));
    }
    let (scheme, sample) = shared.context("no channel is drawn")?;
    let flight = of_settings(scheme, sample, rate, channels.into_iter())?;
    Ok(json!({ "text": flight.to_toml(&[]) }))
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
        "filter": flight.filter.is_some(),
    }))
}
