//! Temporal contrast (TBR): a spike when one sample differs enough from the one before.

use super::StepState;
use super::steps::decode_steps;
use crate::error::{positive, tri, unwrap};
use crate::num::{Tally, to_f64};
use crate::scheme::codec::{encode_each, encode_first};
use crate::{
    Calibration, ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start,
};

/// Temporal contrast, also called temporal-based representation (TBR): what event cameras do.
///
/// With `d = x[i] - x[i-1]`: [`Spike::Up`] if `d > threshold`, [`Spike::Down`] if
/// `d < -threshold`. The first sample has no predecessor and emits nothing, unless the encoder was
/// [primed](crate::Encoder::prime).
///
/// - **Threshold:** above 0, in the samples' unit. **Step** of the decoder: the threshold, unless set by
///   [`with_step`](Self::with_step); above 0, in the samples' unit.
/// - **Latency:** 0 samples. **Memory:** 8 bytes a channel in `f32`, 4 to decode.
/// - **Exactness:** `f32` rounds `d` once; fixed point compares exact differences.
/// - **Error:** the decoded value drifts without bound, since differences within the threshold are lost.
///   [Resynchronise](crate::Decoder::resync) it.
/// - **Silence:** a constant signal gives no spike. A larger threshold never gives more spikes.
///
/// Source: paper, section II-C, algorithm 6.
///
/// ```
/// use spikewire::{Scheme, Spike, temporal::TemporalContrast};
///
/// const RATE: TemporalContrast<f32> = TemporalContrast::new(0.5);
/// let mut encoder = RATE.encoder();
/// let spikes = [0.0, 0.6, 0.9, 0.2].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [Spike::None, Spike::Up, Spike::None, Spike::Down]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TemporalContrast<S> {
    threshold: S,
    step: S,
}

impl<S: Sample> TemporalContrast<S> {
    /// A scheme whose decoder steps by the threshold. For constants, where a bad threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not above 0, or not finite.
    pub const fn new(threshold: S) -> Self {
        unwrap(Self::try_new(threshold))
    }

    /// A scheme whose decoder steps by the threshold.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, or not finite.
    pub const fn try_new(threshold: S) -> Result<Self, ConfigError> {
        tri!(positive("threshold", to_f64(threshold)));
        Ok(Self { threshold, step: threshold })
    }

    /// Sets the decoder's step, in the samples' unit; the paper's figures take twice the threshold. For constants,
    /// where a bad step fails the build.
    ///
    /// # Panics
    /// Panics if the step is not above 0, or not finite.
    #[must_use]
    pub const fn with_step(self, step: S) -> Self {
        unwrap(self.try_with_step(step))
    }

    /// Sets the decoder's step, in the samples' unit; the paper's figures take twice the threshold.
    ///
    /// # Errors
    /// Returns an error if the step is not above 0, or not finite.
    pub const fn try_with_step(self, step: S) -> Result<Self, ConfigError> {
        tri!(positive("step", to_f64(step)));
        Ok(Self { step, ..self })
    }

    /// The paper's threshold, `mean(d) + factor * std(d)`, over the differences of a calibration.
    ///
    /// # Errors
    /// Returns an error if the factor is not finite; the calibration saw fewer than three samples; or the threshold
    /// comes out at 0 or below, as for a signal that falls more than it varies: then use
    /// [`from_magnitudes`](Self::from_magnitudes).
    pub fn from_calibration(
        calibration: &Calibration<S>,
        factor: f32,
    ) -> Result<Self, ConfigError> {
        Self::try_new(S::from_f64(calibration.differences()?.threshold(factor)?))
    }

    /// The threshold `mean(|d|) + factor * std(|d|)` over the differences of a calibration: above 0 for any signal
    /// that moves, if the factor is 0 or more.
    ///
    /// # Errors
    /// Returns an error if the factor is not finite; the calibration saw fewer than three samples; or the threshold
    /// comes out at 0 or below, as for a signal that never moved.
    pub fn from_magnitudes(calibration: &Calibration<S>, factor: f32) -> Result<Self, ConfigError> {
        Self::try_new(S::from_f64(calibration.magnitudes()?.threshold(factor)?))
    }

    /// The threshold, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }

    /// The decoder's step, in the samples' unit.
    pub const fn step(&self) -> S {
        self.step
    }
}

/// The state of a [`TemporalContrast`] encoder: the last sample. 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContrastState<S> {
    previous: S,
    tally: Tally,
}

impl<S: Sample> Start for TemporalContrast<S> {
    const START: ContrastState<S> = ContrastState { previous: S::ZERO, tally: Tally::NONE };
}

impl<S: Sample> Scheme for TemporalContrast<S> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = ContrastState<S>;
    type DecoderState = StepState<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Keyframe;

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("TemporalContrast").sample(self.threshold).sample(self.step)
    }

    #[inline]
    fn encode(&self, state: &mut ContrastState<S>, sample: S) -> Spike {
        if !state.tally.is_primed() || !sample.is_finite() {
            self.prime(state, &[sample]);
            return Spike::None;
        }
        let previous = core::mem::replace(&mut state.previous, sample);
        Spike::from_side(sample.step(previous, self.threshold))
    }

    /// The last sample stays in a register, and one check at the end asks whether all were finite: if not, the
    /// slice is encoded again, sample by sample.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut ContrastState<S>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
    ) -> usize {
        let (first, samples, spikes) =
            encode_first(self, state.tally.is_primed(), state, samples, spikes);

        let mut previous = state.previous;
        let mut check = S::ZERO;
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            check = check.including(sample);
            spike.write(Spike::from_side(sample.step(previous, self.threshold)));
            previous = sample;
        }
        if check.is_finite() {
            state.previous = previous;
        } else {
            encode_each(self, state, samples, spikes);
        }
        first + samples.len()
    }

    /// The last sample of the past becomes the predecessor of the next one.
    fn prime(&self, state: &mut ContrastState<S>, past: &[S]) {
        if let Some(previous) = state.tally.last_of(past) {
            state.previous = previous;
        }
    }

    /// The last sample.
    fn keyframe(&self, state: &ContrastState<S>) -> Option<S> {
        state.tally.is_primed().then_some(state.previous)
    }

    fn rejected(state: &ContrastState<S>) -> u32 {
        state.tally.rejected()
    }

    decode_steps!(step);
}
