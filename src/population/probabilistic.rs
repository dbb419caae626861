//! Gaussian receptive fields with probabilistic spiking: the stronger the response, the likelier the
//! spike.

use rand_core::Rng;

use super::fields::ReceptiveFields;
use super::spaced::Distance;
use crate::sample::Tally;
use crate::spike::{Code, Firing, Polarity};
use crate::{Decoder, Encoder, Output, Sample};

/// Gaussian receptive fields in which a neuron fires with the probability of its response, from a
/// generator that the caller passes in.
///
/// The probability is rounded to a multiple of `1 / N`, half up: a neuron of level `k` (see
/// [`ReceptiveFields`]) fires if the top bits of a 32-bit draw, a number below `N`, are below `k`.
/// One draw is taken for each neuron that responds with level 1 or more, by rising index. `N` must
/// be a power of two.
///
/// - **Latency:** 0 samples. **Memory:** 8 bytes an encoder and the generator; the fields are in
///   flash, shared.
/// - **Work:** one comparison with the table a neuron; no exponential.
/// - **Decoder:** the mean of the centres that fired.
///
/// It is not a [`Scheme`](crate::Scheme), as its encoder needs the generator.
///
/// Source: paper, section II-A.
///
/// ```
/// use spikewire::{Decoder, Encoder, population::{Probabilistic, ReceptiveFields}};
/// # struct Counter(u32);
/// # impl rand_core::TryRng for Counter {
/// #     type Error = core::convert::Infallible;
/// #     fn try_next_u32(&mut self) -> Result<u32, Self::Error> { self.0 = self.0.wrapping_add(0x1000_0000); Ok(self.0) }
/// #     fn try_next_u64(&mut self) -> Result<u64, Self::Error> { unimplemented!() }
/// #     fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), Self::Error> { unimplemented!() }
/// # }
/// # let generator = Counter(0);
///
/// static FIELDS: ReceptiveFields<f32, 5, 256> = ReceptiveFields::<f32, _, _>::checked(0.0, 3.0, 1.5);
/// const TILT: Probabilistic<f32, 5, 256> = Probabilistic::new(&FIELDS);
///
/// let pattern = TILT.encoder(generator).encode(1.5);
/// assert!(pattern.iter().any(|neuron| neuron == 2)); // response 1: it always fires
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Probabilistic<'a, S: Sample, const M: usize, const N: usize> {
    fields: &'a ReceptiveFields<S, M, N>,
}

impl<'a, S: Sample, const M: usize, const N: usize> Probabilistic<'a, S, M, N> {
    /// How many samples after its own the code of a sample comes out.
    pub const LATENCY: usize = 0;

    /// A scheme with these fields.
    pub const fn new(fields: &'a ReceptiveFields<S, M, N>) -> Self {
        const { assert!(N.is_power_of_two(), "a probability takes a power of two as its levels") };
        Self { fields }
    }

    /// An encoder that draws from this generator.
    pub fn encoder<G: Rng>(self, generator: G) -> ProbabilisticEncoder<'a, S, G, M, N> {
        ProbabilisticEncoder { fields: self.fields, generator, tally: Tally::default() }
    }

    /// A decoder in its initial state.
    pub fn decoder(self) -> ProbabilisticDecoder<'a, S, M, N> {
        ProbabilisticDecoder { fields: self.fields, value: self.fields.middle() }
    }
}

/// Which neurons fired for one sample.
///
/// `M` bytes, rounded up to words.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pattern<const M: usize> {
    fired: [bool; M],
}

impl<const M: usize> Pattern<M> {
    /// No spike.
    pub const EMPTY: Self = Self { fired: [false; M] };

    /// These neurons, as they came over a link or from a file. `None` if one is not below `M`, or
    /// comes twice.
    pub fn new(neurons: impl IntoIterator<Item = u16>) -> Option<Self> {
        let mut pattern = Self::EMPTY;
        for neuron in neurons {
            let fired = pattern.fired.get_mut(usize::from(neuron))?;
            if core::mem::replace(fired, true) {
                return None;
            }
        }
        Some(pattern)
    }

