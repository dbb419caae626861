//! Adaptive step forward: step forward whose step doubles while its spikes go on in one direction.

use super::band::Band;
use super::doublings::{self, hold_with_history};
use crate::error::{tri, unwrap, within};
use crate::num::{HAS_VECTORS, Tally};
use crate::scheme::codec::encode_first;
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Adaptive step forward: the baseline follows the signal by one step a spike, and the step grows while the signal
/// runs away.
///
/// As [`StepForward`](super::StepForward) with the step `threshold * 2^e`, where `e` is 0 at first. After every
/// sample: if the last `run` spikes went one way without a sample between, `e` grows by 1, up to `doublings`; otherwise
/// it falls by 1, down to 0. The decoder does the same.
///
/// - **Threshold:** above 0, in the samples' unit. The sample type must hold the largest step,
///   `threshold * 2^doublings`; in `f32` it is at most 10³¹. **Doublings:** 0 to 30; 0 is step forward. **Run:** 1 to
///   8, 2 by default.
/// - **Latency:** 0 samples. **Memory:** 12 bytes a channel in `f32`, 8 to decode.
/// - **Work:** two comparisons.
/// - **Exactness:** steps are exact, `f32` rounds `base ± step` once; fixed point is exact.
/// - **Error:** while `|x[i] - x[i-1]| <= threshold`, the decoded value stays within two thresholds of the signal.
///   It never overshoots. A jump by `J` from rest is followed to within a threshold after
///   `J / (threshold * 2^doublings) + 3 * doublings` samples, rounded up (for runs of 2 to 4).
/// - **Keyframes:** only at rest, when `e` is 0 and the last sample had no spike: then the baseline is all that a
///   decoder must know. Where there is no keyframe now, ask again at the next sample.
///
/// Source: Jayant, *Adaptive delta modulation with a one-bit memory*, 1970.
///
/// ```
/// use spikewire::{Scheme, temporal::AdaptiveStepForward};
///
/// const ROLL: AdaptiveStepForward<i16> = AdaptiveStepForward::new(1, 4); // steps of 1, 2, 4, 8 and 16
/// let (mut encoder, mut decoder) = (ROLL.encoder(), ROLL.decoder());
/// let values = [0, 40, 40, 40, 40, 40, 40, 40].map(|x| decoder.decode(encoder.encode(x)));
/// assert_eq!(values, [0, 1, 2, 4, 8, 16, 32, 32]);
/// ```
///
/// A step that the sample type cannot hold does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::AdaptiveStepForward;
/// const ROLL: AdaptiveStepForward<i16> = AdaptiveStepForward::new(3000, 4);
/// # let _ = ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AdaptiveStepForward<S> {
    threshold: S,
    doublings: u8,
    run: u8,
}

/// The largest step is then 2³⁰ thresholds.
const MOST_DOUBLINGS: u8 = 30;
/// The bound on the error is checked for runs up to this.
const LONGEST_RUN: u8 = 8;

impl<S: Sample> AdaptiveStepForward<S> {
    /// A scheme with this threshold, whose step doubles at most `doublings` times. For constants, where bad parameters
    /// fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(threshold: S, doublings: u8) -> Self {
        unwrap(Self::try_new(threshold, doublings))
    }

    /// A scheme with this threshold, whose step doubles at most `doublings` times.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, or not finite; there are more than 30 doublings; the largest
    /// step is more than the sample type holds, or above 10³¹ in `f32`.
    pub const fn try_new(threshold: S, doublings: u8) -> Result<Self, ConfigError> {
        tri!(doublings::check(threshold, doublings, MOST_DOUBLINGS, "largest step"));
        Ok(Self { threshold, doublings, run: 2 })
    }

    /// Sets after how many spikes in one direction, one a sample, the step grows; 2 by default. For constants, where a
    /// bad number fails the build.
    ///
    /// # Panics
    /// Panics if the number is not within 1 to 8.
    #[must_use]
    pub const fn with_run(self, run: u8) -> Self {
        unwrap(self.try_with_run(run))
    }

    /// Sets after how many spikes in one direction, one a sample, the step grows; 2 by default.
    ///
    /// # Errors
    /// Returns an error if the number is not within 1 to 8.
    pub const fn try_with_run(self, run: u8) -> Result<Self, ConfigError> {
        tri!(within("run", run as f64, 1.0, LONGEST_RUN as f32));
        Ok(Self { run, ..self })
    }

    /// The threshold, which is the smallest step, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }

    /// The state of an encoder with this baseline, so that its first sample counts from there instead of becoming the
    /// baseline itself; see [`SendOnDelta::state_at`](super::SendOnDelta::state_at).
    pub const fn state_at(baseline: S) -> AdaptiveState<S> {
        match Tally::of_baseline(baseline) {
            Some(tally) => AdaptiveState { base: baseline, tally, pace: Pace::REST },
            None => Self::START,
        }
    }

    #[inline]
    fn band(&self, base: S, pace: Pace) -> Band<S> {
        Band::around(base, self.threshold.doubled(pace.exponent))
    }

    /// Takes a sample; `None` if it is not finite. The pace then counts a silent sample, as the decoder does.
    #[inline]
    fn follow(&self, base: &mut S, pace: &mut Pace, sample: S) -> Option<Spike> {
        let band = self.band(*base, *pace);
        let spike = if band.holds(sample) {
            Spike::None
        } else if !sample.is_finite() {
            pace.take(Spike::None, self.run, self.doublings);
            return None;
        } else if band.is_below(sample) {
            *base = band.upper();
            Spike::Up
        } else {
            *base = band.lower();
            Spike::Down
        };
        pace.take(spike, self.run, self.doublings);
        Some(spike)
    }
}

