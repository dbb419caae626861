//! Random numbers from a seed. Those of a normal distribution may differ in the last digits between platforms, which
//! round logarithms and cosines differently.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A generator of random numbers.
pub(super) struct Chance(ChaCha8Rng);

impl Chance {
    /// Makes a generator from a seed.
    pub(super) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Draws a number from 0 up to, but not including, 1. All numbers are equally likely.
    pub(super) fn part(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Draws an index below `count`, which must be 1 or more.
    pub(super) fn below(&mut self, count: usize) -> usize {
        ((self.part() * count as f64) as usize).min(count - 1)
    }

    /// Draws from a normal distribution of deviation 1 around 0.
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.part()).ln()).sqrt();
        radius * (TAU * self.part()).cos()
    }
}
