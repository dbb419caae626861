//! The crate's encoders and decoders behind the run-time traits.
//!
//! What is generic here is compiled once a shape, so it holds little more than the calls.

use super::code::{FromEvents, leading};
use super::{Codec, Decode, Encode, Event};
use spikewire::population::{PositionEncoder, ProbabilisticEncoder, SlotsEncoder};
use spikewire::rate::{BenToolboxEncoder, RateEncoder};
use spikewire::temporal::{MovingWindowEncoder, StepForwardEncoder, TemporalContrastEncoder};
use spikewire::{Code, Decoder, Encoder, Firing, Output, Sample, Scheme};

/// A scheme's encoder and decoder, erased.
pub(super) fn erase<C>(scheme: C) -> Codec
where
    C: Scheme + 'static,
    C::Encoder: Primed,
    <C::Decoder as Decoder>::Code: FromEvents,
{
    erase_pair(scheme.encoder(), scheme.decoder(), C::LATENCY)
}

/// An encoder and its decoder, erased.
pub(super) fn erase_pair<E, D>(encoder: E, decoder: D, latency: usize) -> Codec
where
    E: Primed + 'static,
    D: Decoder<Code: FromEvents> + 'static,
{
    Codec {
        encoder: Box::new(Erased { codec: encoder, next: 0 }),
        decoder: Box::new(Erased { codec: decoder, next: 0 }),
        latency,
        one: 1.0,
    }
}

/// An encoder or decoder.
struct Erased<T> {
    codec: T,
    /// The number of the sample that it codes next.
    next: u64,
}

impl<E: Primed> Erased<E> {
    fn emit(&mut self, code: <E::Output as Output>::Code, events: &mut Vec<Event>) {
        for firing in code.firings() {
            push(events, self.next, firing);
        }
        self.next += 1;
    }
}

fn push(events: &mut Vec<Event>, sample: u64, firing: Firing) {
    let Firing { neuron, slot, polarity } = firing;
    events.push(Event { sample, neuron, slot, polarity });
}

impl<E: Primed> Encode for Erased<E> {
    fn prime(&mut self, first: &[f64]) {
        self.codec.prime_with(&quantized(first));
    }

    fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>) {
        for &sample in samples {
            if let Some(code) = self.codec.encode(E::Sample::from_f64(sample)).code() {
                self.emit(code, events);
            }
        }
    }

    fn finish(&mut self, events: &mut Vec<Event>) {
        while let Some(code) = self.codec.finish_next() {
            self.emit(code, events);
        }
    }
}

fn quantized<S: Sample>(values: &[f64]) -> Vec<S> {
    values.iter().map(|&value| S::from_f64(value)).collect()
}

impl<D: Decoder<Code: FromEvents>> Decode for Erased<D> {
    fn start(&mut self, value: f64) {
        self.codec.resync(D::Sample::from_f64(value));
    }

    fn decode(
        &mut self,
        samples: usize,
        mut events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event> {
        for _ in 0..samples {
            let now = leading(&mut events, self.next);
            let Some(code) = D::Code::from_events(now) else {
                return Err(now[0]);
            };
            values.push(self.codec.decode(code).to_f64());
            self.next += 1;
        }
        Ok(())
    }
}

/// An encoder that may start from the first values of a recording.
pub(super) trait Primed: Encoder {
    /// Sets what the encoder starts from; most start from nothing.
    fn prime_with(&mut self, _: &[Self::Sample]) {}
}

impl<S: Sample> Primed for TemporalContrastEncoder<S> {
    fn prime_with(&mut self, first: &[S]) {
        for &previous in first {
            self.prime(previous);
        }
    }
}

impl<S: Sample> Primed for StepForwardEncoder<S> {
    fn prime_with(&mut self, first: &[S]) {
        for &base in first {
            self.prime(base);
        }
    }
}

impl<S: Sample, const N: usize> Primed for MovingWindowEncoder<S, N> {
    fn prime_with(&mut self, first: &[S]) {
        // A recording shorter than the window never fills it, and then emits nothing.
        if let Ok(window) = first.try_into() {
            self.prime(window);
        }
    }
}

impl<S: Sample, R, const F: usize> Primed for RateEncoder<'_, S, R, F> where
    Self: Encoder<Sample = S>
{
}
impl<S: Sample, const F: usize> Primed for BenToolboxEncoder<'_, S, F> {}
impl<S: Sample, const M: usize> Primed for PositionEncoder<'_, S, M> {}
impl<S: Sample, const M: usize, const N: usize> Primed for SlotsEncoder<'_, S, M, N> {}
impl<S: Sample, G, const M: usize, const N: usize> Primed for ProbabilisticEncoder<'_, S, G, M, N> where
    Self: Encoder<Sample = S>
{
}
