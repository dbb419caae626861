//! Weighted bursts: a rate code in which each spike of a burst weighs twice as much as the one before.

use core::ops::RangeInclusive;

use super::averaging::{Averaging, Gain, MeanState, Weight, decode_mean};
use super::range::Range;
use crate::error::{LARGEST_STEP, step, tri, unwrap, within};
use crate::num::{Tally, Total, to_f64};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Weighted bursts: spikes that follow each other double in weight. A high signal has many spikes, a low one few.
///
/// With `R = max - min` and `p = x - min` limited to `0..=R`: `V += p`; if `V >= θ 2^g`: a spike, `V -= θ 2^g`, and
/// `g` grows by 1, up to `doublings`; otherwise `g = 0`. Both start at 0. The decoder follows `g`: a spike means
/// `θ 2^g`.
///
/// - **Range:** `min < max`, within 10³¹ of 0 in `f32`. **Unit** `θ`: above 0. **Doublings:** 0 to 14. The largest
///   weight, `θ 2^doublings`, is `R` at least, and 10³¹ at most.
/// - **Latency:** 0 samples; the mean is that of the past. **Memory:** 12 bytes a channel in `f32` and of 16 bits, 16 of
///   32-bit fixed point; to decode that of the [`Window`](super::super::Window) or [`Average`](super::super::Average).
/// - **Work:** a sum and a comparison.
/// - **Exactness:** `f32` rounds the sum once a sample, the weights are exact; fixed point is exact.
/// - **Error:** the sum of `p` minus the sum of the spikes' weights is `V`, and
///   `0 <= V < (doublings + 1) θ 2^doublings`.
///
/// Source: Park et al., *Fast and efficient information transmission with burst spikes in deep spiking neural networks*,
/// 2019.
///
/// ```
/// use spikewire::{Scheme, rate::{Average, WeightedBurst}};
///
/// static LIGHT: WeightedBurst<i16, Average> = WeightedBurst::new(0..=255, 40, 3, Average::new(4));
/// let mut encoder = LIGHT.encoder();
/// let spikes = [100; 8].map(|x| encoder.encode(x).sign());
/// assert_eq!(spikes, [1, 1, 1, 0, 1, 1, 1, 0]); // 40 + 80 + 160, twice
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct WeightedBurst<S, A> {
    range: Range<S>,
    weight: S,
    doublings: u8,
    averaging: A,
}

/// The weights of a whole burst, added up over a window of 4096 samples, fit 32 bits.
const MOST_DOUBLINGS: u8 = 14;

impl<S: Sample, A: Averaging> WeightedBurst<S, A> {
    /// A scheme for a range, whose spikes weigh `weight` at first and double at most `doublings` times. For constants,
    /// where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, weight: S, doublings: u8, averaging: A) -> Self {
        unwrap(Self::try_new(range, weight, doublings, averaging))
    }

    /// A scheme for a range, whose spikes weigh `weight` at first and double at most `doublings` times.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or are more than 10³¹ from 0; the weight is not
    /// above 0; there are more than 14 doublings; the largest weight is less than the range, or above 10³¹.
    pub const fn try_new(
        range: RangeInclusive<S>,
        weight: S,
        doublings: u8,
        averaging: A,
    ) -> Result<Self, ConfigError> {
        let (min, max) = (*range.start(), *range.end());
        let range = tri!(Range::try_new(min, max));
        tri!(step("weight", to_f64(weight)));
        tri!(within("doublings", doublings as f64, 0.0, MOST_DOUBLINGS as f32));
        let width = to_f64(max) - to_f64(min);
        let largest = to_f64(weight) * (1_u64 << (doublings & 31)) as f64;
        if largest >= width && largest <= LARGEST_STEP as f64 {
            return Ok(Self { range, weight, doublings, averaging });
        }
        let (value, min, max) = (largest as f32, width as f32, LARGEST_STEP);
        Err(ConfigError::OutOfRange { parameter: "largest weight", value, min, max })
    }

    #[inline]
    fn weight(&self) -> Weight<S::Total> {
        let unit = self.weight.offset_from(S::ZERO);
        Weight { unit, doublings: self.doublings, range: self.range.width() }
    }
}

/// The state of a [`WeightedBurst`] encoder: the sum that is not yet sent as spikes, and the length of the burst. 12
/// bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
#[allow(private_bounds)] // sums are the crate's own
pub struct WeightedBurstState<S: Sample> {
    sum: S::Total,
    tally: Tally,
    gain: Gain,
}

impl<S: Sample, A: Averaging> Start for WeightedBurst<S, A> {
    const START: WeightedBurstState<S> =
        WeightedBurstState { sum: S::Total::ZERO, tally: Tally::NONE, gain: Gain::NONE };
}

impl<S: Sample, A: Averaging> Scheme for WeightedBurst<S, A> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = WeightedBurstState<S>;
    type DecoderState = MeanState<S, A>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = A::RECOVERY;

    fn fingerprint(&self) -> Fingerprint {
        let weights = self.range.named("WeightedBurst").sample(self.weight);
        self.averaging.describe(weights.number(self.doublings.into()))
    }

    #[inline]
    fn encode(&self, state: &mut WeightedBurstState<S>, sample: S) -> Spike {
        let Some(above) = self.range.above_min(sample) else {
            state.tally.reject();
            state.gain.take(false, self.doublings); // as the decoder does
            return Spike::None;
        };
        let weight = self.weight.offset_from(S::ZERO).doubled(state.gain.0);
        let sum = state.sum.plus(above);
        let is_spike = sum >= weight;
        state.gain.take(is_spike, self.doublings);
        state.sum = if is_spike { sum.minus(weight) } else { sum };
        if is_spike { Spike::Up } else { Spike::None }
    }

    fn rejected(state: &WeightedBurstState<S>) -> u32 {
        state.tally.rejected()
    }

    decode_mean!();
}
