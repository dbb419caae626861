//! How the crate is run and compared with the reference.
//!
//! Every comparison is of bits. The samples of the crate become the numbers of the reference without
//! rounding: `f32` stays `f32`, and every integer type fits `f64`.

use core::fmt::Debug;

use fixed::types::extra::{LeEqU16, LeEqU32};
use fixed::{FixedI16, FixedI32};
use spikewire::population::Position;
use spikewire::rate::{RateDecoder, Taps};
use spikewire::temporal::StepDecoder;
use spikewire::{Decoder, Encoder, Output, Sample, Scheme, Spike};

use crate::reference::{Finite, Real, rate_decode, split_finite, step_decode_within};

/// A sample type of the crate, and the number that the reference reads it as.
pub trait Wire: Sample {
    /// What the reference computes in.
    type Real: Real;

    /// The same value.
    fn real(self) -> Self::Real;

    /// Where the type saturates.
    fn ends() -> [Self::Real; 2];

    /// The nearest value of the type, halves upwards.
    fn nearest(value: f64) -> Self;

    /// The factor of a multiplicative BSA: in integers a multiple of 2⁻¹⁴.
    fn ratio(value: f32) -> Self::Real {
        Self::Real::rounded((f64::from(value) * 16_384.0 + 0.5).floor() / 16_384.0)
    }

    /// How large a residual can get, with taps whose magnitudes sum up to this.
    fn residual_limit(_: Self::Real) -> Option<Self::Real> {
        None
    }
}

/// The nearest integer, halves upwards.
fn whole(value: f64) -> f64 {
    (value + 0.5).floor()
}

impl Wire for f32 {
    type Real = f32;

    fn real(self) -> f32 {
        self
    }

    fn ends() -> [f32; 2] {
        [f32::NEG_INFINITY, f32::INFINITY]
    }

    fn nearest(value: f64) -> f32 {
        value as f32
    }

    fn ratio(value: f32) -> f32 {
        value
    }
}

impl Wire for i16 {
    type Real = f64;

    fn real(self) -> f64 {
        f64::from(self)
    }

    fn ends() -> [f64; 2] {
        [-32768.0, 32767.0]
    }

    fn nearest(value: f64) -> i16 {
        whole(value) as i16
    }
}

impl<Frac: LeEqU16 + 'static> Wire for FixedI16<Frac> {
    type Real = f64;

    fn real(self) -> f64 {
        self.to_num()
    }

    fn ends() -> [f64; 2] {
        [Self::MIN.to_num(), Self::MAX.to_num()]
    }

    fn nearest(value: f64) -> Self {
        Self::from_bits(whole(value / Self::DELTA.to_num::<f64>()) as i16)
    }
}

impl<Frac: LeEqU32 + 'static> Wire for FixedI32<Frac> {
    type Real = f64;

    fn real(self) -> f64 {
        self.to_num()
    }

    fn ends() -> [f64; 2] {
        [Self::MIN.to_num(), Self::MAX.to_num()]
    }

    fn nearest(value: f64) -> Self {
        Self::from_bits(whole(value / Self::DELTA.to_num::<f64>()) as i32)
    }

    fn residual_limit(magnitude: f64) -> Option<f64> {
        Some(Self::MAX.to_num::<f64>() - magnitude)
    }
}

/// Samples as the reference reads them.
pub fn reals<S: Wire>(samples: &[S]) -> Vec<S::Real> {
    samples.iter().map(|sample| sample.real()).collect()
}

/// A recording as the reference reads it, sorted into finite samples and others.
pub fn finite<S: Wire>(samples: &[S]) -> Finite<S::Real> {
    split_finite(&reals(samples))
}

/// What an encoder said about one recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<O: Output> {
    /// One output a sample.
    pub outputs: Vec<O>,
    /// What `finish` added.
    pub tail: Vec<O::Code>,
    /// How many samples were not finite.
    pub rejected: u32,
}

