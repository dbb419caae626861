//! A filter and the scheme that encodes what it lets through.

use super::Filter;
use crate::error::within;
use crate::num::Arithmetic;
use crate::{ConfigError, Destination, Fingerprint, Recovery, Scheme, Start};

/// A filter before a scheme: a [`Scheme`] that encodes the filtered samples. Its decoder is the scheme's own. A link's
/// receiver takes the same constant as its sender all the same, since the filter is part of the
/// [fingerprint](Scheme::fingerprint).
///
/// The encoder's [`latency`](Scheme::latency) counts the samples that the scheme waits for, and none of the filter's
/// [`delay`](Filter::delay).
///
/// [`prime`](crate::Encoder::prime) filters all of the past, and gives the scheme the last 64 results.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Filtered<F, P> {
    filter: F,
    scheme: P,
}

impl<F, P> Filtered<F, P> {
    /// A scheme that encodes what the filter lets through.
    pub const fn new(filter: F, scheme: P) -> Self {
        Self { filter, scheme }
    }

    /// The filter.
    pub const fn filter(&self) -> &F {
        &self.filter
    }

    /// The scheme that encodes the filtered samples.
    pub const fn scheme(&self) -> &P {
        &self.scheme
    }
}

impl<F: Filter, P: Scheme> Filtered<F, P> {
    /// The state of an encoder before its first sample, from that of the scheme's own: for a scheme that draws from a
    /// generator.
    pub const fn start(scheme: P::EncoderState) -> FilteredState<F::State, P::EncoderState> {
        FilteredState { filter: F::START, scheme }
    }
}

/// The state of a [`Filtered`] encoder: the filter's and the scheme's.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilteredState<F, E> {
    filter: F,
    scheme: E,
}

/// How many filtered samples wait for the scheme at once, on the stack.
const CHUNK: usize = 32;

/// How many filtered samples a scheme is primed with at most.
const PAST: usize = 64;

impl<F: Filter, P: Start<Sample = F::Sample>> Start for Filtered<F, P> {
    const START: FilteredState<F::State, P::EncoderState> = Self::start(P::START);
}

impl<F: Filter, P: Scheme<Sample = F::Sample>> Scheme for Filtered<F, P> {
    type Sample = P::Sample;
    type Code = P::Code;
    type Output = P::Output;
    type EncoderState = FilteredState<F::State, P::EncoderState>;
    type DecoderState = P::DecoderState;

    const LATENCY: usize = P::LATENCY;
    const RECOVERY: Recovery = P::RECOVERY;

    fn fingerprint(&self) -> Fingerprint {
        self.filter.fingerprint().and(self.scheme.fingerprint())
    }

    #[inline]
    fn encode(&self, state: &mut Self::EncoderState, sample: P::Sample) -> P::Output {
        let filtered = self.filter.filter(&mut state.filter, sample);
        self.scheme.encode(&mut state.scheme, filtered)
    }

    /// Filters 32 samples at a time.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut Self::EncoderState,
        samples: &[P::Sample],
        outputs: &mut [impl Destination<P::Output>],
    ) -> usize {
        let length = samples.len().min(outputs.len());
        let samples = samples.get(..length).unwrap_or_default();
        let mut filtered = [P::Sample::ZERO; CHUNK];
        for (samples, outputs) in samples.chunks(CHUNK).zip(outputs.chunks_mut(CHUNK)) {
            self.filter.filter_slice(&mut state.filter, samples, &mut filtered);
            self.scheme.encode_slice(&mut state.scheme, &filtered, outputs);
        }
        length
    }

    fn finish_next(&self, state: &mut Self::EncoderState) -> Option<P::Code> {
        self.scheme.finish_next(&mut state.scheme)
    }

    /// The filter starts anew from the past, unless its last sample is not finite: the scheme then rejects it.
    fn prime(&self, state: &mut Self::EncoderState, past: &[P::Sample]) {
        let mut filter = F::START;
        let (before, last) =
            past.split_at_checked(past.len().saturating_sub(PAST)).unwrap_or_default();
        for &sample in before {
            self.filter.filter(&mut filter, sample);
        }
        let mut filtered = [P::Sample::ZERO; PAST];
        let length = self.filter.filter_slice(&mut filter, last, &mut filtered);
        self.scheme.prime(&mut state.scheme, filtered.get(..length).unwrap_or_default());
        if last.last().is_some_and(P::Sample::is_finite) {
            state.filter = filter;
        }
    }

    fn keyframe(&self, state: &Self::EncoderState) -> Option<P::Sample> {
        self.scheme.keyframe(&state.scheme)
    }

    fn rejected(state: &Self::EncoderState) -> u32 {
        P::rejected(&state.scheme)
    }

    fn decoder_state(&self) -> P::DecoderState {
        self.scheme.decoder_state()
    }

    #[inline]
    fn decode(&self, state: &mut P::DecoderState, code: P::Code) -> P::Sample {
        self.scheme.decode(state, code)
    }

    #[inline]
    fn decode_slice(
        &self,
        state: &mut P::DecoderState,
        codes: &[impl Copy + Into<P::Code>],
        values: &mut [P::Sample],
    ) -> usize {
        self.scheme.decode_slice(state, codes, values)
    }

    fn held(&self, state: &P::DecoderState) -> Option<P::Sample> {
        self.scheme.held(state)
    }

    fn resync(&self, state: &mut P::DecoderState, value: P::Sample) {
        self.scheme.resync(state, value);
    }

    fn latency(&self) -> usize {
        self.scheme.latency()
    }

    fn recovery(&self) -> Recovery {
        self.scheme.recovery()
    }

    fn fits(&self, state: &Self::EncoderState) -> bool {
        self.scheme.fits(&state.scheme)
    }

    fn fits_decoder(&self, state: &P::DecoderState) -> bool {
        self.scheme.fits_decoder(state)
    }

    fn holds_keyframes(&self) -> bool {
        self.scheme.holds_keyframes()
    }

    /// The rate of the filter may differ from that of the samples by a twentieth, as a sensor's from its data sheet.
    fn check_period(&self, period: u32) -> Result<(), ConfigError> {
        if let Some(rate) = self.filter.rate() {
            let sampled = 1_000_000.0 / period.max(1) as f32;
            within("rate of the filter", rate.into(), sampled * 0.95, sampled * 1.05)?;
        }
        self.scheme.check_period(period)
    }

    fn neurons(&self) -> usize {
        self.scheme.neurons()
    }

    fn slots(&self) -> usize {
        self.scheme.slots()
    }
}
