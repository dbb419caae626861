//! The trait of every scheme, and its encoder and decoder: parameters in flash, a small state for each channel.

use core::fmt::Debug;

use super::code::{Code, Destination, Output};
use crate::{ConfigError, Fingerprint, Sample};

/// A coding scheme: checked parameters as plain data, in a `const` or a `static`.
///
/// A scheme owns its taps, centres and thresholds. What changes from sample to sample is kept in a separate state,
/// so that any number of channels share one scheme. An [`Encoder`] or a [`Decoder`] is a reference to the scheme
/// and a state; made from one scheme, they cannot disagree on a parameter.
///
/// Encoding never fails and never panics. A sample that is not finite emits no spike and is counted as
/// [rejected](Self::rejected). Nothing else in the state changes, except that a code whose step or weight adapts counts
/// a silent sample.
pub trait Scheme: Sized {
    /// The type of its samples.
    type Sample: Sample;
    /// The code of one sample, which a decoder takes.
    type Code: Code;
    /// What encoding a sample returns: a code, or `None` while the encoder waits for later samples.
    type Output: Output<Code = Self::Code>;
    /// What an encoder keeps from sample to sample.
    type EncoderState;
    /// What a decoder keeps from sample to sample.
    type DecoderState: Clone + Debug;

    /// The latency in samples: how many samples after its own sample a code comes out. Where the filter length is
    /// chosen at run time it is the largest possible; [`latency`](Self::latency) gives that of this filter.
    const LATENCY: usize;

    /// How a decoder becomes exact again after codes were lost. Where the filter length is chosen at run time it is
    /// that of the longest filter; [`recovery`](Self::recovery) gives that of this filter.
    const RECOVERY: Recovery;

    /// The fingerprint of the scheme's name and of all its parameters, by which a link's receiver knows whether it has the
    /// sender's; see its [specification](Fingerprint#specification). For set-up, not for the hot path.
    fn fingerprint(&self) -> Fingerprint;

    /// Encodes one sample.
    fn encode(&self, state: &mut Self::EncoderState, sample: Self::Sample) -> Self::Output;