    /// The neurons that fired, by rising index.
    pub fn iter(&self) -> impl Iterator<Item = u16> {
        (0..).zip(&self.fired).filter_map(|(neuron, &fired)| fired.then_some(neuron))
    }
}

impl<const M: usize> Code for Pattern<M> {
    const NEURONS: usize = M;

    fn firings(&self) -> impl Iterator<Item = Firing> {
        self.iter().map(|neuron| Firing { neuron, slot: 0, polarity: Polarity::Up })
    }
}

impl<const M: usize> Output for Pattern<M> {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}

/// The neurons that fired: `[2, 3]`.
#[cfg(feature = "serde")]
impl<const M: usize> serde::Serialize for Pattern<M> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        crate::serial::sequence(|| self.iter(), serializer)
    }
}

/// The encoder of [`Probabilistic`].
#[derive(Clone, Copy, Debug)]
pub struct ProbabilisticEncoder<'a, S: Sample, G, const M: usize, const N: usize> {
    fields: &'a ReceptiveFields<S, M, N>,
    generator: G,
    tally: Tally,
}

impl<S: Sample, G: Rng, const M: usize, const N: usize> ProbabilisticEncoder<'_, S, G, M, N> {
    /// Encodes into an empty pattern.
    #[inline]
    fn encode_into(&mut self, sample: S, pattern: &mut Pattern<M>) {
        if !sample.is_finite() {
            self.tally.reject();
        } else if self.fields.is_near(sample) {
            self.fire::<S::Short>(sample, pattern);
        } else {
            self.fire::<S::Reach>(sample, pattern);
        }
    }

    #[inline(never)] // one copy, with the registers to itself
    fn fire<D: Distance<S>>(&mut self, sample: S, pattern: &mut Pattern<M>) {
        let fields = self.fields;
        let first = fields.first(sample);
        let Some(reach) = fields.reach::<D>(1) else { return };
        let Some(distances) = fields.distances::<D>(sample, first) else { return };
        let fired = pattern.fired.iter_mut().enumerate().skip(first);
        let mut responds = false;
        for ((neuron, fired), distance) in fired.zip(distances) {
            if distance <= reach {
                let draw = (self.generator.next_u32() >> (32 - N.ilog2())) as usize;
                *fired = fields.reach(draw + 1).is_some_and(|reach| distance <= reach);
                responds = true;
            } else if responds || !fields.is_above(sample, neuron) {
                break;
            }
        }
    }
}

impl<S: Sample, G: Rng, const M: usize, const N: usize> Encoder
    for ProbabilisticEncoder<'_, S, G, M, N>
{
    type Sample = S;
    type Output = Pattern<M>;

    #[inline]
    fn encode(&mut self, sample: S) -> Pattern<M> {
        let mut pattern = Pattern::EMPTY;
        self.encode_into(sample, &mut pattern);
        pattern
    }

    fn encode_slice(&mut self, samples: &[S], outputs: &mut [Pattern<M>]) -> usize {
        for (pattern, &sample) in outputs.iter_mut().zip(samples) {
            *pattern = Pattern::EMPTY;
            self.encode_into(sample, pattern);
        }
        samples.len().min(outputs.len())
    }

    /// Forgets the count of rejected samples; the generator goes on.
    fn reset(&mut self) {
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}

/// The decoder of [`Probabilistic`].
///
/// Where no neuron fired it holds its value, at first the middle centre. Fixed point gives the exact
/// mean, rounded to the nearest, halves upwards. Memory: 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
pub struct ProbabilisticDecoder<'a, S: Sample, const M: usize, const N: usize> {
    fields: &'a ReceptiveFields<S, M, N>,
    value: S,
}

impl<S: Sample, const M: usize, const N: usize> Decoder for ProbabilisticDecoder<'_, S, M, N> {
    type Sample = S;
    type Code = Pattern<M>;

    fn decode(&mut self, pattern: Pattern<M>) -> S {
        let levels = pattern.fired.iter().map(|&fired| fired.then_some(1));
        if let Some(mean) = self.fields.mean(0, levels) {
            self.value = mean;
        }
        self.value
    }

    fn resync(&mut self, value: S) {
        self.value = value;
    }

    fn reset(&mut self) {
        self.value = self.fields.middle();
    }
}
