//! Filters in `f32`: one rounding an operation, in the order written here.

use super::{Recursive, Section};
use crate::num::Arithmetic;

/// The state of a second-order section; before the first sample its level is NaN. Always finite from then on.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FloatSecond {
    /// The signal behind the poles.
    level: f32,
    /// How much the level has changed in the last sample.
    slope: f32,
}

impl FloatSecond {
    /// The state that a signal of this constant value leaves.
    const fn steady(level: f32) -> Self {
        Self { level, slope: 0.0 }
    }

    /// The output, and the state after this sample. If anything overflows or is not finite to begin with, the output or
    /// the level is not finite, and the level of every later state is not either.
    #[inline(always)]
    fn step(self, section: Section<f32>, sample: f32) -> (f32, Self) {
        let error = sample - self.level;
        let change = section.gain * error - section.damping * self.slope;
        let output = self.level + section.tap * change;
        let slope = self.slope + change;
        (output, Self { level: self.level + slope, slope })
    }

    /// [`step`](Self::step), where the sum of its results is not finite.
    #[cold]
    fn restart(&mut self, section: Section<f32>, sample: f32) -> f32 {
        let (output, next) = self.step(section, sample);
        if output.is_finite() && next.level.is_finite() {
            *self = next;
            return output;
        }
        if !sample.is_finite() {
            return sample;
        }
        let (output, next) = Self::steady(sample).step(section, sample);
        *self = next;
        output
    }
}

/// The output of a first-order low-pass, which is its state; NaN before the first sample.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FloatFirst(f32);

impl FloatFirst {
    #[inline(always)]
    fn step(self, gain: f32, sample: f32) -> Self {
        Self(self.0 + gain * (sample - self.0))
    }
}

/// How many samples a turn of a slice's loop takes.
const TURN: usize = 4;

/// Calls `filter` for each sample, [`TURN`] samples a turn.
#[inline(always)]
fn each(samples: &[f32], outputs: &mut [f32], mut filter: impl FnMut(f32) -> f32) {
    let length = samples.len().min(outputs.len());
    let (samples, last) = samples.get(..length).unwrap_or_default().as_chunks::<TURN>();
    let (outputs, last_outputs) =
        outputs.get_mut(..length).unwrap_or_default().as_chunks_mut::<TURN>();
    for (outputs, samples) in outputs.iter_mut().zip(samples) {
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            *output = filter(sample);
        }
    }
    for (output, &sample) in last_outputs.iter_mut().zip(last) {
        *output = filter(sample);
    }
}

impl Recursive for f32 {
    type Coefficient = f32;
    type Second = FloatSecond;
    type First = FloatFirst;

    const SECOND: FloatSecond = FloatSecond::steady(f32::NAN);
    const FIRST: FloatFirst = FloatFirst(f32::NAN);

    #[inline]
    fn second(self, section: Section<f32>, state: &mut FloatSecond) -> f32 {
        let (output, next) = state.step(section, self);
        if (output + next.level).is_finite() {
            *state = next;
            output
        } else {
            state.restart(section, self)
        }
    }

    #[inline]
    fn first(self, gain: f32, state: &mut FloatFirst) -> f32 {
        let next = state.step(gain, self);
        if next.0.is_finite() {
            *state = next;
        } else if self.is_finite() {
            *state = FloatFirst(self).step(gain, self);
        } else {
            return self;
        }
        state.0
    }

    /// Coefficients and state stay in registers, and one check at the end asks whether all was finite: if not, the
    /// slice is filtered again, sample by sample.
    #[inline]
    fn second_slice(
        section: Section<f32>,
        state: &mut FloatSecond,
        samples: &[f32],
        outputs: &mut [f32],
    ) {
        let mut local = *state;
        if local.level.is_nan()
            && let Some(&first) = samples.first()
        {
            local = FloatSecond::steady(first);
        }
        let mut check = 0.0_f32;
        each(samples, outputs, |sample| {
            let (output, next) = local.step(section, sample);
            local = next;
            check = check.including(output);
            output
        });
        if check.is_finite() && local.level.is_finite() {
            *state = local;
        } else {
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                *output = sample.second(section, state);
            }
        }
    }

    #[inline]
    fn first_slice(gain: f32, state: &mut FloatFirst, samples: &[f32], outputs: &mut [f32]) {
        let mut local = *state;
        if local.0.is_nan()
            && let Some(&first) = samples.first()
        {
            local = FloatFirst(first);
        }
        each(samples, outputs, |sample| {
            local = local.step(gain, sample);
            local.0
        });
        if local.0.is_finite() {
            *state = local;
        } else {
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                *output = sample.first(gain, state);
            }
        }
    }

    fn value(coefficient: f32) -> f64 {
        coefficient.into()
    }
}