    /// Encodes samples in order into `outputs`, with the results of [`encode`](Self::encode), bit for bit. Stops
    /// at the end of the shorter slice and returns its length.
    fn encode_slice(
        &self,
        state: &mut Self::EncoderState,
        samples: &[Self::Sample],
        outputs: &mut [impl Destination<Self::Output>],
    ) -> usize {
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            output.write(self.encode(state, sample));
        }
        samples.len().min(outputs.len())
    }

    /// At the end of a recording, the next code that still waits for later samples; see [`Encoder::finish`].
    fn finish_next(&self, _state: &mut Self::EncoderState) -> Option<Self::Code> {
        None
    }

    /// Starts an encoder from the samples before its first one, oldest first; see [`Encoder::prime`].
    fn prime(&self, _state: &mut Self::EncoderState, _past: &[Self::Sample]) {}

    /// The value that a decoder should hold now, for a keyframe; see [`Encoder::keyframe`].
    fn keyframe(&self, _state: &Self::EncoderState) -> Option<Self::Sample> {
        None
    }

    /// Whether [`quiet_band`](Self::quiet_band) ever gives a band.
    const HAS_QUIET_BAND: bool = false;

    /// A baseline and a threshold, if a sample from `baseline - threshold` to `baseline + threshold` has a code without
    /// spikes and leaves the state as it is. In `f32` each bound is rounded once. A [`Bank`](crate::Bank) compares all its
    /// channels with their bands at once, and encodes only the samples outside.
    fn quiet_band(&self, _state: &Self::EncoderState) -> Option<(Self::Sample, Self::Sample)> {
        None
    }

    /// How many samples were not finite, up to 2³¹-1.
    fn rejected(state: &Self::EncoderState) -> u32;

    /// The state of a decoder before its first code.
    fn decoder_state(&self) -> Self::DecoderState;

    /// Decodes the code of one sample into its value, in the samples' unit.
    fn decode(&self, state: &mut Self::DecoderState, code: Self::Code) -> Self::Sample;

    /// Decodes codes in order into `values`, with the results of [`decode`](Self::decode), bit for bit. Stops at
    /// the end of the shorter slice and returns its length.
    fn decode_slice(
        &self,
        state: &mut Self::DecoderState,
        codes: &[impl Copy + Into<Self::Code>],
        values: &mut [Self::Sample],
    ) -> usize {
        for (value, &code) in values.iter_mut().zip(codes) {
            *value = self.decode(state, code.into());
        }
        codes.len().min(values.len())
    }

    /// The value that a decoder holds until the next spike; `None` for rate codes, whose values change
    /// between spikes.
    fn held(&self, _state: &Self::DecoderState) -> Option<Self::Sample> {
        None
    }

    /// Sets a decoder to a known value, such as a keyframe's, as if it had just decoded it. A rate code with a filter
    /// or a window, whose value is a sum over past spikes, forgets these instead.
    fn resync(&self, state: &mut Self::DecoderState, value: Self::Sample);

    /// An encoder in its initial state.
    fn encoder(&self) -> Encoder<'_, Self>
    where
        Self: Start,
    {
        Encoder::new(self)
    }

    /// A decoder in its initial state.
    fn decoder(&self) -> Decoder<'_, Self> {
        Decoder { scheme: self, state: self.decoder_state() }
    }

    /// The latency in samples: how many samples after its own sample a code comes out.
    fn latency(&self) -> usize {
        Self::LATENCY
    }

    /// How a decoder becomes exact again after codes were lost.
    fn recovery(&self) -> Recovery {
        Self::RECOVERY
    }

    /// Whether a state that was read back fits this scheme: its rings are as long as the scheme's, and its positions
    /// lie within them. The values in it are not checked. A state that does not fit gives wrong codes, but never
    /// panics.
    fn fits(&self, _state: &Self::EncoderState) -> bool {
        true
    }

    /// [`fits`](Self::fits) for a decoder's state.
    fn fits_decoder(&self, _state: &Self::DecoderState) -> bool {
        true
    }

    /// Whether a keyframe has the bits of the value that a decoder holds already which lost nothing, so that another value
    /// shows that sender and receiver have other schemes.
    fn holds_keyframes(&self) -> bool {
        false
    }

    /// Checks that its parameters are those for a sample every `period` µs, such as the corner of a filter before it.
    ///
    /// # Errors
    /// Returns an error that names the parameter.
    fn check_period(&self, _period: u32) -> Result<(), ConfigError> {
        Ok(())
    }

    /// How many neurons a channel has. Channels of one bank, readout or receiver have the same number.
    fn neurons(&self) -> usize {
        Self::Code::NEURONS
    }

    /// How many sub-timesteps a sample has; the last ones may stay unused. Where their number is chosen at run time and
    /// the scheme does not keep it, the largest possible.
    fn slots(&self) -> usize {
        Self::Code::SLOTS
    }
}

/// A scheme whose encoder starts from the parameters alone: every scheme but `Probabilistic`, which also needs a
/// random number generator.
pub trait Start: Scheme<EncoderState: Copy> {
    /// The state of an encoder before its first sample.
    const START: Self::EncoderState;
}

/// How a decoder becomes exact again after codes were lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Recovery {
    /// At the next keyframe: errors add up until then. A sample without spikes leaves the decoder as it is.
    Keyframe,
    /// At the next keyframe: errors add up until then. A sample without spikes changes the decoder's step, too; after
    /// this many in a row the step is the smallest, and further ones change nothing.
    TimedKeyframe(usize),
    /// After this many samples without a loss.
    Samples(usize),
    /// At the next sample whose code has a spike.
    Spike,
    /// Never bit for bit: the error fades. After this many samples without spikes the value has all but settled.
    Fading(usize),
}

/// Turns samples into spikes, one sample at a time: a reference to a scheme, and a state.
pub struct Encoder<'a, P: Scheme> {
    scheme: &'a P,
    pub(super) state: P::EncoderState,
}

impl<P: Scheme<EncoderState: Clone>> Clone for Encoder<'_, P> {
    fn clone(&self) -> Self {
        Self { scheme: self.scheme, state: self.state.clone() }
    }
}

