//! roll.nir, brought onto tinyODIN by `spikewire network`.

use core::num::NonZeroU32;
use spikewire_chips::{Inputs, TinyOdinNetwork, TinyOdinNeuron};

/// The input that carries the bias: it must fire in every step, before the other inputs.
pub const BIAS: u16 = 20;

/// Number of steps between two leaks of all neurons, 5038 µs in the recording.
pub const STEPS_A_LEAK: NonZeroU32 = NonZeroU32::new(1).unwrap();

/// Neurons in each layer: 12 (node `lif1`), 3 (node `lif2`). Inputs: 20, of 20 neurons of 1 column.
#[rustfmt::skip]
pub static NETWORK: TinyOdinNetwork<21, 15, 3> = TinyOdinNetwork {
    neurons: [
        TinyOdinNeuron { threshold: 9, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 8, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 10, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 7, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 11, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 8, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 7, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 9, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 8, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 10, leak: 0, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 9, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 8, leak: 2, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 3, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 20, leak: 1, ..TinyOdinNeuron::REST },
        TinyOdinNeuron { threshold: 6, leak: 1, ..TinyOdinNeuron::REST },
    ],
    inputs: Inputs::Rows([
        [7, 1, -1, -1, -1, -1, 0, -1, 0, -1, 0, -1, 0, 0, 0],
        [4, 4, -1, 0, -1, 0, -1, 0, -1, -1, 0, 0, 0, 0, 0],
        [0, 6, 2, -1, -1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0],
        [-1, 3, 7, 0, -1, 0, 0, -1, -1, 0, -1, -1, 0, 0, 0],
        [0, -1, 7, 3, 0, 0, 0, -1, 0, 0, -1, -1, 0, 0, 0],
        [-1, -1, 2, 6, 1, 0, -1, -1, 0, -1, -1, -1, 0, 0, 0],
        [-1, -1, 0, 4, 5, -1, -1, -1, 0, -1, -1, -1, 0, 0, 0],
        [-1, -1, -1, 1, 7, 1, 0, -1, -1, -1, 0, 0, 0, 0, 0],
        [-1, -1, -1, -1, 5, 5, 0, -1, -1, -1, -1, -1, 0, 0, 0],
        [-1, -1, -1, 0, 0, 6, 2, -1, -1, -1, -1, -1, 0, 0, 0],
        [-1, 0, -1, 0, 0, 2, 5, 0, -1, -1, -1, -1, 0, 0, 0],
        [-1, -1, -1, -1, -1, 0, 5, 4, 0, 0, -1, -1, 0, 0, 0],
        [-1, -1, -1, -1, -1, -1, 1, 7, 1, 0, -1, -1, 0, 0, 0],
        [-1, 0, -1, 0, -1, 0, 0, 4, 5, -1, -1, -1, 0, 0, 0],
        [-1, 0, -1, -1, -1, -1, -1, 1, 6, 2, -1, -1, 0, 0, 0],
        [-1, 0, -1, 0, -2, -1, -1, 0, 3, 6, 0, -1, 0, 0, 0],
        [-1, -1, -1, -1, -1, -1, -1, -1, 0, 7, 3, -1, 0, 0, 0],
        [-1, -1, -1, -1, -1, 0, -1, -1, -1, 2, 7, 1, 0, 0, 0],
        [-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 5, 3, 0, 0, 0],
        [-1, -1, -1, -1, -1, 0, -1, -1, 0, -1, 1, 6, 0, 0, 0],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    ]),
    recurrent: &[
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, -8, -7],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, -8, -7],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, -8, -6],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, -8, -6],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, -8, -5],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 6, -2],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 6, 2],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -3, -8, 5],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -3, -8, 6],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -3, -8, 7],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -4, -8, 6],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -3, -8, 6],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    ],
    outputs: [12, 13, 14],
};
