//! Adaptive temporal contrast: temporal contrast whose threshold grows with the number of recent spikes.

use super::doublings::{self, hold_with_history};
use crate::error::{tri, unwrap};
use crate::num::Tally;
use crate::scheme::codec::{encode_each, encode_first};
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Adaptive temporal contrast: the threshold follows how much the signal changes, between two bounds.
///
/// As [`TemporalContrast`](super::TemporalContrast) with the threshold `threshold * 2^e`, where `e` is
/// `n (doublings + 1) / 16`, rounded down and at most `doublings`, and `n` is how many of the last 16 samples had a
/// spike. The decoder counts the same spikes, and steps by the same threshold.
///
/// - **Threshold:** above 0, in the samples' unit: the smallest, as at rest. The sample type must hold the largest,
///   `threshold * 2^doublings`; in `f32` it is at most 10³¹. **Doublings:** 0 to 15; 0 is temporal contrast.
/// - **Latency:** 0 samples. **Memory:** 12 bytes a channel in `f32`, 8 to decode.
/// - **Work:** that of temporal contrast, a multiplication and some shifts.
/// - **Exactness:** thresholds are exact; `f32` rounds the difference of two samples once, fixed point compares it
///   exactly.
/// - **Error:** the decoded value drifts without bound, since a difference within the threshold is never made up for.
///   Resynchronise it.
/// - **Keyframes:** only when the last 16 samples had no spike: then the last sample is all that a decoder must know.
///   Where there is no keyframe now, ask again at the next sample.
///
/// Source: temporal contrast is algorithm 6 of the paper; the count of spikes is this crate's own.
///
/// ```
/// use spikewire::{Scheme, temporal::AdaptiveContrast};
///
/// const ROLL: AdaptiveContrast<i16> = AdaptiveContrast::new(2, 3); // thresholds of 2, 4, 8 and 16
/// let (mut encoder, mut decoder) = (ROLL.encoder(), ROLL.decoder());
/// // A ramp of 5 a sample: after eight spikes the threshold is 8, until one of them is 16 samples old.
/// let spikes = (0..12).filter(|i| encoder.encode(i * 5).is_fired()).count();
/// assert_eq!(spikes, 8);
/// ```
///
/// A threshold that the sample type cannot hold does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::AdaptiveContrast;
/// const ROLL: AdaptiveContrast<i16> = AdaptiveContrast::new(3000, 4);
/// # let _ = ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AdaptiveContrast<S> {
    threshold: S,
    doublings: u8,
}

/// Among how many samples spikes are counted.
const COUNTED: usize = 16;
/// With 15 doublings each spike among the last 16 samples doubles the threshold once more, up to the 15th.
const MOST_DOUBLINGS: u8 = 15;

impl<S: Sample> AdaptiveContrast<S> {
    /// A scheme with this smallest threshold, which doubles at most `doublings` times. For constants, where bad
    /// parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(threshold: S, doublings: u8) -> Self {
        unwrap(Self::try_new(threshold, doublings))
    }

    /// A scheme with this smallest threshold, which doubles at most `doublings` times.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, or not finite; there are more than 15 doublings; the largest
    /// threshold is more than the sample type holds, or above 10³¹ in `f32`.
    pub const fn try_new(threshold: S, doublings: u8) -> Result<Self, ConfigError> {
        tri!(doublings::check(threshold, doublings, MOST_DOUBLINGS, "largest threshold"));
        Ok(Self { threshold, doublings })
    }

    /// The smallest threshold, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }

    /// The threshold after these spikes.
    #[inline]
    fn after(&self, spikes: Recent) -> S {
        let steps = u32::from(self.doublings).wrapping_add(1);
        let exponent = spikes.count().wrapping_mul(steps) / COUNTED as u32;
        self.threshold.doubled((exponent as u8).min(self.doublings))
    }
}

/// Which of the last 16 samples had a spike, the newest in the lowest bit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Recent(u16);

impl Recent {
    const NONE: Self = Self(0);

    #[inline]
    fn take(&mut self, spike: Spike) {
        self.0 = self.0 << 1 | u16::from(spike.is_fired());
    }