impl<O: Output> Run<O> {
    /// Every code, in order, those of the tail last.
    pub fn codes(&self) -> Vec<O::Code> {
        self.outputs.iter().filter_map(|output| output.code()).chain(self.tail.clone()).collect()
    }
}

/// Runs an encoder over a recording: sample by sample; in slices of several lengths (long recordings
/// in one only), in turn with single samples; and with outputs for half the samples first. All must
/// agree.
///
/// # Panics
/// If they do not.
pub fn run<E>(encoder: &E, samples: &[E::Sample]) -> Run<E::Output>
where
    E: Encoder + Clone,
    E::Output: Debug + PartialEq,
    <E::Output as Output>::Code: Debug + PartialEq,
{
    let mut single = encoder.clone();
    let outputs = samples.iter().map(|&sample| single.encode(sample)).collect();
    let expected = close(&mut single, outputs);
    let Some(&filler) = expected.outputs.first() else { return expected };

    let lengths = [samples.len(), 1, 2, 3, 7, 25];
    let few = if samples.len() > 500 { 1 } else { lengths.len() };
    for length in lengths.into_iter().take(few) {
        let mut mixed = encoder.clone();
        let mut outputs = Vec::new();
        for (turn, chunk) in samples.chunks(length).enumerate() {
            if turn % 3 == 2 {
                outputs.extend(chunk.iter().map(|&sample| mixed.encode(sample)));
                continue;
            }
            let mut buffer = vec![filler; chunk.len()];
            assert_eq!(mixed.encode_slice(chunk, &mut buffer), chunk.len());
            outputs.extend(buffer);
        }
        assert_eq!(close(&mut mixed, outputs), expected, "slices of {length}");
    }

    let mut halved = encoder.clone();
    let mut outputs = vec![filler; samples.len() / 2];
    assert_eq!(halved.encode_slice(samples, &mut outputs), samples.len() / 2);
    let rest = &samples[outputs.len()..];
    let mut buffer = vec![filler; rest.len() + 1];
    assert_eq!(halved.encode_slice(rest, &mut buffer), rest.len());
    outputs.extend(&buffer[..rest.len()]);
    assert_eq!(close(&mut halved, outputs), expected, "in halves");
    expected
}

fn close<E: Encoder>(encoder: &mut E, outputs: Vec<E::Output>) -> Run<E::Output> {
    let tail = encoder.finish().collect();
    Run { outputs, tail, rejected: encoder.rejected() }
}

/// As [`run`], from a scheme; and once more after a `reset` in the middle of the recording, which
/// must leave nothing behind.
///
/// # Panics
/// If the runs do not agree.
pub fn encode<P>(scheme: P, samples: &[P::Sample]) -> Run<<P::Encoder as Encoder>::Output>
where
    P: Scheme,
    P::Encoder: Clone,
    <P::Encoder as Encoder>::Output: Debug + PartialEq,
    <<P::Encoder as Encoder>::Output as Output>::Code: Debug + PartialEq,
{
    assert_eq!(scheme.latency(), P::LATENCY);
    let expected = run(&scheme.encoder(), samples);
    let mut used = scheme.encoder();
    for &sample in samples.iter().take(samples.len() / 2 + 1) {
        used.encode(sample);
    }
    used.reset();
    assert_eq!((used.rejected(), used.keyframe()), (0, None), "after a reset");
    assert_eq!(run(&used, samples), expected, "after a reset");
    expected
}

/// Decodes: one by one, in slices, and after a `reset`. All must agree to the bit.
///
/// # Panics
/// If they do not.
pub fn decode<D>(decoder: &D, codes: &[D::Code]) -> Vec<D::Sample>
where
    D: Decoder + Clone,
    D::Sample: Wire,
{
    let mut single = decoder.clone();
    let expected: Vec<_> = codes.iter().map(|&code| single.decode(code)).collect();
    for length in [3, codes.len() + 1] {
        let mut sliced = decoder.clone();
        let mut values = Vec::new();
        for chunk in codes.chunks(length) {
            let mut buffer = vec![D::Sample::default(); chunk.len()];
            assert_eq!(sliced.decode_slice(chunk, &mut buffer), chunk.len());
            values.extend(buffer);
        }
        assert_same_values(&values, &reals(&expected));
    }
    expected
}

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