impl<P: Scheme<EncoderState: Copy>> Copy for Encoder<'_, P> {}

impl<P: Scheme<EncoderState: Debug>> Debug for Encoder<'_, P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Encoder").field("state", &self.state).finish_non_exhaustive()
    }
}

impl<'a, P: Scheme> Encoder<'a, P> {
    /// An encoder in its initial state.
    pub const fn new(scheme: &'a P) -> Self
    where
        P: Start,
    {
        Self { scheme, state: P::START }
    }

    /// An encoder that goes on from the state of another encoder of the same scheme.
    ///
    /// With the feature `serde` a state can be written and read back: into memory that a reset leaves alone, into flash,
    /// to another program. Read it with the same version of the crate, on the same kind of core, in a format that keeps
    /// every `f32`, such as postcard; JSON loses NaN, from which [`StepForward`](crate::temporal::StepForward) starts.
    /// Add a checksum: a damaged state never panics, but its codes are wrong, perhaps until the [reset](Self::reset).
    /// [`Scheme::fits`] only finds states that no encoder of the scheme can have. A random number generator is part of
    /// the state, and must be `Serialize` and `Deserialize` itself.
    pub const fn with_state(scheme: &'a P, state: P::EncoderState) -> Self {
        Self { scheme, state }
    }

    /// The scheme.
    pub const fn scheme(&self) -> &'a P {
        self.scheme
    }

    /// The state.
    pub const fn state(&self) -> &P::EncoderState {
        &self.state
    }

    /// Encodes one sample.
    #[inline]
    pub fn encode(&mut self, sample: P::Sample) -> P::Output {
        self.scheme.encode(&mut self.state, sample)
    }

    /// Encodes samples in order into `outputs`, with the results of [`encode`](Self::encode), bit for bit. Stops
    /// at the end of the shorter slice and returns its length.
    #[inline]
    pub fn encode_slice(&mut self, samples: &[P::Sample], outputs: &mut [P::Output]) -> usize {
        self.scheme.encode_slice(&mut self.state, samples, outputs)
    }

    /// At the end of a recording, the next code that still waits for later samples; see [`finish`](Self::finish).
    pub fn finish_next(&mut self) -> Option<P::Code> {
        self.scheme.finish_next(&mut self.state)
    }

    /// At the end of a recording, the codes of the last samples, which wait for samples that never come.
    ///
    /// Empty for schemes of latency 0, and never needed in flight. Take all of them, then
    /// [`reset`](Self::reset) before the next recording.
    pub fn finish(&mut self) -> impl Iterator<Item = P::Code> {
        core::iter::from_fn(|| self.finish_next())
    }

    /// Starts from the samples before the first one, oldest first. A moving window takes as many as its window
    /// holds, the other temporal codes take the last one; rate, population and timing codes need none. Without a past
    /// the encoder starts from its first sample. If a sample that it takes is not finite, it takes none and counts one
    /// rejected sample.
    pub fn prime(&mut self, past: &[P::Sample]) {
        self.scheme.prime(&mut self.state, past);
    }

    /// The value that a decoder should hold now, for a keyframe on a link that may lose spikes.
    ///
    /// `None` before the first sample; while a value is not all that a decoder must know, as for an adaptive code that
    /// is not at rest; and for schemes whose decoders recover without keyframes.
    pub fn keyframe(&self) -> Option<P::Sample> {
        self.scheme.keyframe(&self.state)
    }

    /// Forgets every sample, and the count of rejected ones.
    pub fn reset(&mut self)
    where
        P: Start,
    {
        self.state = P::START;
    }

    /// How many samples were not finite, up to 2³¹-1.
    pub fn rejected(&self) -> u32 {
        P::rejected(&self.state)
    }
}

/// Turns spikes back into values, one sample's code at a time: a reference to a scheme, and a state.
pub struct Decoder<'a, P: Scheme> {
    scheme: &'a P,
    state: P::DecoderState,
}

impl<P: Scheme> Clone for Decoder<'_, P> {
    fn clone(&self) -> Self {
        Self { scheme: self.scheme, state: self.state.clone() }
    }
}

