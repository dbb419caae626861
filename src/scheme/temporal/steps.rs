//! The decoder that the temporal codes share: it adds up steps.

use crate::{Sample, Spike};

/// The state of a temporal code's decoder: the value decoded last. 4 bytes in `f32`.
///
/// `y[i] = y[i-1] + step * s[i]`, from 0 or from the value given by [`resync`](crate::Decoder::resync). `f32` rounds
/// once a spike; fixed point is exact until the value reaches an end of the type, where it saturates.
///
/// Source: paper, section II-C.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepState<S> {
    value: S,
}

impl<S: Sample> StepState<S> {
    pub(super) const ZERO: Self = Self { value: S::ZERO };

    pub(super) const fn at(value: S) -> Self {
        Self { value }
    }

    pub(super) const fn value(&self) -> S {
        self.value
    }

    #[inline]
    pub(super) fn decode(&mut self, step: S, spike: Spike) -> S {
        let step = match spike {
            Spike::Up => step,
            Spike::Down => step.negated(),
            Spike::None => return self.value,
        };
        self.value = self.value.plus(step);
        self.value
    }

    /// Adds a step so many times.
    #[inline]
    pub(super) fn climb(&mut self, step: S, times: u32) -> S {
        let step = step.level();
        let level = (0..times).fold(self.value.level(), |level, _| S::climb(level, step));
        self.value = S::of_level(level);
        self.value
    }

    /// The value stays in a register, and a turn of the loop decodes eight samples.
    #[allow(clippy::inline_always)]
    #[inline(always)] // a call would move five arguments
    pub(super) fn decode_slice(
        &mut self,
        step: S,
        spikes: &[impl Copy + Into<Spike>],
        values: &mut [S],
    ) -> usize {
        let steps = [step.negated(), S::ZERO, step].map(S::level);
        let (mut level, mut decoded) = (self.value.level(), self.value);
        let mut decode = |value: &mut S, spike: Spike| {
            if spike.is_fired()
                && let Some(&step) = steps.get((spike.sign() + 1) as usize)
            {
                level = S::climb(level, step);
                decoded = S::of_level(level);
            }
            *value = decoded;
        };
        let length = spikes.len().min(values.len());
        let (spikes, last_spikes) = spikes.get(..length).unwrap_or_default().as_chunks::<8>();
        let (values, last_values) =
            values.get_mut(..length).unwrap_or_default().as_chunks_mut::<8>();
        for (values, spikes) in values.iter_mut().zip(spikes) {
            for (value, &spike) in values.iter_mut().zip(spikes) {
                decode(value, spike.into());
            }
        }
        for (value, &spike) in last_values.iter_mut().zip(last_spikes) {
            decode(value, spike.into());
        }
        self.value = decoded;
        length
    }
}

/// The decoding half of a temporal code's [`Scheme`](crate::Scheme), with this field as the step.
macro_rules! decode_steps {
    ($step:ident) => {
        fn decoder_state(&self) -> StepState<S> {
            StepState::ZERO
        }

        #[inline]
        fn decode(&self, state: &mut StepState<S>, spike: Spike) -> S {
            state.decode(self.$step, spike)
        }

        #[inline]
        fn decode_slice(
            &self,
            state: &mut StepState<S>,
            spikes: &[impl Copy + Into<Spike>],
            values: &mut [S],
        ) -> usize {
            state.decode_slice(self.$step, spikes, values)
        }

        fn held(&self, state: &StepState<S>) -> Option<S> {
            Some(state.value())
        }

        fn resync(&self, state: &mut StepState<S>, value: S) {
            *state = StepState::at(value);
        }
    };
}
pub(super) use decode_steps;
