//! A scheme with its settings on the recording.

use crate::flight::Link;
use crate::host::send;
use crate::recording;
use anyhow::{Context, Result};
use catalogue::run::{Asked, Error, Event, SampleType};
use lab::advise::link_bytes;
use lab::flight::Filter;
use lab::scheme::Scheme;
use lab::score::Figures;
use lab::trial::{Recording, Trial};
use lab::tune::Costs;
use serde::Deserialize;
use serde_json::{Value, json};
use spikewire::Polarity;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The core whose instructions are told.
pub(crate) const CORE: &str = "M4F";

/// A scheme, its sample type and its parameters as texts; those that are not given are the paper's or the signal's.
#[derive(Clone, Deserialize)]
pub(crate) struct Choice {
    pub scheme: String,
    pub sample: String,
    pub parameters: BTreeMap<String, String>,
    /// The filter before the code.
    pub filter: Option<Filter>,
    /// Milliseconds between keyframes.
    pub keyframe_ms: Option<f64>,
    /// Settings of the link, of a flight file that was opened.
    #[serde(default)]
    pub link: Option<Link>,
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

    /// Filters a recording, if a filter is chosen.
    ///
    /// # Errors
    /// Returns an error if the recording has no steady rate for the filter, or if the filter is not possible at this rate.
    pub(crate) fn behind_filter<'a>(&self, recording: &'a Recording) -> Result<Cow<'a, Recording>> {
        let Some(filter) = self.filter else { return Ok(Cow::Borrowed(recording)) };
        let sample = self.sample.parse()?;
        let rate = recording.steady_rate()?;
        let rate = rate.context("a filter needs samples at a known rate")? as f32;
        drop(filter.start(sample, rate)?);
        Ok(Cow::Owned(recording.filtered(|| {
            // It started a line above.
            filter.start(sample, rate).unwrap_or_else(|_| Box::new(|value| value))
        })))
    }

    /// Filters a recording, if a filter is chosen, and encodes and decodes it.
    ///
    /// # Errors
    /// Returns an error if the choice makes no sense on the recording.
    pub(crate) fn trial<'a>(
        &self,
        recording: &'a Recording,
    ) -> Result<(Cow<'a, Recording>, Trial)> {
        let (scheme, sample, asked) = self.read()?;
        let recording = self.behind_filter(recording)?;
        let trial = Trial::new(scheme, &asked, sample, &recording)?;
        Ok((recording, trial))
    }

    /// Samples from one keyframe to the next: one a second if nothing is chosen.
    pub(crate) fn keyframe_every(&self, rate: f64) -> u64 {
        (rate * self.keyframe_ms.unwrap_or(1000.0) * 1e-3).round().max(1.0) as u64
    }
}

/// Parameters as the texts that a choice has.
pub(crate) fn texts(asked: &Asked) -> BTreeMap<&'static str, String> {
    asked.iter().map(|(name, value)| (name, value.to_string())).collect()
}

/// Encodes and decodes the recording: events and decoded values go to the page, and what a filter made of the samples.
pub(crate) fn run(choice: &Choice, place: usize) -> Result<Value> {
    recording::with_place(place, |open| {
        let (recording, trial) = choice.trial(&open.recording)?;
        if let Cow::Owned(filtered) = &recording {
            send("coded", &filtered.values);
        }
        send("decoded", &trial.decoded);
        send_events(&trial.events);
        // Times that contradict themselves give no bytes a second, as they give a flight file no period.
        let link = match recording.steady_rate().ok().flatten() {
            Some(rate) => link_bytes(&trial, rate, choice.keyframe_every(rate))
                .ok()
                .map(|bytes| bytes * rate / recording.values.len() as f64),
            None => None,
        };
        let costs = |core| Costs::new(trial.scheme, &trial.settings, trial.latency, core);
        let delay = |filter: Filter| filter.delay(recording.rate? as f32).ok();
        let asked = texts(&trial.settings.to_asked(trial.scheme.info()));
        let texts = trial.settings.entries().iter().map(|(name, value)| (*name, value.to_string()));
        Ok(json!({
            "settings": texts.collect::<BTreeMap<_, _>>(),
            "asked": asked,
            "neurons": trial.shape.neurons,
            "slots": trial.shape.slots,
            "latency": trial.latency,
            "filterDelay": choice.filter.and_then(delay),
            "notes": trial.notes,
            "figures": Figures::of(&recording, &trial),
            "costs": costs(CORE),
            "costsWithoutFpu": costs("M0"),
            "linkBytesPerSecond": link,
        }))
    })
}

fn send_events(events: &[Event]) {
    let each = events.iter();
    send("sample", &each.clone().map(|event| event.sample as u32).collect::<Vec<_>>());
    send("neuron", &each.clone().map(|event| event.neuron).collect::<Vec<_>>());
    send("slot", &each.clone().map(|event| event.slot).collect::<Vec<_>>());
    send("up", &each.map(|event| u8::from(event.polarity == Polarity::Up)).collect::<Vec<_>>());
}

/// What is coded while a knob moves: the samples from `from` to before `to`, or `pieces` of them, evenly spread, that
/// have `most` samples together.
#[derive(Deserialize)]
pub(crate) struct Preview {
    choice: Choice,
    from: usize,
    to: usize,
    pieces: usize,
    most: usize,
}

/// Encodes and decodes parts of the recording, each from its own first sample on. The choice holds all parameters, so
/// that none is taken from the part.
pub(crate) fn preview(asked: &Preview) -> Result<Value> {
    recording::with(|open| {
        let all = &open.recording;
        let to = asked.to.min(all.values.len());
        let span = to.saturating_sub(asked.from);
        let pieces = if span <= asked.most { 1 } else { asked.pieces.max(1) };
        let length = if pieces == 1 { span } else { (asked.most / pieces).max(1) };
        let (mut decoded, mut errors, mut events) = (Vec::new(), Vec::new(), Vec::new());
        let mut shape = None;
        for piece in 0..pieces {
            let start = asked.from + piece * (span / pieces);
            let Some(values) = all.values.get(start..to.min(start + length)) else { continue };
            let part = Recording::of(String::new(), values.to_vec(), all.rate);
            let (coded, mut trial) = asked.choice.trial(&part)?;
            let pairs = trial.decoded.iter().zip(&coded.values);
            errors.extend(pairs.map(|(decoded, coded)| decoded - coded));
            decoded.append(&mut trial.decoded);
            let own = trial.events.into_iter();
            events.extend(own.map(|own| Event { sample: own.sample + start as u64, ..own }));
            shape = Some(trial.shape);
        }
        let shape = shape.context("nothing is in view")?;
        send("decoded", &decoded);
        send("errors", &errors);
        send_events(&events);
        Ok(json!({
            "from": asked.from,
            "stride": span / pieces,
            "length": length,
            "neurons": shape.neurons,
            "slots": shape.slots,
        }))
    })
}