impl<P: Scheme<DecoderState: Copy>> Copy for Decoder<'_, P> {}

impl<P: Scheme> Debug for Decoder<'_, P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Decoder").field("state", &self.state).finish_non_exhaustive()
    }
}

impl<'a, P: Scheme> Decoder<'a, P> {
    /// A decoder that goes on from the state of another decoder of the same scheme; see [`Encoder::with_state`].
    pub const fn with_state(scheme: &'a P, state: P::DecoderState) -> Self {
        Self { scheme, state }
    }

    /// The scheme.
    pub const fn scheme(&self) -> &'a P {
        self.scheme
    }

    /// The state.
    pub const fn state(&self) -> &P::DecoderState {
        &self.state
    }

    /// Decodes the code of one sample into its value, in the samples' unit.
    #[inline]
    pub fn decode(&mut self, code: P::Code) -> P::Sample {
        self.scheme.decode(&mut self.state, code)
    }

    /// Decodes codes in order into `values`, with the results of [`decode`](Self::decode), bit for bit. Stops at
    /// the end of the shorter slice and returns its length.
    #[inline]
    pub fn decode_slice(&mut self, codes: &[P::Code], values: &mut [P::Sample]) -> usize {
        self.scheme.decode_slice(&mut self.state, codes, values)
    }

    /// The value that the decoder holds until the next spike; `None` for rate codes, whose values change between
    /// spikes.
    pub fn held(&self) -> Option<P::Sample> {
        self.scheme.held(&self.state)
    }

    /// Goes on from a known value, such as the first sample or a keyframe, as if it had just decoded it. A rate code
    /// with a filter or a window, whose value is a sum over past spikes, forgets these instead.
    pub fn resync(&mut self, value: P::Sample) {
        self.scheme.resync(&mut self.state, value);
    }

    /// Returns to the initial state.
    pub fn reset(&mut self) {
        self.state = self.scheme.decoder_state();
    }
}

/// Decodes a slice with a copy of a small state, which stays in registers.
#[inline]
pub(super) fn decode_copied<P: Scheme<DecoderState: Copy>>(
    scheme: &P,
    state: &mut P::DecoderState,
    codes: &[impl Copy + Into<P::Code>],
    values: &mut [P::Sample],
) -> usize {
    let mut local = *state;
    for (value, &code) in values.iter_mut().zip(codes) {
        *value = scheme.decode(&mut local, code.into());
    }
    *state = local;
    codes.len().min(values.len())
}

/// Encodes up to the first sample that the encoder is primed by, which its keyframe shows. Returns how many samples that
/// took, and as many samples and outputs after them as there are of both.
#[inline]
pub(super) fn encode_first<'s, 'o, P: Scheme, D: Destination<P::Output>>(
    scheme: &P,
    is_primed: bool,
    state: &mut P::EncoderState,
    samples: &'s [P::Sample],
    outputs: &'o mut [D],
) -> (usize, &'s [P::Sample], &'o mut [D]) {
    let length = samples.len().min(outputs.len());
    let mut first = 0;
    if !is_primed {
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            if scheme.keyframe(state).is_some() {
                break;
            }
            output.write(encode_apart(scheme, state, sample));
            first += 1;
        }
    }
    let samples = samples.get(first..length).unwrap_or_default();
    (first, samples, outputs.get_mut(first..length).unwrap_or_default())
}

/// Encodes sample by sample, and returns how many samples that took. Out of line, so that the usual path of a codec
/// stays small.
#[inline]
pub(super) fn encode_each<P: Scheme>(
    scheme: &P,
    state: &mut P::EncoderState,
    samples: &[P::Sample],
    outputs: &mut [impl Destination<P::Output>],
) -> usize {
    for (output, &sample) in outputs.iter_mut().zip(samples) {
        output.write(encode_apart(scheme, state, sample));
    }
    samples.len().min(outputs.len())
}

#[cold]
#[inline(never)]
fn encode_apart<P: Scheme>(
    scheme: &P,
    state: &mut P::EncoderState,
    sample: P::Sample,
) -> P::Output {
    scheme.encode(state, sample)
}
