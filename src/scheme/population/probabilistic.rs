//! Gaussian receptive fields with probabilistic spiking: the stronger the response, the likelier the
//! spike.

use core::marker::PhantomData;
use core::ops::RangeInclusive;

use rand_core::Rng;

use super::FiredNeurons;
use super::Held;
use super::fields::{Fields, ReceptiveFields};
use super::methods::{centred, encode_in_place};
use crate::error::{tri, unwrap};
use crate::num::{Distance, Tally};
use crate::{ConfigError, Encoder, Fingerprint, Recovery, Sample, Scheme};

/// Gaussian receptive fields in which a neuron fires with a probability equal to its response, drawn from the
/// caller's random number generator.
///
/// The probability is rounded to a multiple of `1 / N`, half up: a neuron of level `k` (see
/// [`Slots`](super::Slots)) fires if the top bits of a 32-bit draw, a number below `N`, are below `k`.
/// One draw is taken for each neuron that responds with level 1 or more, by rising index.
///
/// - **M:** 3 to 1024. **N:** a power of two, 2 to 256. **Beta:** above 0; the paper takes 1.5.
/// - **Latency:** 0 samples. **Memory:** 4 bytes a channel and the generator, 4 to decode in `f32`;
///   the scheme takes `4 M + 4 N + 28` bytes of flash in `f32`.
/// - **Work:** one comparison with the table a neuron; no exponential.
/// - **Decoder:** the mean of the centres of the neurons that fired; if none did, the previous value. Fixed point
///   gives the exact mean, rounded to the nearest, halves upwards.
///
/// Its [`encoder`](Self::encoder) takes the generator, so that it does not implement [`Start`](crate::Start).
///
/// Source: paper, section II-A.
///
/// ```
/// use spikewire::{Scheme, population::Probabilistic};
/// # struct Counter(u32);
/// # impl rand_core::TryRng for Counter {
/// #     type Error = core::convert::Infallible;
/// #     fn try_next_u32(&mut self) -> Result<u32, Self::Error> { self.0 = self.0.wrapping_add(0x1000_0000); Ok(self.0) }
/// #     fn try_next_u64(&mut self) -> Result<u64, Self::Error> { unimplemented!() }
/// #     fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), Self::Error> { unimplemented!() }
/// # }
/// # let generator = Counter(0);
///
/// static TILT: Probabilistic<f32, Counter, 5, 256> = Probabilistic::new(0.0..=3.0, 1.5);
///
/// let fired = TILT.encoder(generator).encode(1.5);
/// assert!(fired.iter().any(|neuron| neuron == 2)); // response 1: it always fires
/// ```
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct Probabilistic<S: Sample, G, const M: usize, const N: usize> {
    fields: ReceptiveFields<S, M, N>,
    #[cfg_attr(feature = "serde", serde(skip))]
    generator: PhantomData<fn() -> G>,
}

#[cfg(feature = "defmt")]
impl<S: Sample + defmt::Format, G, const M: usize, const N: usize> defmt::Format
    for Probabilistic<S, G, M, N>
{
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Probabilistic {{ fields: {} }}", self.fields);
    }
}

impl<S: Sample, G, const M: usize, const N: usize> Clone for Probabilistic<S, G, M, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Sample, G, const M: usize, const N: usize> Copy for Probabilistic<S, G, M, N> {}

impl<S: Sample, G, const M: usize, const N: usize> PartialEq for Probabilistic<S, G, M, N> {
    fn eq(&self, other: &Self) -> bool {
        self.fields == other.fields
    }
}

impl<S: Sample, G: Rng, const M: usize, const N: usize> Probabilistic<S, G, M, N> {
    const SHAPE: () =
        assert!(N.is_power_of_two(), "a probability takes a power of two as its levels");

