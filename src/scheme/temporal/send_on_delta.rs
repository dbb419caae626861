//! Send-on-delta: step forward with several spikes for a sample, for signals that jump.

use core::hint::black_box;

use super::StepState;
use super::band::{Band, follow_baseline};
use crate::error::{step, tri, unwrap};
use crate::num::{Tally, to_f64};
use crate::scheme::codec::{encode_each, encode_first};
use crate::{
    Code, ConfigError, Destination, Fingerprint, NeuronSpike, Polarity, Recovery, Sample, Scheme,
    Start,
};

/// The methods that limit the spikes of a sample, in the field `most`, for a code of [`Steps`].
macro_rules! with_most {
    () => {
        /// Allows at most this many spikes a sample; `K` by default. For constants, where a bad number fails the build.
        ///
        /// # Panics
        /// Panics if the number is not within 1 to `K`.
        #[must_use]
        pub const fn with_most(self, most: u8) -> Self {
            $crate::error::unwrap(self.try_with_most(most))
        }

        /// Allows at most this many spikes a sample; `K` by default.
        ///
        /// # Errors
        /// Returns an error if the number is not within 1 to `K`.
        pub const fn try_with_most(self, most: u8) -> Result<Self, ConfigError> {
            $crate::error::tri!($crate::error::within(
                "most spikes a sample",
                most as f64,
                1.0,
                K as f32
            ));
            Ok(Self { most: most as i8, ..self })
        }
    };
}
pub(in crate::scheme) use with_most;

/// Send-on-delta: the baseline follows the signal by up to `K` thresholds a sample, with one spike for each.
///
/// While `x > base + threshold`, and at most `K` times: a spike up, and `base += threshold`. While
/// `x < base - threshold`, and at most `K` times: a spike down, and `base -= threshold`. The `n` spikes of a sample
/// have one polarity and fire in the sub-timesteps `0..n` of `K`. With `K = 1` this is
/// [`StepForward`](super::StepForward).
///
/// - **Threshold:** above 0, in the samples' unit; up to 10³¹ in `f32`, so that no band reaches infinity.
///   **K:** 1 to 127; a smaller number set by [`with_most`](Self::with_most) takes its place in the law and the error.
/// - **Latency:** 0 samples. **Memory:** 8 bytes a channel in `f32`, 4 to decode.
/// - **Work:** two comparisons a sample, and one more for each spike.
/// - **Exactness:** `f32` rounds `base ± threshold` once a spike; fixed point is exact.
/// - **Error:** while `|x[i] - x[i-1]| <= K * threshold`, the decoded value stays within the threshold of the
///   signal.
///
/// Source: Miskowicz, *Send-on-delta concept*, 2006.
///
/// ```
/// use spikewire::{Scheme, temporal::SendOnDelta};
///
/// const ROLL: SendOnDelta<i16, 4> = SendOnDelta::new(10);
/// let mut encoder = ROLL.encoder();
/// let spikes = [0, 9, 35, 95, 90, 10].map(|x| encoder.encode(x).count());
/// assert_eq!(spikes, [0, 0, 3, 4, 1, -4]);
/// ```
///
/// A code without spikes does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::SendOnDelta;
/// const ROLL: SendOnDelta<i16, 0> = SendOnDelta::new(10);
/// # let _ = ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SendOnDelta<S, const K: usize> {
    threshold: S,
    most: i8,
}

impl<S: Sample, const K: usize> SendOnDelta<S, K> {
    const SHAPE: () = assert!(K >= 1 && K <= 127, "a sample has 1 to 127 spikes at most");

    /// A scheme with this threshold, which is also the decoder's step. For constants, where a bad threshold
    /// fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not above 0, not finite, or above 10³¹.
    pub const fn new(threshold: S) -> Self {
        unwrap(Self::try_new(threshold))
    }

    /// A scheme with this threshold, which is also the decoder's step.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, not finite, or above 10³¹.
    pub const fn try_new(threshold: S) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        tri!(step("threshold", to_f64(threshold)));
        Ok(Self { threshold, most: K as i8 })
    }

    with_most!();

    /// The threshold, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }

    /// The state of an encoder with this baseline, so that its first sample counts from there instead of becoming the
    /// baseline itself: for [`Bank::per_channel_with_states`](crate::Bank::per_channel_with_states). From 0 on, baselines
    /// are multiples of the threshold, whatever the first sample is. A baseline that is not finite is none, and
    /// [`Bank::reset`](crate::Bank::reset) forgets it.
    ///
    /// ```
    /// use spikewire::{Bank, Tick, temporal::SendOnDelta};
    ///
    /// static GYRO: SendOnDelta<i16, 16> = SendOnDelta::new(50);
    /// let anchored = (&GYRO, SendOnDelta::<i16, 16>::state_at(0));
    /// let mut bank = Bank::per_channel_with_states([anchored; 3]);
    /// bank.encode(Tick::from_micros(0), [120, 7, -60], |_| ());
    /// assert_eq!([0, 1, 2].map(|channel| bank.keyframe(channel)), [Some(100), Some(0), Some(-50)]);
    /// ```
    pub const fn state_at(baseline: S) -> SendOnDeltaState<S> {
        match Tally::of_baseline(baseline) {
            Some(tally) => SendOnDeltaState { base: baseline, tally },
            None => Self::START,
        }
    }

    /// Follows a sample that is outside the band, the first one, or not finite.
    #[inline]
    fn follow(&self, state: &mut SendOnDeltaState<S>, sample: S) -> Steps<K> {
        if !state.tally.is_primed() || !sample.is_finite() {
            self.prime(state, &[sample]);
            return Steps(0);
        }
        let least = self.most.wrapping_neg();
        let mut steps = 0;
        let mut base = state.base;
        if sample > base {
            while steps < self.most && sample > base.plus(self.threshold) {
                base = base.plus(self.threshold);
                steps += 1;
            }
        } else {
            while steps > least && sample < base.minus(self.threshold) {
                base = base.minus(self.threshold);
                steps -= 1;
            }
        }
        state.base = base;
        Steps(steps)
    }
}

