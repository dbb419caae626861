//! A scheme with its settings on the recording.

use crate::host::send;
use crate::recording;
use anyhow::Result;
use catalogue::run::{Asked, Error, SampleType};
use lab::advise::link_bytes;
use lab::scheme::Scheme;
use lab::score::Figures;
use lab::trial::Trial;
use lab::tune::Costs;
use serde::Deserialize;
use serde_json::{Value, json};
use spikewire::Polarity;
use std::collections::BTreeMap;

/// The core whose instructions are told.
pub(crate) const CORE: &str = "M4F";

/// A scheme, its sample type and its parameters as texts; those that are not given are the paper's or the signal's.
#[derive(Clone, Deserialize)]
pub(crate) struct Choice {
    pub scheme: String,
    pub sample: String,
    pub parameters: BTreeMap<String, String>,
}

impl Choice {
    /// The scheme, its sample type, and what is asked of its parameters.
    ///
    /// # Errors
    /// There is no such scheme or type, or a text is no value of its parameter.
    pub(crate) fn read(&self) -> Result<(Scheme, SampleType, Asked)> {
        let scheme = Scheme::named(&self.scheme).ok_or_else(|| Error::no_scheme(&self.scheme))?;
        let mut asked = Asked::default();
        asked.paper = true;
        for (name, text) in &self.parameters {
            let unknown = || Error::takes_no(scheme.info(), name.clone());
            let parameter = scheme.info().parameter(name).ok_or_else(unknown)?;
            asked.set(parameter.name, parameter.read(text)?);
        }
        Ok((scheme, self.sample.parse()?, asked))
    }

    /// Encodes and decodes the recording.
    ///
    /// # Errors
    /// The choice makes no sense on it.
    pub(crate) fn trial(&self, open: &recording::Open) -> Result<Trial> {
        let (scheme, sample, asked) = self.read()?;
        Ok(Trial::new(scheme, &asked, sample, &open.recording)?)
    }
}

/// Parameters as the texts that a choice has.
pub(crate) fn texts(asked: &Asked) -> BTreeMap<&'static str, String> {
    asked.iter().map(|(name, value)| (name, value.to_string())).collect()
}

/// Encodes and decodes the recording: events and decoded values go to the page.
pub(crate) fn run(choice: &Choice) -> Result<Value> {
    recording::with(|open| {
        let recording = &open.recording;
        let trial = choice.trial(open)?;
        send("decoded", &trial.decoded);
        let each = trial.events.iter();
        send("sample", &each.clone().map(|event| event.sample as u32).collect::<Vec<_>>());
        send("neuron", &each.clone().map(|event| event.neuron).collect::<Vec<_>>());
        send("slot", &each.clone().map(|event| event.slot).collect::<Vec<_>>());
        send("up", &each.map(|event| u8::from(event.polarity == Polarity::Up)).collect::<Vec<_>>());
        let per_second = |bytes: f64, rate: f64| bytes * rate / recording.values.len() as f64;
        let link =
            recording.rate.and_then(|rate| Some(per_second(link_bytes(&trial, rate).ok()?, rate)));
        let costs = Costs::new(trial.scheme, &trial.settings, trial.latency, CORE);
        let asked = texts(&trial.settings.to_asked(trial.scheme.info()));
        let texts = trial.settings.entries().iter().map(|(name, value)| (*name, value.to_string()));
        Ok(json!({
            "settings": texts.collect::<BTreeMap<_, _>>(),
            "asked": asked,
            "neurons": trial.shape.neurons,
            "slots": trial.shape.slots,
            "latency": trial.latency,
            "notes": trial.notes,
            "figures": Figures::of(recording, &trial),
            "costs": costs,
            "linkBytesPerSecond": link,
        }))
    })
}
