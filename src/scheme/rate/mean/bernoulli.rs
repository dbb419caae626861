//! Bernoulli, the random rate code: the higher the signal, the likelier a spike.

use core::array;
use core::marker::PhantomData;
use core::ops::RangeInclusive;

use rand_core::Rng;

use super::averaging::{Averaging, MeanState, decode_mean};
use super::range::Range;
use crate::error::{tri, unwrap};
use crate::num::{Tally, Total, groups, groups_mut};
use crate::scheme::codec::encode_each;
use crate::{ConfigError, Destination, Encoder, Fingerprint, Recovery, Sample, Scheme, Spike};

/// Bernoulli spiking: a sample spikes with the probability `p / R`, its height in the range, drawn from the caller's
/// random number generator. Sample by sample this is a Poisson spike train.
///
/// With `R = max - min`, `p = x - min` limited to `0..=R`, and `j` the top 16 bits of a 32-bit draw: a spike if
/// `2^17 p >= (2j + 1) R`. There is one draw for every finite sample.
///
/// - **Range:** `min < max`, within 10³¹ of 0 in `f32`.
/// - **Latency:** 0 samples; the mean is that of the past. **Memory:** 4 bytes a channel and the generator; to decode
///   that of the [`Window`](super::super::Window) or [`Average`](super::super::Average).
/// - **Work:** a draw and two products.
/// - **Exactness:** `f32` rounds `(2j + 1) R` once; fixed point is exact.
/// - **Error:** the mean is right on average, to `2^-17` of the range. The mean over `W` samples has a standard
///   deviation of `R / 2√W` or less, the most in the middle of the range: the mean of
///   [`SigmaDelta`](super::super::SigmaDelta) is far nearer with as many spikes.
///
/// Its encoder needs the generator, so it has an [`encoder`](Self::encoder) of its own and is no
/// [`Start`](crate::Start).
///
/// Source: Guo et al., *Neural coding in spiking neural networks*, 2021 (rate coding).
///
/// ```
/// use spikewire::{Scheme, rate::{Average, Bernoulli}};
/// # struct Lcg(u32);
/// # impl rand_core::TryRng for Lcg {
/// #     type Error = core::convert::Infallible;
/// #     fn try_next_u32(&mut self) -> Result<u32, Self::Error> { self.0 = self.0.wrapping_mul(1664525).wrapping_add(1013904223); Ok(self.0) }
/// #     fn try_next_u64(&mut self) -> Result<u64, Self::Error> { unimplemented!() }
/// #     fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), Self::Error> { unimplemented!() }
/// # }
/// # let generator = Lcg(1);
///
/// static LIGHT: Bernoulli<i16, Lcg, Average> = Bernoulli::new(0..=255, Average::new(4));
///
/// let mut encoder = LIGHT.encoder(generator);
/// let spikes: i8 = (0..16).map(|_| encoder.encode(100).sign()).sum();
/// assert_eq!(spikes, 7);
/// ```
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(bound = "S: serde::Serialize, A: serde::Serialize"))]
pub struct Bernoulli<S, G, A> {
    range: Range<S>,
    averaging: A,
    #[cfg_attr(feature = "serde", serde(skip))]
    generator: PhantomData<fn() -> G>,
}

#[cfg(feature = "defmt")]
impl<S: Sample + defmt::Format, G, A: defmt::Format> defmt::Format for Bernoulli<S, G, A> {
    fn format(&self, f: defmt::Formatter<'_>) {
        let Self { range, averaging, .. } = self;
        defmt::write!(f, "Bernoulli {{ range: {}, averaging: {} }}", range, averaging);
    }
}

impl<S: Copy, G, A: Copy> Clone for Bernoulli<S, G, A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Copy, G, A: Copy> Copy for Bernoulli<S, G, A> {}

impl<S: PartialEq, G, A: PartialEq> PartialEq for Bernoulli<S, G, A> {
    fn eq(&self, other: &Self) -> bool {
        self.range == other.range && self.averaging == other.averaging
    }
}

