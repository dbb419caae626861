//! An encoder and its decoder over many samples, whose type says nothing of the scheme.

use anyhow::Result;
use spikewire::{Code, NeuronSpike, Output, Polarity, Sample, Scheme};

use super::{Settings, Visit};

/// One neuron's spike for one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Event {
    /// The sample, counted from 0.
    pub sample: u64,
    /// The neuron, counted from 0.
    pub neuron: u16,
    /// The sub-timestep within the sample; 0 for codes without.
    pub slot: u16,
    /// The direction.
    pub polarity: Polarity,
}

/// A matching encoder and decoder, in the recording's unit.
pub struct Codec(Box<dyn Erased>);

impl Codec {
    /// How many samples after its own the code of a sample comes out.
    pub fn latency(&self) -> usize {
        self.0.latency()
    }

    /// Takes the next samples, all finite, and adds the events that they bring about.
    pub fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>) {
        self.0.encode(samples, events);
    }

    /// Adds the events of the samples that still wait for their look-ahead.
    pub fn finish(&mut self, events: &mut Vec<Event>) {
        self.0.finish(events);
    }

    /// Decodes the next samples from the events that belong to them, and adds their values.
    ///
    /// # Errors
    /// The first event of a sample whose events no encoder emits together.
    pub fn decode(
        &mut self,
        samples: usize,
        events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event> {
        self.0.decode(samples, events, values)
    }
}

/// What a codec does with many samples a call, so that the dynamic call costs nothing.
trait Erased {
    fn latency(&self) -> usize;
    fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>);
    fn finish(&mut self, events: &mut Vec<Event>);
    fn decode(
        &mut self,
        count: usize,
        events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event>;
}

/// Starts a codec on a recording.
pub(super) struct Start<'a> {
    pub(super) settings: &'a Settings,
    /// The first sample, or the value before it, of schemes whose decoders add up steps.
    pub(super) first: Option<f64>,
}

impl<S: Sample> Visit<S> for Start<'_> {
    type Output = Codec;

    fn visit<P: Scheme<Sample = S> + 'static>(
        self,
        scheme: P,
        mut encoder: P::EncoderState,
    ) -> Result<Codec> {
        let Self { settings, first } = self;
        let one = settings.sample.one();
        let sample = |value: f64| S::from_f64(value * one);
        let window: Vec<S> = settings.first.iter().copied().map(sample).collect();
        scheme.prime(&mut encoder, &window);
        let mut decoder = scheme.decoder_state();
        if let Some(first) = first {
            scheme.resync(&mut decoder, sample(first));
        }
        let starts_at_first = settings.starts_at_first();
        let silent = P::Code::assemble(std::iter::empty());
        let running = Running {
            scheme,
            encoder,
            decoder,
            silent,
            starts_at_first,
            one,
            coded: 0,
            decoded: 0,
        };
        Ok(Codec(Box::new(running)))
    }
}

/// A scheme with the states of one channel.
struct Running<P: Scheme> {
    scheme: P,
    encoder: P::EncoderState,
    decoder: P::DecoderState,
    /// The code without events.
    silent: P::Code,
    /// Whether the decoder holds the value of the first sample, whose spike then changes nothing.
    starts_at_first: bool,
    /// What a 1 of the recording is in the unit of the sample type.
    one: f64,
    /// How many samples have been coded.
    coded: u64,
    /// How many have been decoded.
    decoded: u64,
}

impl<P: Scheme> Running<P> {
    fn emit(&mut self, code: P::Code, events: &mut Vec<Event>) {
        let sample = self.coded;
        events.extend(code.firings().map(|firing| event_of(sample, firing)));
        self.coded += 1;
    }
}

impl<P: Scheme> Erased for Running<P> {
    fn latency(&self) -> usize {
        self.scheme.latency()
    }

    fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>) {
        for &sample in samples {
            let sample = P::Sample::from_f64(sample * self.one);
            if let Some(code) = self.scheme.encode(&mut self.encoder, sample).code() {
                self.emit(code, events);
            }
        }
    }

    fn finish(&mut self, events: &mut Vec<Event>) {
        while let Some(code) = self.scheme.finish_next(&mut self.encoder) {
            self.emit(code, events);
        }
    }

    fn decode(
        &mut self,
        count: usize,
        mut events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event> {
        for _ in 0..count {
            let now = leading(&mut events, self.decoded);
            let code = match now {
                [] => self.silent,
                [first, ..] => assembled(now).ok_or(*first)?,
            };
            let held = if self.starts_at_first && self.decoded == 0 {
                self.scheme.held(&self.decoder)
            } else {
                None
            };
            let value = held.unwrap_or_else(|| self.scheme.decode(&mut self.decoder, code));
            values.push(value.to_f64() / self.one);
            self.decoded += 1;
        }
        Ok(())
    }
}

/// Takes the events of this sample from the front of the list.
fn leading<'a>(events: &mut &'a [Event], sample: u64) -> &'a [Event] {
    let count = events.iter().take_while(|event| event.sample == sample).count();
    let (now, later) = events.split_at(count);
    *events = later;
    now
}

/// The code of these events of one sample, in any order, unless there is no such code.
fn assembled<C: Code>(events: &[Event]) -> Option<C> {
    let firing = |event: &Event| {
        let Event { neuron, slot, polarity, .. } = *event;
        NeuronSpike { neuron, slot, polarity }
    };
    let code = C::assemble(events.iter().map(firing));
    let mut left: Vec<NeuronSpike> = events.iter().map(firing).collect();
    for firing in code.firings() {
        left.swap_remove(left.iter().position(|other| *other == firing)?);
    }
    left.is_empty().then_some(code)
}

fn event_of(sample: u64, firing: NeuronSpike) -> Event {
    let NeuronSpike { neuron, slot, polarity } = firing;
    Event { sample, neuron, slot, polarity }
}
