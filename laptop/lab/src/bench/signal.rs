//! Test signals of the benchmark in the paper *A toolbox for neuromorphic perception in robotics*.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::PI;

/// The waveform `2 sin(2πT) - 0.5 cos(0.5πT) + 0.75 sin(10πT)` at T = 0.01 s, 0.02 s, ...
pub struct Waveform {
    values: Vec<f64>,
}

/// Sample rate of the signals, in Hz.
pub const RATE: usize = 100;

impl Waveform {
    /// Computes the waveform's samples in the first `seconds` seconds.
    pub fn new(seconds: usize) -> Self {
        let at = |step: usize| {
            let t = step as f64 / RATE as f64;
            2.0 * (2.0 * PI * t).sin() - 0.5 * (0.5 * PI * t).cos() + 0.75 * (10.0 * PI * t).sin()
        };
        Self { values: (1..=seconds * RATE).map(at).collect() }
    }

    /// Returns the waveform minus the noise `0.5 U(0, 1)`, where `U(0, 1)` is uniformly distributed from 0 to 1.
    /// `number` is the number of the test signal. Each number has its own stream of random numbers.
    pub fn with_noise(&self, seed: u64, number: u64) -> Vec<f32> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(number);
        self.values.iter().map(|value| (value - 0.5 * uniform(&mut generator)) as f32).collect()
    }
}

/// Returns a uniformly distributed random number that is at least 0 and less than 1.
fn uniform(generator: &mut ChaCha8Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
