//! Any scheme in any sample type, chosen at run time.
//!
//! The crate fixes shapes (filter lengths, windows, neurons) at compile time. Here each supported
//! shape is compiled once and hidden behind [`Encode`] and [`Decode`], which work on many samples a
//! call, so that the dynamic call costs nothing.

mod calibrate;
mod code;
mod erased;
mod population;
mod rate;
mod shapes;
mod temporal;

pub(crate) use calibrate::Calibrated;

use crate::sample_type::{SampleType, for_sample_type};
use crate::settings::Settings;
use anyhow::Result;
use spikewire::Polarity;

/// One neuron's spike for one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Event {
    /// The sample, counted from 0.
    pub sample: u64,
    /// The neuron, counted from 0.
    pub neuron: u16,
    /// The sub-timestep within the sample; 0 for codes without.
    pub slot: u16,
    /// The direction.
    pub polarity: Polarity,
}

/// Turns samples into events.
trait Encode {
    /// Sets what the encoder starts from: the first window of a moving window, else one value.
    fn prime(&mut self, first: &[f64]);

    /// Takes the next samples, all finite, and adds the events that they bring about.
    fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>);

    /// Adds the events of the samples that still wait for their look-ahead.
    fn finish(&mut self, events: &mut Vec<Event>);
}

/// Turns events back into values.
trait Decode {
    /// Sets the value before the first.
    fn start(&mut self, value: f64);

    /// Decodes the next samples from the events that belong to them.
    ///
    /// # Errors
    /// The first event of a sample whose events no encoder emits together.
    fn decode(
        &mut self,
        samples: usize,
        events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event>;
}

/// A matching encoder and decoder, in the recording's unit.
pub(crate) struct Codec {
    encoder: Box<dyn Encode>,
    decoder: Box<dyn Decode>,
    latency: usize,
    /// What a 1 is in the unit of the encoder and decoder.
    one: f64,
}

impl Codec {
    /// The encoder and decoder of a scheme, as they start on a recording.
    ///
    /// # Errors
    /// A parameter that makes no sense, or a shape that is not compiled in.
    pub(crate) fn new(sample: SampleType, settings: &Settings) -> Result<Self> {
        let settings = settings.scaled(sample.one());
        let mut codec = for_sample_type!(sample, S => build::<S>(&settings))?;
        codec.encoder.prime(&settings.first_window());
        if let Some(start) = settings.start() {
            codec.decoder.start(start);
        }
        Ok(Self { one: sample.one(), ..codec })
    }

    /// How many samples after its own the code of a sample comes out.
    pub(crate) fn latency(&self) -> usize {
        self.latency
    }

    /// Takes the next samples, all finite, and adds the events that they bring about.
    pub(crate) fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>) {
        if self.one == 1.0 {
            self.encoder.encode(samples, events);
        } else {
            let scaled: Vec<f64> = samples.iter().map(|sample| sample * self.one).collect();
            self.encoder.encode(&scaled, events);
        }
    }

    /// Adds the events of the samples that still wait for their look-ahead.
    pub(crate) fn finish(&mut self, events: &mut Vec<Event>) {
        self.encoder.finish(events);
    }

    /// Decodes the next samples from the events that belong to them, and adds their values.
    ///
    /// # Errors
    /// The first event of a sample whose events no encoder emits together.
    pub(crate) fn decode(
        &mut self,
        samples: usize,
        events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event> {
        let before = values.len();
        self.decoder.decode(samples, events, values)?;
        if self.one != 1.0 {
            values[before..].iter_mut().for_each(|value| *value /= self.one);
        }
        Ok(())
    }
}

fn build<S: spikewire::Sample>(settings: &Settings) -> Result<Codec> {
    match settings {
        Settings::Contrast(contrast) => temporal::contrast::<S>(contrast),
        Settings::StepForward(step_forward) => temporal::step_forward::<S>(step_forward),
        Settings::MovingWindow(moving_window) => temporal::moving_window::<S>(moving_window),
        Settings::Rate(rate) => rate::build::<S>(rate),
        Settings::Position(centres) => population::position::<S>(centres),
        Settings::Gaussian(range) => population::gaussian::<S>(range),
        Settings::Slots(slots) => population::slots::<S>(slots),
        Settings::Probabilistic(probabilistic) => population::probabilistic::<S>(probabilistic),
    }
}
