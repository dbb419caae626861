//! The contract that every scheme keeps: parameters that make a matching encoder and decoder.

use crate::{Sample, spike::Code, spike::Spike};

/// A coding scheme: checked parameters, plain data, kept in flash and copied freely.
///
/// An encoder and a decoder made by the same scheme cannot disagree on a parameter.
pub trait Scheme: Copy {
    /// The numbers it works on.
    type Sample: Sample;
    /// What turns samples into spikes.
    type Encoder: Encoder<Sample = Self::Sample>;
    /// What turns the spikes back.
    type Decoder: Decoder<Sample = Self::Sample, Code = <<Self::Encoder as Encoder>::Output as Output>::Code>;

    /// How many samples after its own the code of a sample comes out.
    const LATENCY: usize;

    /// An encoder in its initial state.
    fn encoder(self) -> Self::Encoder;

    /// A decoder in its initial state.
    fn decoder(self) -> Self::Decoder;

    /// How many samples after its own the code of a sample comes out.
    fn latency(self) -> usize {
        Self::LATENCY
    }
}

/// Turns samples into spikes, one sample at a time.
///
/// Encoding cannot fail and never panics. A sample that is not finite emits nothing, leaves the
/// state as it was and is counted.
pub trait Encoder {
    /// The numbers it works on.
    type Sample: Sample;
    /// What [`encode`](Self::encode) returns.
    type Output: Output;

    /// Takes one sample and says what is emitted.
    fn encode(&mut self, sample: Self::Sample) -> Self::Output;

    /// Encodes samples in order into `outputs`: the same bits as one
    /// [`encode`](Self::encode) each. Stops at the end of the shorter slice and returns its length.
    fn encode_slice(&mut self, samples: &[Self::Sample], outputs: &mut [Self::Output]) -> usize {
        encode_each(self, samples, outputs)
    }

    /// The next code of the tail at the end of a recording; see [`finish`](Self::finish).
    fn finish_next(&mut self) -> Option<<Self::Output as Output>::Code> {
        None
    }

    /// Where a recording ends, the codes of the samples that still wait for their look-ahead.
    ///
    /// Empty for schemes of latency 0. Never needed in flight. Run it to its end, then
    /// [`reset`](Self::reset) before the next recording.
    fn finish(&mut self) -> impl Iterator<Item = <Self::Output as Output>::Code> {
        core::iter::from_fn(|| self.finish_next())
    }

    /// The value that a decoder should hold now, for a keyframe on a link that may lose spikes.
    ///
    /// `None` before the first sample, and for schemes whose decoders forget by themselves.
    fn keyframe(&self) -> Option<Self::Sample> {
        None
    }

    /// Forgets every sample, and the count of rejected ones.
    fn reset(&mut self);

    /// How many samples were not finite, up to 2³¹-1.
    fn rejected(&self) -> u32;
}

/// The slice form by the sample form: apart, so that the usual path of a codec stays small.
#[cold]
#[inline(never)]
pub(crate) fn encode_each<E: Encoder + ?Sized>(
    encoder: &mut E,
    samples: &[E::Sample],
    outputs: &mut [E::Output],
) -> usize {
    for (output, &sample) in outputs.iter_mut().zip(samples) {
        *output = encode_apart(encoder, sample);
    }
    samples.len().min(outputs.len())
}

/// The same up to where a keyframe can be had: how many samples that takes.
#[cold]
#[inline(never)]
pub(crate) fn encode_first<E: Encoder + ?Sized>(
    encoder: &mut E,
    samples: &[E::Sample],
    outputs: &mut [E::Output],
) -> usize {
    let mut taken = 0;
    for (output, &sample) in outputs.iter_mut().zip(samples) {
        if encoder.keyframe().is_some() {
            break;
        }
        *output = encode_apart(encoder, sample);
        taken += 1;
    }
    taken
}

#[cold]
#[inline(never)]
fn encode_apart<E: Encoder + ?Sized>(encoder: &mut E, sample: E::Sample) -> E::Output {
    encoder.encode(sample)
}

/// Turns spikes back into values, one output of the encoder at a time.
pub trait Decoder {
    /// The numbers it works on.
    type Sample: Sample;
    /// What it decodes.
    type Code: Code;

    /// Takes one output of the encoder and gives the value of its sample.
    fn decode(&mut self, code: Self::Code) -> Self::Sample;

    /// Decodes in order into `values`: the same bits as one [`decode`](Self::decode) each. Stops at
    /// the end of the shorter slice and returns its length.
    fn decode_slice(&mut self, codes: &[Self::Code], values: &mut [Self::Sample]) -> usize {
        for (value, &code) in values.iter_mut().zip(codes) {
            *value = self.decode(code);
        }
        codes.len().min(values.len())
    }

    /// Goes on from a known value, such as a keyframe's, as if the last one decoded had been it.
    fn resync(&mut self, value: Self::Sample);

    /// Back to the initial state.
    fn reset(&mut self);
}

/// What an encoder returns for a sample: a code, or nothing yet.
pub trait Output: Copy {
    /// The code within, which a decoder takes.
    type Code: Code;

    /// The code, or `None` while the encoder still waits for its look-ahead.
    fn code(self) -> Option<Self::Code>;
}

impl Output for Spike {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}

/// Rate codes: `None` until the first window is full, then the spike of the sample
/// [`LATENCY`](Scheme::LATENCY) ago.
impl Output for Option<Spike> {
    type Code = Spike;

    fn code(self) -> Option<Spike> {
        self
    }
}
