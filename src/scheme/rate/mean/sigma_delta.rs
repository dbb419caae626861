//! Sigma-delta, the regular rate code: the higher the signal, the more spikes, as evenly spaced as can be.

use core::ops::RangeInclusive;

use super::averaging::{Averaging, MeanState, decode_mean};
use super::range::Range;
use crate::error::{tri, unwrap};
use crate::num::{Tally, Total};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// First-order sigma-delta: the share of samples with a spike is `p / R`, the signal's height in its range.
///
/// With `R = max - min` and `p = x - min` limited to `0..=R`: `a += p`, and if `a >= R`: a spike, and `a -= R`. `a`
/// starts at 0.
///
/// - **Range:** `min < max`, within 10³¹ of 0 in `f32`.
/// - **Latency:** 0 samples; the mean is that of the past. **Memory:** 8 bytes a channel in `f32` and of 16 bits, 16 of
///   32-bit fixed point; to decode that of the [`Window`](super::super::Window) or [`Average`](super::super::Average).
/// - **Work:** a sum and a comparison.
/// - **Exactness:** `f32` rounds the sum once a sample; fixed point is exact.
/// - **Error:** over any `W` samples with `n` spikes `|n R - Σp| < R`: the sum is known to within a spike. A window's
///   value is within `R / W + ½` of the mean of its samples, an average's within `R / 2^k + 1` of the same average of
///   the samples; the ½ and the 1 are units of fixed point, from rounding.
///
/// Source: Candy and Temes, *Oversampling methods for A/D and D/A conversion*, 1992; as a neuron: Guo et al.,
/// *Neural coding in spiking neural networks*, 2021 (rate coding).
///
/// ```
/// use spikewire::{Scheme, rate::{SigmaDelta, Window}};
///
/// static LIGHT: SigmaDelta<i16, Window> = SigmaDelta::new(0..=255, Window::new(4)); // mean of 16 samples
/// let (mut encoder, mut decoder) = (LIGHT.encoder(), LIGHT.decoder());
/// let values = [100; 16].map(|x| decoder.decode(encoder.encode(x)));
/// assert_eq!(values[15], 96); // 6 spikes of 16
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SigmaDelta<S, A> {
    range: Range<S>,
    averaging: A,
}

impl<S: Sample, A: Averaging> SigmaDelta<S, A> {
    /// A scheme for a range. For constants, where a bad range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, averaging: A) -> Self {
        Self { range: unwrap(Range::try_new(*range.start(), *range.end())), averaging }
    }

    /// A scheme for a range.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or are more than 10³¹ from 0.
    pub const fn try_new(range: RangeInclusive<S>, averaging: A) -> Result<Self, ConfigError> {
        Ok(Self { range: tri!(Range::try_new(*range.start(), *range.end())), averaging })
    }
}

/// The state of a [`SigmaDelta`] encoder: the sum that is not yet sent as spikes. 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
#[allow(private_bounds)] // sums are the crate's own
pub struct SigmaDeltaState<S: Sample> {
    sum: S::Total,
    tally: Tally,
}

impl<S: Sample, A: Averaging> Start for SigmaDelta<S, A> {
    const START: SigmaDeltaState<S> = SigmaDeltaState { sum: S::Total::ZERO, tally: Tally::NONE };
}

impl<S: Sample, A: Averaging> Scheme for SigmaDelta<S, A> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = SigmaDeltaState<S>;
    type DecoderState = MeanState<S, A>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = A::RECOVERY;

    fn fingerprint(&self) -> Fingerprint {
        self.averaging.describe(self.range.named("SigmaDelta"))
    }

    #[inline]
    fn encode(&self, state: &mut SigmaDeltaState<S>, sample: S) -> Spike {
        let Some(above) = self.range.above_min(sample) else {
            state.tally.reject();
            return Spike::None;
        };
        let (sum, is_spike) = state.sum.carried(above, self.range.width());
        state.sum = sum;
        if is_spike { Spike::Up } else { Spike::None }
    }

    fn rejected(state: &SigmaDeltaState<S>) -> u32 {
        state.tally.rejected()
    }

    decode_mean!(range);
}
