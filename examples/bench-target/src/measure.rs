//! Runs a codec in both directions and both forms and prints what it cost.

use core::{fmt, hint::black_box, mem::size_of};

use board::stopwatch::{instructions, keep, stack_depth};
use spikewire::{Decoder, Encoder, Output, Scheme};

use crate::signal::LENGTH;

/// Samples in one call of the slice form: the code of one sample takes up to 19 bytes, and a
/// Cortex-M0 has 16 KiB.
pub const CHUNK: usize = 100;

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

/// What one form of one direction cost, over the whole signal.
struct Cost {
    direction: &'static str,
    form: &'static str,
    /// Where its code begins.
    code: usize,
    state: usize,
    samples: usize,
    total: u32,
    /// Of the worst sample; in the slice form, of the worst chunk's mean.
    max: u32,
    stack: u32,
}

impl Cost {
    fn new(direction: &'static str, form: &'static str, code: *const (), state: usize) -> Self {
        let code = code.addr();
        Self { direction, form, code, state, samples: 0, total: 0, max: 0, stack: 0 }
    }

    /// Counts a piece of work, less the same call of a function that does nothing.
    fn add(&mut self, samples: usize, call: u32, count: u32) {
        let count = count.saturating_sub(call);
        self.samples += samples;
        self.total += count;
        self.max = self.max.max(count.div_ceil(samples.max(1) as u32));
    }
}

