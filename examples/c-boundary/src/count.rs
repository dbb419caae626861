//! What the schemes take on a recorded flight, in instructions: the same work as `bindings/c/tests/count.c` does in C.
//!
//! ```text
//! sf f32 encode 12345 encode_slice 2345 decode 3456 decode_slice 1234
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use board::stopwatch::{instructions, keep};
use catalogue::{Channel, Flight};
use core::{fmt::Write, hint::black_box, marker::PhantomData};
use fixed::types::{I8F8, I16F16};
use flight_log::{Recorded, channel};
use spikewire::{Calibration, ConfigError, Encoder, Output, Scheme};

/// Where the flight is lively, and how long.
const FIRST: usize = 1000;
const LENGTH: usize = 800;
/// Samples of a call of the slice forms.
const SLICE: usize = 200;

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    let mut out = board::console();
    board::finish(run(&mut out))
}

fn run(out: &mut impl Write) -> core::fmt::Result {
    count::<f32>(out, "f32")?;
    count::<i16>(out, "i16")?;
    count::<I8F8>(out, "q8.8")?;
    count::<I16F16>(out, "q16.16")
}

fn count<S: Recorded>(out: &mut impl Write, sample: &'static str) -> core::fmt::Result {
    let mut calibration = Calibration::<S>::new();
    channel::<S>(0).for_each(|sample| calibration.observe(sample));
    let channel = Channel::new(0, calibration);
    let counted = catalogue::fly(&channel, &mut Counted { out, sample, of: PhantomData });
    counted.map_err(|_| core::fmt::Error)
}

struct Counted<'o, S, W> {
    out: &'o mut W,
    sample: &'static str,
    of: PhantomData<S>,
}

impl<S: Recorded, W: Write> Flight for Counted<'_, S, W> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Scheme<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let mut samples = [S::default(); LENGTH];
        for (place, sample) in samples.iter_mut().zip(channel::<S>(0).skip(FIRST)) {
            *place = sample;
        }
        let counts = counted(scheme, start, &samples);
        let [encode, decode, slice, decoded] = counts;
        let sample = self.sample;
        // A console that fails shows in what is missing.
        let _ = writeln!(
            self.out,
            "{name} {sample} encode {encode} encode_slice {slice} decode {decode} decode_slice {decoded}"
        );
        Ok(())
    }
}

/// Encodes the first half sample by sample and the second in slices, and decodes both likewise.
#[inline(never)]
fn counted<P: Scheme>(
    scheme: &P,
    start: P::EncoderState,
    samples: &[P::Sample; LENGTH],
) -> [u32; 4] {
    let scheme = black_box(scheme);
    let mut encoder = Encoder::with_state(scheme, start);
    let mut decoder = scheme.decoder();
    let mut counts = [0; 4];
    let [encode, decode, encode_slice, decode_slice] = &mut counts;
    for (chunk, samples) in samples.chunks(SLICE).enumerate() {
        let mut outputs = [const { None::<P::Output> }; SLICE];
        if chunk < LENGTH / SLICE / 2 {
            *encode += instructions(|| {
                for (output, &sample) in outputs.iter_mut().zip(samples) {
                    *output = Some(encoder.encode(sample));
                    keep(output);
                }
            });
            let mut value = P::Sample::default();
            for code in outputs.into_iter().flatten().filter_map(Output::code) {
                *decode += instructions(|| {
                    value = decoder.decode(code);
                    keep(&value);
                });
            }
        } else {
            // Any output, to fill a slice with.
            let Some(first) = samples.first().map(|&sample| encoder.encode(sample)) else { break };
            let rest = samples.get(1..).unwrap_or_default();
            let mut filled = [first; SLICE - 1];
            *encode_slice += instructions(|| {
                encoder.encode_slice(rest, &mut filled);
                keep(&filled);
            });
            let Some(one) = filled.into_iter().find_map(Output::code) else { continue };
            let mut codes = [one; SLICE - 1];
            for (place, code) in codes.iter_mut().zip(filled.into_iter().filter_map(Output::code)) {
                *place = code;
            }
            let mut values = [P::Sample::default(); SLICE - 1];
            *decode_slice += instructions(|| {
                decoder.decode_slice(&codes, &mut values);
                keep(&values);
            });
        }
    }
    counts
}
