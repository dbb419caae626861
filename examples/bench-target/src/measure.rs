//! Runs a codec in both directions and both forms and prints what it cost.

use core::{fmt, hint::black_box, mem::size_of};

use board::stopwatch::{Count, counted, keep, stack_depth};
use spikewire::{Output, Scheme};

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
    /// The same for the encoder in C, where there is one.
    pub in_c: Count,
}

/// What one form of one direction cost, over the whole signal.
struct Cost {
    direction: &'static str,
    form: &'static str,
    /// Where its code begins.
    code: usize,
    state: usize,
    samples: usize,
    total: Count,
    /// Of the worst sample; in the slice form, of the worst chunk's mean.
    max: Count,
    stack: u32,
}

impl Cost {
    fn new(direction: &'static str, form: &'static str, code: *const (), state: usize) -> Self {
        let (code, total) = (code.addr(), Count::default());
        Self { direction, form, code, state, samples: 0, total, max: total, stack: 0 }
    }

    /// Counts a piece of work, less the same call of a function that does nothing.
    fn add(&mut self, samples: usize, call: Count, count: Count) {
        let count = count.saturating_sub(call);
        self.samples += samples;
        self.total += count;
        self.max = self.max.max(count.div_ceil(samples.max(1) as u32));
    }
}

impl Subject<'_> {
    /// Measures a scheme whose encoders start so, encoding and decoding.
    pub fn measure<P: Scheme>(
        &self,
        out: &mut impl fmt::Write,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        signal: &[P::Sample; LENGTH],
    ) -> fmt::Result {
        for cost in encoding(scheme, start, signal) {
            self.print(out, &cost, self.plain.0, self.in_c)?;
        }
        for cost in decoding(scheme, start, signal) {
            self.print(out, &cost, self.plain.1, Count::default())?;
        }
        Ok(())
    }

    #[inline(never)]
    fn print(
        &self,
        out: &mut impl fmt::Write,
        cost: &Cost,
        plain: u32,
        in_c: Count,
    ) -> fmt::Result {
        let Self { signal, codec, sample, flash, .. } = self;
        let Cost { direction, form, code, state, samples, total, max, stack } = cost;
        write!(out, r#"{{"signal":"{signal}","codec":"{codec}","direction":"{direction}","#)?;
        write!(out, r#""sample":"{sample}","form":"{form}","samples":{samples},"#)?;
        print_count(out, "total", total)?;
        print_count(out, "max", max)?;
        print_count(out, "in_c", &in_c)?;
        write!(out, r#""plain_samples":{LENGTH},"plain":{plain},"code":{code},"#)?;
        writeln!(out, r#""state":{state},"flash":{flash},"stack":{stack}}}"#)
    }
}

#[inline(never)] // its buffer leaves the stack before decoding
fn encoding<P: Scheme>(
    scheme: &P,
    start: &impl Fn() -> P::EncoderState,
    signal: &[P::Sample; LENGTH],
) -> [Cost; 2] {
    let size = size_of::<P::EncoderState>();

    let mut each = Cost::new("encode", "sample", encode_sample::<P> as *const (), size);
    let mut state = start();
    for &sample in signal {
        let call = counted(|| take_one(scheme, &mut state, black_box(sample)));
        let count = counted(|| keep(&encode_sample(scheme, &mut state, black_box(sample))));
        each.add(1, call, count);
    }
    let mut state = start();
    each.stack = stack_depth(|| {
        signal.iter().for_each(|&x| keep(&encode_sample(scheme, &mut state, x)));
    });

    let mut slice = Cost::new("encode", "slice", encode_slice::<P> as *const (), size);
    let mut outputs = [encode_sample(scheme, &mut start(), signal[0]); CHUNK];
    let mut state = start();
    for chunk in signal.chunks_exact(CHUNK) {
        let call = counted(|| take_slices(scheme, &mut state, black_box(chunk), &mut outputs));
        let count = counted(|| encode_slice(scheme, &mut state, black_box(chunk), &mut outputs));
        slice.add(CHUNK, call, count);
        keep(&outputs);
    }
    let mut state = start();
    slice.stack = stack_depth(|| {
        let chunks = signal.chunks_exact(CHUNK);
        chunks.for_each(|x| encode_slice(scheme, &mut state, x, &mut outputs));
    });
    [each, slice]
}

#[inline(never)]
fn decoding<P: Scheme>(
    scheme: &P,
    start: &impl Fn() -> P::EncoderState,
    signal: &[P::Sample; LENGTH],
) -> [Cost; 2] {
    let size = size_of::<P::DecoderState>();
    let mut each = Cost::new("decode", "sample", decode_sample::<P> as *const (), size);
    let mut slice = Cost::new("decode", "slice", decode_slice::<P> as *const (), size);
    // One decoder for each thing measured, as every one sees every code once.
    let mut decoders = [(); 4].map(|()| scheme.decoder_state());
    let [one, one_stack, many, many_stack] = &mut decoders;

    let mut first = start();
    let code = signal.iter().find_map(|&sample| encode_sample(scheme, &mut first, sample).code());
    let Some(code) = code else { return [each, slice] };
    let mut codes = [code; CHUNK];
    let mut values = [signal[0]; CHUNK];
    let mut encoder = start();
    for chunk in signal.chunks_exact(CHUNK) {
        let mut length = 0;
        for &sample in chunk {
            if let Some(code) = encode_sample(scheme, &mut encoder, sample).code() {
                codes[length] = code;
                length += 1;
            }
        }
        let codes = &codes[..length];
        for &code in codes {
            let call = counted(|| take_one(scheme, one, black_box(code)));
            let count = counted(|| keep(&decode_sample(scheme, one, black_box(code))));
            each.add(1, call, count);
        }
        let call = counted(|| take_slices(scheme, many, black_box(codes), &mut values));
        let count = counted(|| decode_slice(scheme, many, black_box(codes), &mut values));
        slice.add(length, call, count);

        let depth = stack_depth(|| {
            codes.iter().for_each(|&x| keep(&decode_sample(scheme, one_stack, x)));
        });
        each.stack = each.stack.max(depth);
        let depth = stack_depth(|| decode_slice(scheme, many_stack, codes, &mut values));
        slice.stack = slice.stack.max(depth);
        keep(&values);
    }
    [each, slice]
}

/// A member of a line of JSON, and the comma after it.
pub fn print_count(out: &mut impl fmt::Write, name: &str, count: &Count) -> fmt::Result {
    let Count { instructions, cycles: [least, most] } = count;
    write!(out, r#""{name}":{instructions},"{name}_cycles":[{least},{most}],"#)
}

// What is counted is one call of a function that is not inlined, less one call of an empty one like
// it. Their addresses are printed, so that the code can be found and weighed.

#[inline(never)]
pub fn encode_sample<P: Scheme>(
    scheme: &P,
    state: &mut P::EncoderState,
    sample: P::Sample,
) -> P::Output {
    scheme.encode(state, sample)
}

#[inline(never)]
fn encode_slice<P: Scheme>(
    scheme: &P,
    state: &mut P::EncoderState,
    samples: &[P::Sample],
    outputs: &mut [P::Output],
) {
    scheme.encode_slice(state, samples, outputs);
}

#[inline(never)]
pub fn decode_sample<P: Scheme>(
    scheme: &P,
    state: &mut P::DecoderState,
    code: P::Code,
) -> P::Sample {
    scheme.decode(state, code)
}

#[inline(never)]
fn decode_slice<P: Scheme>(
    scheme: &P,
    state: &mut P::DecoderState,
    codes: &[P::Code],
    values: &mut [P::Sample],
) {
    scheme.decode_slice(state, codes, values);
}

#[inline(never)]
fn take_one<P, C, T>(scheme: &P, state: &mut C, value: T) {
    keep(scheme);
    keep(state);
    // What does not fit in registers comes by address, and is copied there by the caller.
    if size_of::<T>() > 8 {
        keep(&value);
    }
}

#[inline(never)]
fn take_slices<P, C, A, B>(scheme: &P, state: &mut C, inputs: &[A], outputs: &mut [B]) {
    keep(scheme);
    keep(state);
    keep(inputs);
    keep(outputs);
}
