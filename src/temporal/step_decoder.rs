//! The decoder of the temporal codes.

use crate::{Decoder, Sample, Spike};

/// Adds up steps: `y[i] = y[i-1] + step * s[i]`.
///
/// - **Range:** one rounding a spike in `f32`; exact in fixed point until the value reaches an end
///   of the type, where it saturates.
/// - **Memory:** 8 bytes in `f32`.
///
/// It starts at 0; [`resync`](Decoder::resync) it to the first sample, or to a keyframe.
///
/// Source: paper, section II-C.
#[derive(Clone, Copy, Debug)]
pub struct StepDecoder<S> {
    value: S,
    step: S,
}

impl<S: Sample> StepDecoder<S> {
    pub(super) fn new(step: S) -> Self {
        Self { value: S::ZERO, step }
    }

    /// The value decoded last.
    pub fn value(&self) -> S {
        self.value
    }
}

impl<S: Sample> Decoder for StepDecoder<S> {
    type Sample = S;
    type Code = Spike;

    #[inline]
    fn decode(&mut self, spike: Spike) -> S {
        match spike {
            Spike::Up => self.value = self.value.plus(self.step),
            Spike::Down => self.value = self.value.minus(self.step),
            Spike::None => {}
        }
        self.value
    }

    /// The value stays in a register.
    #[inline]
    fn decode_slice(&mut self, spikes: &[Spike], values: &mut [S]) -> usize {
        let steps = [S::ZERO.minus(self.step), S::ZERO, self.step];
        let mut decoded = self.value;
        for (value, &spike) in values.iter_mut().zip(spikes) {
            if spike.is_fired()
                && let Some(&step) = steps.get((spike.sign() + 1) as usize)
            {
                decoded = decoded.plus(step);
            }
            *value = decoded;
        }
        self.value = decoded;
        spikes.len().min(values.len())
    }

    fn resync(&mut self, value: S) {
        self.value = value;
    }

    fn reset(&mut self) {
        self.value = S::ZERO;
    }
}