impl Subject<'_> {
    /// Measures a scheme, encoding and decoding.
    pub fn measure<P: Scheme>(
        &self,
        out: &mut impl fmt::Write,
        scheme: P,
        signal: &[P::Sample; LENGTH],
    ) -> fmt::Result {
        self.measure_codec(out, || scheme.encoder(), || scheme.decoder(), signal)
    }

    /// Measures an encoder and its decoder.
    pub fn measure_codec<E, D>(
        &self,
        out: &mut impl fmt::Write,
        encoder: impl Fn() -> E,
        decoder: impl Fn() -> D,
        signal: &[E::Sample; LENGTH],
    ) -> fmt::Result
    where
        E: Encoder,
        D: Decoder<Sample = E::Sample, Code = <E::Output as Output>::Code>,
    {
        for cost in encoding(&encoder, signal) {
            self.print(out, &cost, self.plain.0)?;
        }
        for cost in decoding(&encoder, decoder, signal) {
            self.print(out, &cost, self.plain.1)?;
        }
        Ok(())
    }

    #[inline(never)]
    fn print(&self, out: &mut impl fmt::Write, cost: &Cost, plain: u32) -> fmt::Result {
        let Self { signal, codec, sample, flash, .. } = self;
        let Cost { direction, form, code, state, samples, total, max, stack } = cost;
        write!(out, r#"{{"signal":"{signal}","codec":"{codec}","direction":"{direction}","#)?;
        write!(out, r#""sample":"{sample}","form":"{form}","samples":{samples},"total":{total},"#)?;
        write!(out, r#""max":{max},"plain_samples":{LENGTH},"plain":{plain},"code":{code},"#)?;
        writeln!(out, r#""state":{state},"flash":{flash},"stack":{stack}}}"#)
    }
}

#[inline(never)] // its buffer leaves the stack before decoding
fn encoding<E: Encoder>(new: &impl Fn() -> E, signal: &[E::Sample; LENGTH]) -> [Cost; 2] {
    let state = size_of::<E>();

    let mut each = Cost::new("encode", "sample", encode_sample::<E> as *const (), state);
    let mut encoder = new();
    for &sample in signal {
        let call = instructions(|| take_one(&mut encoder, black_box(sample)));
        let count = instructions(|| keep(&encode_sample(&mut encoder, black_box(sample))));
        each.add(1, call, count);
    }
    let mut encoder = new();
    each.stack = stack_depth(|| signal.iter().for_each(|&x| keep(&encode_sample(&mut encoder, x))));

    let mut slice = Cost::new("encode", "slice", encode_slice::<E> as *const (), state);
    let mut outputs = [encode_sample(&mut new(), signal[0]); CHUNK];
    let mut encoder = new();
    for chunk in signal.chunks_exact(CHUNK) {
        let call = instructions(|| take_slices(&mut encoder, black_box(chunk), &mut outputs));
        let count = instructions(|| encode_slice(&mut encoder, black_box(chunk), &mut outputs));
        slice.add(CHUNK, call, count);
        keep(&outputs);
    }
    let mut encoder = new();
    slice.stack = stack_depth(|| {
        signal.chunks_exact(CHUNK).for_each(|x| encode_slice(&mut encoder, x, &mut outputs));
    });
    [each, slice]
}

#[inline(never)]
fn decoding<E, D>(
    encoder: &impl Fn() -> E,
    new: impl Fn() -> D,
    signal: &[E::Sample; LENGTH],
) -> [Cost; 2]
where
    E: Encoder,
    D: Decoder<Sample = E::Sample, Code = <E::Output as Output>::Code>,
{
    let state = size_of::<D>();
    let mut each = Cost::new("decode", "sample", decode_sample::<D> as *const (), state);
    let mut slice = Cost::new("decode", "slice", decode_slice::<D> as *const (), state);
    // One decoder for each thing measured, as every one sees every code once.
    let mut decoders = [new(), new(), new(), new()];
    let [one, one_stack, many, many_stack] = &mut decoders;

    let mut first = encoder();
    let code = signal.iter().find_map(|&sample| encode_sample(&mut first, sample).code());
    let Some(code) = code else { return [each, slice] };
    let mut codes = [code; CHUNK];
    let mut values = [signal[0]; CHUNK];
    let mut encoder = encoder();
    for chunk in signal.chunks_exact(CHUNK) {
        let mut length = 0;
        for &sample in chunk {
            if let Some(code) = encode_sample(&mut encoder, sample).code() {
                codes[length] = code;
                length += 1;
            }
        }
        let codes = &codes[..length];
        for &code in codes {
            let call = instructions(|| take_one(one, black_box(code)));
            let count = instructions(|| keep(&decode_sample(one, black_box(code))));
            each.add(1, call, count);
        }
        let call = instructions(|| take_slices(many, black_box(codes), &mut values));
        let count = instructions(|| decode_slice(many, black_box(codes), &mut values));
        slice.add(length, call, count);

        let depth = stack_depth(|| codes.iter().for_each(|&x| keep(&decode_sample(one_stack, x))));
        each.stack = each.stack.max(depth);
        let depth = stack_depth(|| decode_slice(many_stack, codes, &mut values));
        slice.stack = slice.stack.max(depth);
        keep(&values);
    }
    [each, slice]
}

// What is counted is one call of a function that is not inlined, less one call of an empty one like
// it. Their addresses are printed, so that the code can be found and weighed.

#[inline(never)]
pub fn encode_sample<E: Encoder>(encoder: &mut E, sample: E::Sample) -> E::Output {
    encoder.encode(sample)
}

#[inline(never)]
fn encode_slice<E: Encoder>(encoder: &mut E, samples: &[E::Sample], outputs: &mut [E::Output]) {
    encoder.encode_slice(samples, outputs);
}

#[inline(never)]
pub fn decode_sample<D: Decoder>(decoder: &mut D, code: D::Code) -> D::Sample {
    decoder.decode(code)
}

#[inline(never)]
fn decode_slice<D: Decoder>(decoder: &mut D, codes: &[D::Code], values: &mut [D::Sample]) {
    decoder.decode_slice(codes, values);
}

#[inline(never)]
fn take_one<C, T>(codec: &mut C, value: T) {
    keep(codec);
    // What does not fit in registers comes by address, and is copied there by the caller.
    if size_of::<T>() > 8 {
        keep(&value);
    }
}

#[inline(never)]
fn take_slices<C, A, B>(codec: &mut C, inputs: &[A], outputs: &mut [B]) {
    keep(codec);
    keep(inputs);
    keep(outputs);
}
