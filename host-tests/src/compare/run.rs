//! Every way to run an encoder or a decoder.

use core::fmt::Debug;

use spikewire::{Decoder, Encoder, Output, Scheme};

use super::wire::{Wire, assert_same_values, reals};

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

/// Decodes one by one, and in slices by turns with single codes. All must agree to the bit.
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
    let few = if codes.len() > 500 { 1 } else { 3 };
    for length in [codes.len().max(1), 3, 7].into_iter().take(few) {
        let mut mixed = decoder.clone();
        let mut values = Vec::new();
        for (turn, chunk) in codes.chunks(length).enumerate() {
            if turn % 3 == 2 {
                values.extend(chunk.iter().map(|&code| mixed.decode(code)));
                continue;
            }
            let mut buffer = vec![D::Sample::default(); chunk.len() + 1];
            assert_eq!(mixed.decode_slice(chunk, &mut buffer), chunk.len());
            values.extend(&buffer[..chunk.len()]);
        }
        assert_same_values(&values, &reals(&expected));
    }
    let mut halved = decoder.clone();
    let mut values = vec![D::Sample::default(); codes.len() / 2];
    assert_eq!(halved.decode_slice(codes, &mut values), codes.len() / 2);
    values.extend(codes[codes.len() / 2..].iter().map(|&code| halved.decode(code)));
    assert_same_values(&values, &reals(&expected));
    expected
}
