//! Bernoulli in `f32`, with draws that do not wait for one another.

use std::any::Any;

use bytemuck::{Pod, cast_slice};
use pulp::{Arch, Simd, WithSimd};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use spikewire::Spike;
use spikewire::rate::{Average, Bernoulli, BernoulliState};

/// Encodes what a scheme's `encode_slice` would encode alike; `None` for other schemes.
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