    #[inline]
    fn count(self) -> u32 {
        self.0.count_ones()
    }
}

/// The state of an [`AdaptiveContrast`] encoder: the last sample, and which of the last 16 had a spike. 12 bytes in
/// `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveContrastState<S> {
    previous: S,
    tally: Tally,
    recent: Recent,
}

/// The state of an [`AdaptiveContrast`] decoder: the value, and which of the last 16 samples had a spike. 8 bytes in
/// `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveContrastStep<S> {
    value: S,
    recent: Recent,
}

impl<S: Sample> Start for AdaptiveContrast<S> {
    const START: AdaptiveContrastState<S> =
        AdaptiveContrastState { previous: S::ZERO, tally: Tally::NONE, recent: Recent::NONE };
}

impl<S: Sample> Scheme for AdaptiveContrast<S> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = AdaptiveContrastState<S>;
    type DecoderState = AdaptiveContrastStep<S>;

    const LATENCY: usize = 0;
    /// After 16 silent samples the threshold is the smallest.
    const RECOVERY: Recovery = Recovery::TimedKeyframe(COUNTED);

    fn fingerprint(&self) -> Fingerprint {
        let Self { threshold, doublings } = *self;
        Fingerprint::new("AdaptiveContrast").sample(threshold).number(doublings.into())
    }

    #[inline]
    fn encode(&self, state: &mut AdaptiveContrastState<S>, sample: S) -> Spike {
        if !state.tally.is_primed() || !sample.is_finite() {
            self.prime(state, &[sample]);
            state.recent.take(Spike::None); // as the decoder does
            return Spike::None;
        }
        let previous = core::mem::replace(&mut state.previous, sample);
        let spike = Spike::from_side(sample.step(previous, self.after(state.recent)));
        state.recent.take(spike);
        spike
    }

    /// The last sample stays in a register, and one check at the end asks whether all were finite: if not, the slice is
    /// encoded again, sample by sample.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut AdaptiveContrastState<S>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
    ) -> usize {
        let (first, samples, spikes) =
            encode_first(self, state.tally.is_primed(), state, samples, spikes);

        let (mut previous, mut recent) = (state.previous, state.recent);
        let mut threshold = self.after(recent);
        let mut check = S::ZERO;
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            check = check.including(sample);
            let emitted = Spike::from_side(sample.step(previous, threshold));
            spike.write(emitted);
            previous = sample;
            // Without a spike now or among the last 16 samples the threshold stays the smallest.
            if recent != Recent::NONE || emitted.is_fired() {
                recent.take(emitted);
                threshold = self.after(recent);
            }
        }
        if check.is_finite() {
            (state.previous, state.recent) = (previous, recent);
        } else {
            encode_each(self, state, samples, spikes);
        }
        first + samples.len()
    }

    /// The last sample of the past becomes the predecessor of the next one, and the count of spikes starts at 0.
    fn prime(&self, state: &mut AdaptiveContrastState<S>, past: &[S]) {
        if let Some(previous) = state.tally.last_of(past) {
            state.previous = previous;
            state.recent = Recent::NONE;
        }
    }

    /// The last sample, if the last 16 had no spike.
    fn keyframe(&self, state: &AdaptiveContrastState<S>) -> Option<S> {
        (state.tally.is_primed() && state.recent == Recent::NONE).then_some(state.previous)
    }

    fn rejected(state: &AdaptiveContrastState<S>) -> u32 {
        state.tally.rejected()
    }

    /// Adds the threshold, and adapts it as the encoder did.
    #[inline]
    fn decode(&self, state: &mut AdaptiveContrastStep<S>, spike: Spike) -> S {
        if spike.is_fired() {
            let threshold = self.after(state.recent);
            state.value = if spike.sign() > 0 {
                state.value.plus(threshold)
            } else {
                state.value.minus(threshold)
            };
        }
        state.recent.take(spike);
        state.value
    }

    hold_with_history!(AdaptiveContrastStep, recent: Recent::NONE);
}
