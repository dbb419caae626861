//! Runs one direction of one codec in both forms and prints what it cost.

use core::{fmt, hint::black_box, mem::size_of};

use board::stopwatch::{instructions, stack_depth};
use spikewire::{Decoder, Encoder, Scheme};

use crate::signal::LENGTH;

/// Samples in one call of the slice form: the code of one sample takes up to 19 bytes, and a Cortex-M0 has 16 KiB.
const CHUNK: usize = 100;

/// What is measured.
pub struct Subject<'a> {
    pub signal: &'a str,
    pub codec: &'a str,
    pub sample: &'a str,
    /// Tables in flash, in bytes.
    pub flash: usize,
    /// Instructions of the plain transcription for the whole signal, encoding and decoding.
    pub plain: (u32, u32),
}

/// What it cost, over the whole signal.
#[derive(Default)]
struct Cost {
    total: u32,
    max: u32,
}

impl Cost {
    fn add(&mut self, count: u32, samples: usize) {
        self.total += count;
        self.max = self.max.max(count.div_ceil(samples as u32));
    }
}

impl Subject<'_> {
    /// Measures a scheme, encoding and decoding. `codes` is room for what one chunk encodes to.
    pub fn measure<P: Scheme>(
        &self,
        out: &mut impl fmt::Write,
        scheme: P,
        signal: &[P::Sample; LENGTH],
    ) -> fmt::Result {
        self.encode(out, scheme, signal)?;
        self.decode(out, scheme, signal)
    }

    fn encode<P: Scheme>(&self, out: &mut impl fmt::Write, scheme: P, signal: &[P::Sample; LENGTH]) -> fmt::Result {
        let state = size_of::<P::Encoder>();

        let mut encoder = scheme.encoder();
        let mut each = Cost::default();
        for &sample in signal {
            let call = instructions(|| _ = black_box(give_back(&mut encoder, black_box(sample))));
            let count = instructions(|| _ = black_box(encode_sample(&mut encoder, black_box(sample))));
            each.add(count.saturating_sub(call), 1);
        }
        let mut encoder = scheme.encoder();
        let stack = stack_depth(|| {
            for &sample in signal {
                black_box(encode_sample(&mut encoder, sample));
            }
        });
        self.print(out, "encode", "sample", &each, self.plain.0, state, stack)?;

        let mut encoder = scheme.encoder();
        let Some(&first) = signal.first() else { return Ok(()) };
        let mut outputs = core::array::from_fn::<_, CHUNK, _>(|_| encoder.encode(first));
        encoder.reset();
        let mut slice = Cost::default();
        for chunk in signal.chunks_exact(CHUNK) {
            let call = instructions(|| take_slices(&mut encoder, black_box(chunk), &mut outputs));
            let count = instructions(|| encode_slice(&mut encoder, black_box(chunk), &mut outputs));
            slice.add(count.saturating_sub(call), CHUNK);
            black_box(&outputs);
        }
        let mut encoder = scheme.encoder();
        let stack = stack_depth(|| {
            for chunk in signal.chunks_exact(CHUNK) {
                encode_slice(&mut encoder, chunk, &mut outputs);
            }
        });
        self.print(out, "encode", "slice", &slice, self.plain.0, state, stack)
    }

    fn decode<P: Scheme>(&self, out: &mut impl fmt::Write, scheme: P, signal: &[P::Sample; LENGTH]) -> fmt::Result {
        use spikewire::Output;

        let state = size_of::<P::Decoder>();
        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        let mut each = Cost::default();
        for &sample in signal {
            let Some(code) = encoder.encode(sample).code() else { continue };
            let call = instructions(|| _ = black_box(give_back(&mut decoder, black_box(code))));
            let count = instructions(|| _ = black_box(decode_sample(&mut decoder, black_box(code))));
            each.add(count.saturating_sub(call), 1);
        }
        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        let stack = stack_depth(|| {
            for &sample in signal {
                let Some(code) = encoder.encode(sample).code() else { continue };
                black_box(decode_sample(&mut decoder, code));
            }
        });
        self.print(out, "decode", "sample", &each, self.plain.1, state, stack)?;

        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        let Some(&first) = signal.first() else { return Ok(()) };
        let mut values = [first; CHUNK];
        let mut slice = Cost::default();
        for chunk in signal.chunks_exact(CHUNK) {
            let mut length = 0;
            let mut codes: [Option<_>; CHUNK] = core::array::from_fn(|_| None);
            for (slot, &sample) in codes.iter_mut().zip(chunk) {
                *slot = encoder.encode(sample).code();
                length += usize::from(slot.is_some());
            }
            let Some(code) = codes.iter().flatten().next() else { continue };
            let mut dense = [*code; CHUNK];
            dense.iter_mut().zip(codes.iter().flatten()).for_each(|(slot, code)| *slot = *code);
            let Some(dense) = dense.get(..length) else { continue };
            let call = instructions(|| take_slices(&mut decoder, black_box(dense), &mut values));
            let count = instructions(|| decode_slice(&mut decoder, black_box(dense), &mut values));
            slice.add(count.saturating_sub(call), length);
            black_box(&values);
        }
        self.print(out, "decode", "slice", &slice, self.plain.1, state, 0)
    }

    #[allow(clippy::too_many_arguments)]
    fn print(
        &self,
        out: &mut impl fmt::Write,
        direction: &str,
        form: &str,
        cost: &Cost,
        plain: u32,
        state: usize,
        stack: u32,
    ) -> fmt::Result {
        let Self { signal, codec, sample, flash, .. } = self;
        let Cost { total, max } = cost;
        writeln!(
            out,
            r#"{{"signal":"{signal}","codec":"{codec}","direction":"{direction}","sample":"{sample}","form":"{form}","samples":{LENGTH},"total":{total},"max":{max},"plain":{plain},"state":{state},"flash":{flash},"stack":{stack}}}"#
        )
    }
}

// What is counted is one call of a function that is not inlined, less one call of an empty one like it. Their
// symbols carry the codec's type, so that its code can be found and weighed.

#[inline(never)]
fn encode_sample<E: Encoder>(encoder: &mut E, sample: E::Sample) -> E::Output {
    encoder.encode(sample)
}

#[inline(never)]
fn encode_slice<E: Encoder>(encoder: &mut E, samples: &[E::Sample], outputs: &mut [E::Output]) {
    encoder.encode_slice(samples, outputs);
}

#[inline(never)]
fn decode_sample<D: Decoder>(decoder: &mut D, code: D::Code) -> D::Sample {
    decoder.decode(code)
}

#[inline(never)]
fn decode_slice<D: Decoder>(decoder: &mut D, codes: &[D::Code], values: &mut [D::Sample]) {
    decoder.decode_slice(codes, values);
}

#[inline(never)]
fn give_back<C, T>(codec: &mut C, value: T) -> T {
    black_box(codec);
    value
}

#[inline(never)]
fn take_slices<C, A, B>(codec: &mut C, inputs: &[A], outputs: &mut [B]) {
    black_box((codec, inputs.len(), outputs.len()));
}