    /// Fields over a range. The smaller `beta`, the wider the fields. For constants, where bad parameters fail the
    /// build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, beta: f32) -> Self {
        unwrap(Self::try_new(range, beta))
    }

    /// Fields over a range. The smaller `beta`, the wider the fields.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or the sample type is too coarse to tell the
    /// centres apart; `beta` is not above 0.
    pub const fn try_new(range: RangeInclusive<S>, beta: f32) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        Ok(Self { fields: tri!(ReceptiveFields::try_new(&range, beta)), generator: PhantomData })
    }

    /// The centres, lowest first, rounded to the sample type.
    pub const fn centres(&self) -> &[S; M] {
        self.fields.centres()
    }

    /// The state of an encoder that draws from this generator, for a bank. Each channel takes a generator of its own:
    /// another stream, or another seed; with copies of one, channels spike together.
    pub const fn state(generator: G) -> ProbabilisticState<G> {
        ProbabilisticState::new(generator)
    }

    /// The states of a bank's channels, each with the generator that `generator` makes of the channel's number.
    pub fn states<const CHANNELS: usize>(
        mut generator: impl FnMut(usize) -> G,
    ) -> [ProbabilisticState<G>; CHANNELS] {
        core::array::from_fn(|channel| Self::state(generator(channel)))
    }

    /// An encoder that draws from this generator.
    pub const fn encoder(&self, generator: G) -> Encoder<'_, Self> {
        Encoder::with_state(self, Self::state(generator))
    }

    /// Encodes a sample into `neurons`, which must be empty.
    #[inline]
    fn encode_into(
        &self,
        state: &mut ProbabilisticState<G>,
        sample: S,
        neurons: &mut FiredNeurons<M>,
    ) {
        if !sample.is_finite() {
            state.tally.reject();
        } else if self.fields.fields().is_near(sample) {
            self.fire::<S::Short>(&mut state.generator, sample, neurons);
        } else {
            self.fire::<S::Reach>(&mut state.generator, sample, neurons);
        }
    }

    /// Fires the neurons that respond to a finite sample, by chance.
    #[inline(never)] // one copy, with the registers to itself
    fn fire<D: Distance<S>>(&self, generator: &mut G, sample: S, neurons: &mut FiredNeurons<M>) {
        self.fields.fields().draw::<D, M>(generator, sample, neurons);
    }
}

impl<S: Sample> Fields<'_, S> {
    /// Fires the neurons that respond to a finite sample, by chance: a number drawn for each is below the number of
    /// levels, a power of two.
    #[allow(clippy::inline_always)] // lengths of arrays stay known
    #[inline(always)]
    pub(super) fn draw<D: Distance<S>, const M: usize>(
        self,
        generator: &mut impl Rng,
        sample: S,
        neurons: &mut FiredNeurons<M>,
    ) {
        let first = self.first(sample);
        let Some(reach) = self.reach::<D>(1) else { return };
        let Some(distances) = self.distances::<D>(sample, first) else { return };
        let bits = self.reaches.len().trailing_zeros();
        let fired = neurons.fired.iter_mut().enumerate().skip(first);
        for ((neuron, fired), distance) in fired.zip(distances) {
            if distance <= reach {
                let draw = (generator.next_u32() >> (32 - bits)) as usize;
                *fired = self.reach(draw + 1).is_some_and(|reach| distance <= reach);
            } else if !self.is_above(sample, neuron) {
                break;
            }
        }
    }
}

impl<S: Sample, G: Rng, const M: usize, const N: usize> Encoder<'_, Probabilistic<S, G, M, N>> {
    /// Sets the count of rejected samples to 0. The generator goes on from where it is.
    pub fn restart(&mut self) {
        self.state.tally = Tally::NONE;
    }
}

/// The state of a [`Probabilistic`] encoder: the generator, and the count of rejected samples.
///
/// It is no `Copy`: copies would draw the same, and all channels spike together.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProbabilisticState<G> {
    pub(super) generator: G,
    pub(super) tally: Tally,
}

impl<G> ProbabilisticState<G> {
    pub(super) const fn new(generator: G) -> Self {
        Self { generator, tally: Tally::NONE }
    }
}

impl<S: Sample, G: Rng, const M: usize, const N: usize> Scheme for Probabilistic<S, G, M, N> {
    type Sample = S;
    type Code = FiredNeurons<M>;
    type Output = FiredNeurons<M>;
    type EncoderState = ProbabilisticState<G>;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.fields.fields().named("Probabilistic", self.fields.beta())
    }

    encode_in_place!(ProbabilisticState<G>, FiredNeurons<M>);

    fn decode(&self, state: &mut Held<S>, neurons: FiredNeurons<M>) -> S {
        state.or_hold(self.fields.mean_of(&neurons))
    }

    centred!(ProbabilisticState<G>);
}
