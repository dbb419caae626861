//! Every way to run an encoder or a decoder.

use core::fmt::Debug;

use spikewire::{Decoder, Destination, Encoder, Output, Scheme, Start};

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

/// A scheme whose runs can be repeated and compared.
pub trait Repeatable:
    Scheme<EncoderState: Clone, Output: Debug + PartialEq, Code: Debug + PartialEq>
{
}

impl<P> Repeatable for P where
    P: Scheme<EncoderState: Clone, Output: Debug + PartialEq, Code: Debug + PartialEq>
{
}

/// Runs an encoder over a recording, in the forms that must all agree:
/// - sample by sample, by the encoder and by the scheme with a state apart;
/// - by the scheme in slices of several lengths (long recordings in one only), in turn with single
///   samples;
/// - by the encoder in slices, with outputs for half the samples first.
///
/// # Panics
/// If they do not agree.
pub fn run<P: Repeatable>(encoder: &Encoder<'_, P>, samples: &[P::Sample]) -> Run<P::Output> {
    let mut single = encoder.clone();
    let outputs = samples.iter().map(|&sample| single.encode(sample)).collect();
    let expected = close(&mut single, outputs);

    let (scheme, state) = (encoder.scheme(), encoder.state());
    let mut apart = state.clone();
    let outputs = samples.iter().map(|&sample| scheme.encode(&mut apart, sample)).collect();
    assert_eq!(close_state(scheme, apart, outputs), expected, "with the state apart");
    let Some(&filler) = expected.outputs.first() else { return expected };

    let lengths = [samples.len(), 1, 2, 3, 7, 25];
    let few = if samples.len() > 500 { 1 } else { lengths.len() };
    for length in lengths.into_iter().take(few) {
        let mut mixed = state.clone();
        let mut outputs = Vec::new();
        for (turn, chunk) in samples.chunks(length).enumerate() {
            if turn % 3 == 2 {
                outputs.extend(chunk.iter().map(|&sample| scheme.encode(&mut mixed, sample)));
                continue;
            }
            let mut buffer = vec![filler; chunk.len()];
            assert_eq!(scheme.encode_slice(&mut mixed, chunk, &mut buffer), chunk.len());
            outputs.extend(buffer);
        }
        assert_eq!(close_state(scheme, mixed, outputs), expected, "slices of {length}");
    }

    let mut halved = encoder.clone();
    let mut outputs = vec![filler; samples.len() / 2];
    assert_eq!(halved.encode_slice(samples, &mut outputs), samples.len() / 2);
    let rest = &samples[outputs.len()..];
    let mut buffer = vec![filler; rest.len() + 1];
    assert_eq!(halved.encode_slice(rest, &mut buffer), rest.len());
    outputs.extend(&buffer[..rest.len()]);
    assert_eq!(close(&mut halved, outputs), expected, "in halves");

    let mut empty = state.clone();
    let mut rooms: Vec<Room<P::Output>> = samples.iter().map(|_| Room(None)).collect();
    assert_eq!(scheme.encode_slice(&mut empty, samples, &mut rooms), samples.len());
    let outputs = rooms.into_iter().map(|Room(output)| output.expect("an output")).collect();
    assert_eq!(close_state(scheme, empty, outputs), expected, "into empty memory");
    expected
}

/// Memory that holds no output at first.
struct Room<T>(Option<T>);

impl<T> Destination<T> for Room<T> {
    fn write(&mut self, output: T) {
        self.0 = Some(output);
    }
}

fn close<P: Scheme>(encoder: &mut Encoder<'_, P>, outputs: Vec<P::Output>) -> Run<P::Output> {
    let tail = encoder.finish().collect();
    Run { outputs, tail, rejected: encoder.rejected() }
}

/// As [`close`], by the scheme.
fn close_state<P: Scheme>(
    scheme: &P,
    mut state: P::EncoderState,
    outputs: Vec<P::Output>,
) -> Run<P::Output> {
    let tail = std::iter::from_fn(|| scheme.finish_next(&mut state)).collect();
    Run { outputs, tail, rejected: P::rejected(&state) }
}

/// As [`run`], from a scheme; and once more after a `reset` in the middle of the recording, which
/// must leave nothing behind.
///
/// # Panics
/// If the runs do not agree.
pub fn encode<P: Repeatable + Start>(scheme: &P, samples: &[P::Sample]) -> Run<P::Output> {
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

/// Decodes one by one, by the decoder and by the scheme with a state apart, and in slices by turns with
/// single codes. All must agree to the bit.
///
/// # Panics
/// If they do not.
pub fn decode<P: Scheme<Sample: Wire>>(
    decoder: &Decoder<'_, P>,
    codes: &[P::Code],
) -> Vec<P::Sample> {
    let mut single = decoder.clone();
    let expected: Vec<_> = codes.iter().map(|&code| single.decode(code)).collect();

    let scheme = decoder.scheme();
    let mut apart = decoder.state().clone();
    let values: Vec<_> = codes.iter().map(|&code| scheme.decode(&mut apart, code)).collect();
    assert_same_values(&values, &reals(&expected));

    let few = if codes.len() > 500 { 1 } else { 3 };
    for length in [codes.len().max(1), 3, 7].into_iter().take(few) {
        let mut mixed = decoder.state().clone();
        let mut values = Vec::new();
        for (turn, chunk) in codes.chunks(length).enumerate() {
            if turn % 3 == 2 {
                values.extend(chunk.iter().map(|&code| scheme.decode(&mut mixed, code)));
                continue;
            }
            let mut buffer = vec![P::Sample::default(); chunk.len() + 1];
            assert_eq!(scheme.decode_slice(&mut mixed, chunk, &mut buffer), chunk.len());
            values.extend(&buffer[..chunk.len()]);
        }
        assert_same_values(&values, &reals(&expected));
    }
    let mut halved = decoder.clone();
    let mut values = vec![P::Sample::default(); codes.len() / 2];
    assert_eq!(halved.decode_slice(codes, &mut values), codes.len() / 2);
    values.extend(codes[codes.len() / 2..].iter().map(|&code| halved.decode(code)));
    assert_same_values(&values, &reals(&expected));
    expected
}
