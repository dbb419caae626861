//! Sums of samples and of their squares, from which mean and deviation follow.

use core::fmt::Debug;

use super::arithmetic::for_each_integer;

/// How a sample type sums.
pub(crate) trait Summed: Sized {
    /// Wide enough for 2³²-1 samples.
    type Sums: Sums<Self>;
}

/// Sums over samples. Quantities are in units of the type's last place; in `f32` as they are.
pub(crate) trait Sums<S>: Copy + Debug + Send + Sync {
    const ZERO: Self;

    /// Takes a finite sample, which is number `seen`, from 1.
    fn add(&mut self, seen: u32, sample: S);

    /// The mean of `seen` samples, at least one.
    fn mean(&self, seen: u32) -> f64;

    /// The sum of the squares of the distances from the mean.
    fn squares(&self, seen: u32) -> f64;
}

/// Welford's running mean and sum of squares, in double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Running {
    mean: f64,
    squares: f64,
}

impl Summed for f32 {
    type Sums = Running;
}

impl Sums<f32> for Running {
    const ZERO: Self = Self { mean: 0.0, squares: 0.0 };

    fn add(&mut self, seen: u32, sample: f32) {
        let sample = f64::from(sample);
        let before = sample - self.mean;
        self.mean += before / f64::from(seen);
        self.squares += before * (sample - self.mean);
    }

    fn mean(&self, _: u32) -> f64 {
        self.mean
    }

    fn squares(&self, _: u32) -> f64 {
        self.squares.max(0.0)
    }
}

/// The sums themselves, exactly: 2³² samples of 32 bits add up to 63 bits, and their squares to 94.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact {
    sum: i64,
    squares: u128,
}

impl Exact {
    const ZERO: Self = Self { sum: 0, squares: 0 };

    fn add(&mut self, bits: i32) {
        self.sum = self.sum.wrapping_add(i64::from(bits));
        let magnitude = u64::from(bits.unsigned_abs());
        self.squares = self.squares.wrapping_add(u128::from(magnitude.wrapping_mul(magnitude)));
    }

    fn mean(&self, seen: u32) -> f64 {
        self.sum as f64 / f64::from(seen)
    }

    /// `(n Σx² - (Σx)²) / n`: the numerator exactly, then one rounding and one division.
    fn squares(&self, seen: u32) -> f64 {
        let sum = u128::from(self.sum.unsigned_abs());
        let scaled = self.squares.wrapping_mul(u128::from(seen));
        scaled.wrapping_sub(sum.wrapping_mul(sum)) as f64 / f64::from(seen)
    }
}

macro_rules! integer_sums {
    ([$($generics:tt)*] $sample:ty, $bits:ty, $to_bits:path, $($rest:tt)*) => {
        impl<$($generics)*> Summed for $sample {
            type Sums = Exact;
        }

        impl<$($generics)*> Sums<$sample> for Exact {
            const ZERO: Self = Self::ZERO;

            fn add(&mut self, _: u32, sample: $sample) {
                self.add(i32::from($to_bits(sample)));
            }

            fn mean(&self, seen: u32) -> f64 {
                self.mean(seen)
            }

            fn squares(&self, seen: u32) -> f64 {
                self.squares(seen)
            }
        }
    };
}
for_each_integer!(integer_sums);
