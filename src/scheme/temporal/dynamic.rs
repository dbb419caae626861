//! Moving window (MW) whose number of samples is chosen at run time.

use alloc::vec;
use alloc::vec::Vec;

use super::StepState;
use super::steps::decode_steps;
use crate::error::{positive, within};
use crate::num::{Difference, Tally, margin, to_f64};
use crate::{ConfigError, Encoder, Fingerprint, Recovery, Sample, Scheme, Spike};

/// The most samples that a mean is taken over.
pub const WIDEST: usize = 16_384;

/// [`temporal::MovingWindow`](crate::temporal::MovingWindow) over any number of samples, 1 to 16 384.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingWindow<S: Sample> {
    threshold: S,
    count: usize,
    /// The threshold times the count, to compare differences with.
    margin: <S::Sum as Difference>::Margin,
}

/// The state of a [`MovingWindow`] encoder: the window and its sum.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct MovingWindowState<S: Sample> {
    ring: Vec<S>,
    partial: S::Sum,
    next: usize,
    is_full: bool,
    tally: Tally,
}

impl<S: Sample> MovingWindow<S> {
    /// A scheme with this threshold, which is also the decoder's step, and the mean of `count` samples.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, or not finite; the count is 0 or above 16 384.
    pub fn try_new(threshold: S, count: usize) -> Result<Self, ConfigError> {
        positive("threshold", to_f64(threshold))?;
        within("samples of the mean", count as f64, 1.0, WIDEST as f32)?;
        Ok(Self { threshold, count, margin: margin(threshold, count) })
    }

    /// The threshold, in the samples' unit.
    pub fn threshold(&self) -> S {
        self.threshold
    }

    /// How many samples the mean is taken over.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The state of an encoder before its first sample.
    pub fn state(&self) -> MovingWindowState<S> {
        MovingWindowState {
            ring: vec![S::ZERO; self.count],
            partial: S::Sum::ZERO,
            next: 0,
            is_full: false,
            tally: Tally::NONE,
        }
    }

    /// An encoder in its initial state.
    pub fn encoder(&self) -> Encoder<'_, Self> {
        Encoder::with_state(self, self.state())
    }
}

impl<S: Sample> Scheme for MovingWindow<S> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = MovingWindowState<S>;
    type DecoderState = StepState<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Keyframe;

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("MovingWindow").sample(self.threshold).number(self.count as u32)
    }

    /// Emits no spike before the window is full, for a sample that is not finite, and for a difference that is NaN.
    fn encode(&self, state: &mut MovingWindowState<S>, sample: S) -> Spike {
        let Some(slot) = state.ring.get_mut(state.next).filter(|_| sample.is_finite()) else {
            state.tally.reject();
            return Spike::None;
        };
        let difference = sample.excess(self.count, *slot, &mut state.partial);
        *slot = sample;
        let was_full = state.is_full;
        state.next += 1;
        if state.next == self.count {
            state.next = 0;
            state.is_full = true;
            S::close_block(&mut state.ring, &mut state.partial);
        }
        if was_full && !difference.is_nan() {
            Spike::from_side(difference.beyond(self.margin))
        } else {
            Spike::None
        }
    }

    /// The last samples of the past fill the window; a past shorter than the window is ignored.
    fn prime(&self, state: &mut MovingWindowState<S>, past: &[S]) {
        let start = past.len().checked_sub(self.count);
        let Some(window) = start.and_then(|start| past.get(start..)) else { return };
        if window.iter().all(S::is_finite) {
            let tally = state.tally;
            *state = MovingWindowState { tally, ..self.state() };
            for &sample in window {
                self.encode(state, sample);
            }
        } else {
            state.tally.reject();
        }
    }

    /// The last sample, once the window is full.
    fn keyframe(&self, state: &MovingWindowState<S>) -> Option<S> {
        let newest = state.next.checked_sub(1).unwrap_or(self.count - 1);
        state.ring.get(newest).copied().filter(|_| state.is_full)
    }

    fn fits(&self, state: &MovingWindowState<S>) -> bool {
        state.ring.len() == self.count && state.next < self.count
    }

    fn rejected(state: &MovingWindowState<S>) -> u32 {
        state.tally.rejected()
    }

    decode_steps!(threshold);
}