impl<S: Sample, G: Rng, A: Averaging> Bernoulli<S, G, A> {
    /// A scheme for a range. For constants, where a bad range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, averaging: A) -> Self {
        let range = unwrap(Range::try_new(*range.start(), *range.end()));
        Self { range, averaging, generator: PhantomData }
    }

    /// A scheme for a range.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or are more than 10³¹ from 0.
    pub const fn try_new(range: RangeInclusive<S>, averaging: A) -> Result<Self, ConfigError> {
        let range = tri!(Range::try_new(*range.start(), *range.end()));
        Ok(Self { range, averaging, generator: PhantomData })
    }

    /// The state of an encoder that draws from this generator, for a bank.
    ///
    /// Each channel takes a generator of its own: another stream, or another seed. Channels with copies of one
    /// generator spike together, which a network mistakes for a correlation of their signals. So no array repeats it:
    ///
    /// ```compile_fail
    /// # use spikewire::rate::{Average, BernoulliState};
    /// fn six<G: Copy>(state: BernoulliState<G>) -> [BernoulliState<G>; 6] {
    ///     [state; 6]
    /// }
    /// ```
    pub const fn state(generator: G) -> BernoulliState<G> {
        BernoulliState { generator, tally: Tally::NONE }
    }

    /// The states of a bank's channels, each with the generator that `generator` makes of the channel's number.
    ///
    /// ```
    /// # use rand_core::Rng;
    /// # use spikewire::rate::{Average, Bernoulli, BernoulliState};
    /// # fn of<Pcg32: Rng>(pcg32: fn(u64, u64) -> Pcg32) {
    /// type Light<G> = Bernoulli<i16, G, Average>;
    /// let states: [BernoulliState<_>; 6] = Light::states(|channel| pcg32(2026, channel as u64));
    /// # }
    /// ```
    pub fn states<const N: usize>(mut generator: impl FnMut(usize) -> G) -> [BernoulliState<G>; N] {
        core::array::from_fn(|channel| Self::state(generator(channel)))
    }

    // For the laptop's codecs: `encode_slice` with a generator that draws 32 numbers in less time than one after the
    // other. `draw` returns what 32 calls of `next_u32` would return, and leaves the generator as they would leave it.
    #[doc(hidden)]
    #[inline(always)]
    pub fn encode_slice_with(
        &self,
        state: &mut BernoulliState<G>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
        draw: impl Fn(&mut G) -> [u32; 32],
    ) -> usize {
        let length = samples.len().min(spikes.len());
        let mut samples = samples.get(..length).unwrap_or_default();
        let mut spikes = spikes.get_mut(..length).unwrap_or_default();
        let (mut grouped, mut written) = (&[][..], &mut [][..]);
        // Sums of 64 bits take longer in groups.
        if size_of::<S::Total>() <= size_of::<f32>() {
            (grouped, samples) = groups::<_, GROUP>(samples);
            (written, spikes) = groups_mut::<_, GROUP>(spikes);
        }
        let (Range { min, max }, width) = (self.range, self.range.width());
        for (spikes, samples) in written.iter_mut().zip(grouped) {
            let is_within = |sample: &S| *sample >= min && *sample <= max;
            if samples.iter().fold(true, |all, sample| all & is_within(sample)) {
                let draws = draw(&mut state.generator);
                for ((spike, &sample), draw) in spikes.iter_mut().zip(samples).zip(draws) {
                    let is_drawn = sample.offset_from(min).is_drawn(width, draw >> 16);
                    spike.write(if is_drawn { Spike::Up } else { Spike::None });
                }
            } else {
                encode_each(self, state, samples, spikes);
            }
        }
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            spike.write(self.encode(state, sample));
        }
        length
    }

    /// An encoder that draws from this generator.
    pub const fn encoder(&self, generator: G) -> Encoder<'_, Self> {
        Encoder::with_state(self, Self::state(generator))
    }
}

impl<S: Sample, G: Rng, A: Averaging> Encoder<'_, Bernoulli<S, G, A>> {
    /// Forgets the count of rejected samples. The generator goes on from where it is.
    pub fn restart(&mut self) {
        self.state.tally = Tally::NONE;
    }
}

/// The state of a [`Bernoulli`] encoder: the generator, and the count of rejected samples.
///
/// It is no `Copy`: copies would draw the same, and all channels spike together.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BernoulliState<G> {
    generator: G,
    tally: Tally,
}

/// How many samples are drawn for at once, if the core has vectors.
const GROUP: usize = 32;

impl<S: Sample, G: Rng, A: Averaging> Scheme for Bernoulli<S, G, A> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = BernoulliState<G>;
    type DecoderState = MeanState<S, A>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = A::RECOVERY;

    fn fingerprint(&self) -> Fingerprint {
        self.averaging.describe(self.range.named("Bernoulli"))
    }

    #[inline]
    fn encode(&self, state: &mut BernoulliState<G>, sample: S) -> Spike {
        let Some(above) = self.range.above_min(sample) else {
            state.tally.reject();
            return Spike::None;
        };
        let draw = state.generator.next_u32() >> 16;
        if above.is_drawn(self.range.width(), draw) { Spike::Up } else { Spike::None }
    }

    /// Draws for a group of samples within the range, and then compares them side by side.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut BernoulliState<G>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
    ) -> usize {
        self.encode_slice_with(state, samples, spikes, |own| array::from_fn(|_| own.next_u32()))
    }

    fn rejected(state: &BernoulliState<G>) -> u32 {
        state.tally.rejected()
    }

    decode_mean!(range);
}
