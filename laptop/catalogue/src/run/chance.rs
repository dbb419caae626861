//! Bernoulli in `f32`, with draws that do not wait for one another.

// What is not inlined is compiled for a processor without wide vectors.
#![allow(clippy::inline_always)]

use std::any::Any;

use bytemuck::{Pod, cast_slice};
use pulp::{Arch, Simd, WithSimd};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use spikewire::Spike;
use spikewire::rate::{Average, Bernoulli, BernoulliState};

/// Encodes as the scheme's `encode_slice` does; `None` unless the scheme is Bernoulli in `f32` with [`Average`].
pub(super) fn encode_slice<S: Pod>(
    scheme: &dyn Any,
    state: &mut dyn Any,
    samples: &[S],
    outputs: &mut dyn Any,
) -> Option<usize> {
    let scheme = scheme.downcast_ref::<Bernoulli<f32, Pcg32, Average>>()?;
    let state = state.downcast_mut::<BernoulliState<Pcg32>>()?;
    let (samples, spikes) = (cast_slice(samples), outputs.downcast_mut::<Vec<Spike>>()?);
    Some(Arch::new().dispatch(Call { scheme, state, samples, spikes }))
}

struct Call<'a> {
    scheme: &'a Bernoulli<f32, Pcg32, Average>,
    state: &'a mut BernoulliState<Pcg32>,
    samples: &'a [f32],
    spikes: &'a mut [Spike],
}

impl WithSimd for Call<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        self.scheme.encode_slice_with(self.state, self.samples, self.spikes, draws)
    }
}

/// Draws from two places of the sequence in turns.
#[inline(always)]
fn draws(generator: &mut Pcg32) -> [u32; 32] {
    let mut later = generator.clone();
    later.advance(16);
    let mut draws = [0; 32];
    for i in 0..16 {
        draws[i] = generator.next_u32();
        draws[16 + i] = later.next_u32();
    }
    *generator = later;
    draws
}

#[cfg(test)]
mod tests {
    use spikewire::Scheme;

    use super::*;

    #[test]
    fn spikes_are_those_of_one_draw_after_the_other() {
        let scheme = Bernoulli::<f32, Pcg32, Average>::new(-1.0..=1.0, Average::new(4));
        let start = Bernoulli::<f32, Pcg32, Average>::state(Pcg32::new(1, 2));
        let mut samples: Vec<f32> = (0..1000).map(|i| (i as f32).sin()).collect();
        (samples[100], samples[500]) = (f32::NAN, 7.0);
        for length in [0, 1, 31, 32, 33, 1000] {
            let (mut state, mut expected_state) = (start.clone(), start.clone());
            let mut spikes = vec![Spike::None; length];
            let mut expected = spikes.clone();
            for samples in [&samples[..length], &samples[..length]] {
                encode_slice(&scheme, &mut state, samples, &mut spikes).unwrap();
                for (spike, &sample) in expected.iter_mut().zip(samples) {
                    *spike = scheme.encode(&mut expected_state, sample);
                }
                assert_eq!(spikes, expected);
            }
        }
    }
}