/// Asserts the same values, bit for bit.
///
/// # Panics
/// If a bit differs.
pub fn assert_same_values<S: Wire>(ours: &[S], reference: &[S::Real]) {
    assert_eq!(ours.len(), reference.len());
    for (i, (ours, &reference)) in ours.iter().zip(reference).enumerate() {
        let (ours, reference): (f64, f64) = (ours.real().into(), reference.into());
        assert_eq!(ours.to_bits(), reference.to_bits(), "{ours} for {reference} at {i}");
    }
}

/// Values of the reference, cut to where the sample type saturates.
pub fn saturated<S: Wire>(values: &[S::Real]) -> Vec<S::Real> {
    let [lowest, highest] = S::ends();
    let cut = |value| match value {
        value if value < lowest => lowest,
        value if value > highest => highest,
        value => value,
    };
    values.iter().map(|&value| cut(value)).collect()
}

/// Spikes as the reference writes them.
pub fn signs_of(spikes: &[Spike]) -> Vec<i8> {
    spikes.iter().map(|spike| spike.sign()).collect()
}

/// Spikes as the crate takes them.
///
/// # Panics
/// If a number is not -1, 0 or 1.
pub fn spikes_of(signs: &[i8]) -> Vec<Spike> {
    let spike = |sign: &i8| match sign {
        -1 => Spike::Down,
        0 => Spike::None,
        1 => Spike::Up,
        sign => panic!("{sign} is no spike"),
    };
    signs.iter().map(spike).collect()
}

/// Checks the decoder of a temporal scheme, from 0 and from a known value.
///
/// # Panics
/// If a value differs from the reference.
pub fn check_step_decoder<S: Wire>(decoder: &StepDecoder<S>, signs: &[i8], step: S, start: S) {
    let [lowest, highest] = S::ends();
    let mut decoder = *decoder;
    for start in [S::default(), start] {
        decoder.resync(start);
        let expected = step_decode_within(signs, step.real(), start.real(), lowest, highest);
        assert_same_values(&decode(&decoder, &spikes_of(signs)), &expected);
    }
    decoder.reset();
    assert_eq!(decoder.value(), S::default());
}

/// Checks encoder and decoder of a rate scheme.
///
/// `reference` encodes a recording with a shift, without or with its tail. Where the type's residuals
/// saturate, it is given the saturated ones.
///
/// # Panics
/// If a spike or a value differs from the reference.
pub fn check_rate<'a, P, S, const F: usize>(
    scheme: P,
    samples: &[S],
    taps: &Taps<S, F>,
    shift: S,
    reference: impl Fn(&[S::Real], S::Real, bool) -> Vec<i8>,
) where
    S: Wire,
    P: Scheme<Sample = S, Decoder = RateDecoder<'a, S, F>>,
    P::Encoder: Encoder<Sample = S, Output = Option<Spike>> + Clone,
{
    let mut recording = finite(samples);
    let taps = reals(taps.as_array());
    let magnitude = taps.iter().fold(S::Real::ZERO, |sum, tap| sum + tap.magnitude());
    let mut base = shift.real();
    if let Some(limit) = S::residual_limit(magnitude) {
        for value in &mut recording.accepted {
            let residual = *value - base;
            *value = if residual > limit {
                limit
            } else if residual < -limit {
                -limit
            } else {
                residual
            };
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
pub fn check_rate_decoder<S: Wire, const F: usize>(
    decoder: &RateDecoder<'_, S, F>,
    signs: &[i8],
    taps: &[S::Real],
    shift: S,
) {
    let expected = saturated::<S>(&rate_decode(signs, taps, shift.real()));
    let mut decoder = *decoder;
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
    scheme: Position<'_, S, M>,
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
    assert_same_values(&[decoder.decode(None)], &[S::Real::ZERO]);
    decoder.reset();
    assert_same_values(&decode(&decoder, &run.outputs), &expected);
}