/// The spikes of one sample: up to `K`, all of one polarity.
///
/// One byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Steps<const K: usize>(i8);

impl<const K: usize> Steps<K> {
    /// `count` spikes, up if positive and down if negative; limited to `K`.
    pub const fn new(count: i8) -> Self {
        let most = K as i8;
        Self(if count > most {
            most
        } else if count < -most {
            -most
        } else {
            count
        })
    }

    /// [`new`](Self::new) for a count that is within the limits already.
    #[inline]
    pub(crate) const fn within(count: i8) -> Self {
        Self(count)
    }

    /// The number of spikes, -`K` to `K`; negative if they go down.
    pub const fn count(self) -> i8 {
        self.0
    }
}

impl<const K: usize> Code for Steps<K> {
    const NEURONS: usize = 1;
    const IS_SIGNED: bool = true;
    const SLOTS: usize = K;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        let polarity = if self.0 > 0 { Polarity::Up } else { Polarity::Down };
        (0..self.0.unsigned_abs().into()).map(move |slot| NeuronSpike { neuron: 0, slot, polarity })
    }

    /// The spikes up minus the spikes down.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let steps = firings.filter(|firing| firing.neuron == 0).fold(0_i8, |steps, firing| {
            match firing.polarity {
                Polarity::Up => steps.saturating_add(1),
                Polarity::Down => steps.saturating_sub(1),
            }
        });
        Self::new(steps)
    }
}

/// The state of a [`SendOnDelta`] encoder: the baseline. 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SendOnDeltaState<S> {
    base: S,
    tally: Tally,
}

impl<S: Sample, const K: usize> Start for SendOnDelta<S, K> {
    const START: SendOnDeltaState<S> = SendOnDeltaState { base: S::ZERO, tally: Tally::NONE };
}

impl<S: Sample, const K: usize> Scheme for SendOnDelta<S, K> {
    type Sample = S;
    type Code = Steps<K>;
    type Output = Steps<K>;
    type EncoderState = SendOnDeltaState<S>;
    type DecoderState = StepState<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Keyframe;

    fn holds_keyframes(&self) -> bool {
        true
    }

    fn fingerprint(&self) -> Fingerprint {
        let most = u32::from(self.most.unsigned_abs());
        Fingerprint::new("SendOnDelta").sample(self.threshold).number(most)
    }

    #[inline]
    fn encode(&self, state: &mut SendOnDeltaState<S>, sample: S) -> Steps<K> {
        if state.tally.is_primed() && Band::around(state.base, self.threshold).holds(sample) {
            Steps(0)
        } else {
            self.follow(state, sample)
        }
    }

    /// The band stays in registers while samples are within it.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut SendOnDeltaState<S>,
        samples: &[S],
        outputs: &mut [impl Destination<Steps<K>>],
    ) -> usize {
        let (first, samples, outputs) =
            encode_first(self, state.tally.is_primed(), state, samples, outputs);

        let (threshold, most) = (self.threshold, i32::from(self.most));
        let mut band = Band::around(state.base, threshold);
        let mut check = S::ZERO;
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            let mut steps = 0_i32;
            if band.is_below(sample) {
                check = check.including(sample);
                loop {
                    black_box(()); // keeps the compiler from unrolling the loop
                    band = band.raised(threshold);
                    steps = steps.wrapping_add(1);
                    if steps >= most || !band.is_below(sample) {
                        break;
                    }
                }
            } else if band.is_above(sample) {
                check = check.including(sample);
                loop {
                    black_box(());
                    band = band.lowered(threshold);
                    steps = steps.wrapping_sub(1);
                    if steps <= most.wrapping_neg() || !band.is_above(sample) {
                        break;
                    }
                }
            }
            output.write(Steps(steps as i8));
        }
        if check.is_finite() {
            state.base = band.base();
        } else {
            encode_each(self, state, samples, outputs);
        }
        first + samples.len()
    }

    follow_baseline!(SendOnDeltaState);

    fn decoder_state(&self) -> StepState<S> {
        StepState::ZERO
    }

    /// Adds step after step, as the encoder did.
    #[inline]
    fn decode(&self, state: &mut StepState<S>, steps: Steps<K>) -> S {
        let steps = i32::from(steps.0);
        let step = match steps {
            0 => return state.value(),
            1.. => self.threshold,
            _ => self.threshold.negated(),
        };
        state.climb(step, steps.unsigned_abs())
    }

    fn held(&self, state: &StepState<S>) -> Option<S> {
        Some(state.value())
    }

    fn resync(&self, state: &mut StepState<S>, value: S) {
        *state = StepState::at(value);
    }
}