/// How fast the baseline moves: the size of its step, and the run of spikes that may double it. Two bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Pace {
    /// How often the step is doubled.
    exponent: u8,
    /// How many spikes in one direction came last, one a sample; negative if they went down.
    run: i8,
}

impl Pace {
    const REST: Self = Self { exponent: 0, run: 0 };

    #[inline]
    fn take(&mut self, spike: Spike, run: u8, doublings: u8) {
        self.run = match spike {
            Spike::Up => self.run.max(0).saturating_add(1),
            Spike::None => 0,
            Spike::Down => self.run.min(0).saturating_sub(1),
        };
        self.exponent = if self.run.unsigned_abs() >= run {
            self.exponent.saturating_add(1).min(doublings)
        } else {
            self.exponent.saturating_sub(1)
        };
    }
}

/// The state of an [`AdaptiveStepForward`] encoder: the baseline, the step's exponent and the run. 12 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveState<S> {
    base: S,
    tally: Tally,
    pace: Pace,
}

/// The state of an [`AdaptiveStepForward`] decoder: the value, the step's exponent and the run. 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveStepState<S> {
    value: S,
    pace: Pace,
}

impl<S: Sample> Start for AdaptiveStepForward<S> {
    const START: AdaptiveState<S> =
        AdaptiveState { base: S::ZERO, tally: Tally::NONE, pace: Pace::REST };
}

impl<S: Sample> Scheme for AdaptiveStepForward<S> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = AdaptiveState<S>;
    type DecoderState = AdaptiveStepState<S>;

    const LATENCY: usize = 0;
    /// Each silent sample halves the step: after as many as there are doublings it is the smallest.
    const RECOVERY: Recovery = Recovery::TimedKeyframe(MOST_DOUBLINGS as usize);

    fn holds_keyframes(&self) -> bool {
        true
    }

    fn fingerprint(&self) -> Fingerprint {
        let Self { threshold, doublings, run } = *self;
        Fingerprint::new("AdaptiveStepForward")
            .sample(threshold)
            .number(doublings.into())
            .number(run.into())
    }

    #[inline]
    fn encode(&self, state: &mut AdaptiveState<S>, sample: S) -> Spike {
        if state.tally.is_primed()
            && let Some(spike) = self.follow(&mut state.base, &mut state.pace, sample)
        {
            return spike;
        }
        self.prime(state, &[sample]);
        Spike::None
    }

    /// The baseline and the pace stay in registers, and while at rest also the band, but on a core with vectors, which
    /// predicts the branches of single samples.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut AdaptiveState<S>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
    ) -> usize {
        let (first, samples, spikes) =
            encode_first(self, state.tally.is_primed(), state, samples, spikes);

        let AdaptiveState { mut base, mut pace, .. } = *state;
        let mut band = Band::around(base, self.threshold);
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            if !HAS_VECTORS && pace == Pace::REST && band.holds(sample) {
                spike.write(Spike::None);
                continue;
            }
            let followed = self.follow(&mut base, &mut pace, sample);
            if followed.is_none() {
                state.tally.reject();
            }
            spike.write(followed.unwrap_or_default());
            band = Band::around(base, self.threshold);
        }
        (state.base, state.pace) = (base, pace);
        first + samples.len()
    }

    /// The last sample of the past becomes the baseline, and the step the smallest. Give the decoder that value by
    /// `resync`.
    fn prime(&self, state: &mut AdaptiveState<S>, past: &[S]) {
        if let Some(base) = state.tally.last_of(past) {
            state.base = base;
            state.pace = Pace::REST;
        }
    }

    /// The baseline, at rest.
    fn keyframe(&self, state: &AdaptiveState<S>) -> Option<S> {
        (state.tally.is_primed() && state.pace == Pace::REST).then_some(state.base)
    }

    fn rejected(state: &AdaptiveState<S>) -> u32 {
        state.tally.rejected()
    }

    /// Adds the step, and adapts it as the encoder did.
    #[inline]
    fn decode(&self, state: &mut AdaptiveStepState<S>, spike: Spike) -> S {
        let step = self.threshold.doubled(state.pace.exponent);
        state.value = match spike {
            Spike::Up => state.value.plus(step),
            Spike::None => state.value,
            Spike::Down => state.value.minus(step),
        };
        state.pace.take(spike, self.run, self.doublings);
        state.value
    }

    hold_with_history!(AdaptiveStepState, pace: Pace::REST);
}
