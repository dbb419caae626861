//! A network of 64 neurons: each passes on what the last rate was, unless the next one comes before it has leaked.

use core::num::NonZeroU32;
use spikewire::population::Position;
use spikewire_chips::{Inputs, TinyOdinNetwork, TinyOdinNeuron, neurons_from};

/// A neuron for each quarter of a rad/s.
pub static RATES: Position<f32, 64> = Position::linear(-8.0..=8.0);

/// Each neuron fires when a spike of its own input comes, and what its neighbours' spikes add leaks in a time step.
pub static NETWORK: TinyOdinNetwork<64, 64, 64> = TinyOdinNetwork {
    neurons: [TinyOdinNeuron { threshold: 7, leak: 3, ..TinyOdinNeuron::REST }; 64],
    inputs: Inputs::one_to_one(7),
    recurrent: &[],
    outputs: neurons_from::<0, 64>(),
};

/// A leak of all neurons, in µs.
pub const TIME_STEP: NonZeroU32 = NonZeroU32::new(5_000).unwrap();
