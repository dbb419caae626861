//! What must be equal.

use spikewire::population::Position;
use spikewire::rate::{RateDecoderState, Taps};
use spikewire::temporal::StepState;
use spikewire::{Decoder, Scheme, Spike, Start};

use super::run::{Run, decode, encode};
use super::wire::{Wire, assert_same_values, finite, reals, saturated, signs_of, spikes_of};
use crate::reference::{Finite, Real, clamped, rate_decode, step_decode_within};

/// Asserts that spikes came out at `latency` samples after their own, that rejected samples gave
/// none, and that the tail completes the list: `whole` in flight, `all` with the tail.
///
/// # Panics
/// If not.
pub fn assert_rate_spikes<T: Real>(
    run: &Run<Option<Spike>>,
    recording: &Finite<T>,
    latency: usize,
    whole: &[i8],
    all: &[i8],
) {
    let mut expected = vec![None; run.outputs.len()];
    for (&position, &spike) in recording.positions.iter().skip(latency).zip(whole) {
        expected[position] = Some(spike);
    }
    let signs: Vec<_> = run.outputs.iter().map(|output| output.map(Spike::sign)).collect();
    assert_eq!(signs, expected, "in flight");
    assert_eq!(whole.len(), recording.accepted.len().saturating_sub(latency));
    assert_eq!(signs_of(&run.codes()), all, "with the tail");
    assert_eq!(run.rejected as usize, recording.rejected.len());
}

/// Asserts that accepted samples gave these spikes, and the others none.
///
/// # Panics
/// If not.
pub fn assert_step_spikes<T: Real>(run: &Run<Spike>, recording: &Finite<T>, spikes: &[i8]) {
    let mut expected = vec![0; run.outputs.len()];
    assert_eq!(recording.positions.len(), spikes.len());
    for (&position, &spike) in recording.positions.iter().zip(spikes) {
        expected[position] = spike;
    }
    assert_eq!(signs_of(&run.outputs), expected);
    assert!(run.tail.is_empty());
    assert_eq!(run.rejected as usize, recording.rejected.len());
}

/// Checks the decoder of a temporal scheme, from 0 and from a known value.
///
/// # Panics
/// If a value differs from the reference.
pub fn check_step_decoder<S, P>(scheme: &P, signs: &[i8], step: S, start: S)
where
    S: Wire,
    P: Scheme<Sample = S, Code = Spike, DecoderState = StepState<S>>,
{
    let [lowest, highest] = S::ends();
    let mut decoder = scheme.decoder();
    for start in [S::default(), start] {
        decoder.resync(start);
        let expected = step_decode_within(signs, step.real(), start.real(), lowest, highest);
        assert_same_values(&decode(&decoder, &spikes_of(signs)), &expected);
    }
    decoder.reset();
    assert_eq!(decoder.held(), Some(S::default()));
}

/// Checks encoder and decoder of a rate scheme.
///
/// `reference` encodes a recording with a shift, without or with its tail. Where the type's residuals
/// saturate, it is given the saturated ones.
///
/// # Panics
/// If a spike or a value differs from the reference.
pub fn check_rate<P, S, const F: usize>(
    scheme: &P,
    samples: &[S],
    taps: &Taps<S, F>,
    shift: S,
    reference: impl Fn(&[S::Real], S::Real, bool) -> Vec<i8>,
) where
    S: Wire,
    P: Start<
            Sample = S,
            Code = Spike,
            Output = Option<Spike>,
            DecoderState = RateDecoderState<S, F>,
        >,
{
    let mut recording = finite(samples);
    let taps = reals(taps.as_array());
    let magnitude = taps.iter().fold(S::Real::ZERO, |sum, tap| sum + tap.magnitude());
    let mut base = shift.real();
    if let Some(limit) = S::residual_limit(magnitude) {
        for value in &mut recording.accepted {
            *value = clamped(*value - base, -limit, limit);
        }
        base = S::Real::ZERO;
    }
    let whole = reference(&recording.accepted, base, false);
    let all = reference(&recording.accepted, base, true);
    let run = encode(scheme, samples);
    assert_rate_spikes(&run, &recording, P::LATENCY, &whole, &all);
    check_rate_decoder(&scheme.decoder(), &all, &taps, shift);
}

/// Checks the decoder of the rate schemes; `resync` to any value forgets the past.
///
/// # Panics
/// If a value differs from the reference.
pub fn check_rate_decoder<S, P, const F: usize>(
    decoder: &Decoder<'_, P>,
    signs: &[i8],
    taps: &[S::Real],
    shift: S,
) where
    S: Wire,
    P: Scheme<Sample = S, Code = Spike, DecoderState = RateDecoderState<S, F>>,
{
    let expected = saturated::<S>(&rate_decode(signs, taps, shift.real()));
    let mut decoder = *decoder;
    assert_eq!(decoder.held(), None);
    assert_same_values(&decode(&decoder, &spikes_of(signs)), &expected);
    for is_reset in [true, false] {
        decoder.decode(Spike::Up);
        decoder.decode(Spike::Up);
        if is_reset {
            decoder.reset();
        } else {
            decoder.resync(shift);
        }
        assert_same_values(&decode(&decoder, &spikes_of(signs)), &expected);
    }
}

/// Checks encoder and decoder of position coding; `reference` gives the neurons of finite samples.
///
/// # Panics
/// If a neuron or a value differs from the reference.
pub fn check_position<S: Wire, const M: usize>(
    scheme: &Position<S, M>,
    samples: &[S],
    centres: &[S::Real],
    reference: impl Fn(&[S::Real]) -> Vec<usize>,
) {
    let recording = finite(samples);
    let mut neurons = vec![None; samples.len()];
    for (&position, neuron) in recording.positions.iter().zip(reference(&recording.accepted)) {
        neurons[position] = Some(neuron);
    }
    let run = encode(scheme, samples);
    let ours: Vec<_> =
        run.outputs.iter().map(|output| output.map(|neuron| usize::from(neuron.index()))).collect();
    assert_eq!(ours, neurons);
    assert!(run.tail.is_empty());
    assert_eq!(run.rejected as usize, recording.rejected.len());

    let mut value = centres[M / 2];
    let mut hold = |neuron: &Option<usize>| {
        value = neuron.map_or(value, |neuron| centres[neuron]);
        value
    };
    let expected: Vec<_> = neurons.iter().map(&mut hold).collect();
    let mut decoder = scheme.decoder();
    assert_same_values(&decode(&decoder, &run.outputs), &expected);
    decoder.resync(S::default());
    assert_eq!(decoder.held(), Some(S::default()));
    assert_same_values(&[decoder.decode(None)], &[S::Real::ZERO]);
    decoder.reset();
    assert_same_values(&decode(&decoder, &run.outputs), &expected);
}
