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

    /// The value stays in a register, and eight samples share a turn of the loop.
    #[inline]
    fn decode_slice(&mut self, spikes: &[Spike], values: &mut [S]) -> usize {
        let steps = [S::ZERO.minus(self.step), S::ZERO, self.step];
        let mut decoded = self.value;
        let mut decode = |value: &mut S, spike: Spike| {
            if spike.is_fired()
                && let Some(&step) = steps.get((spike.sign() + 1) as usize)
            {
                decoded = decoded.plus(step);
            }
            *value = decoded;
        };
        let length = spikes.len().min(values.len());
        let (spikes, last_spikes) = spikes.get(..length).unwrap_or_default().as_chunks::<8>();
        let (values, last_values) =
            values.get_mut(..length).unwrap_or_default().as_chunks_mut::<8>();
        for (values, spikes) in values.iter_mut().zip(spikes) {
            for (value, &spike) in values.iter_mut().zip(spikes) {
                decode(value, spike);
            }
        }
        for (value, &spike) in last_values.iter_mut().zip(last_spikes) {
            decode(value, spike);
        }
        self.value = decoded;
        length
    }

    fn resync(&mut self, value: S) {
        self.value = value;
    }

    fn reset(&mut self) {
        self.value = S::ZERO;
    }
}
