//! The numbers that the reference is written in.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// `f32` or `f64`, as far as the coding schemes need them: every operation rounds once.
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Into<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Nothing.
    const ZERO: Self;

    /// The nearest number of this type.
    fn rounded(value: f64) -> Self;

    /// The value without its sign.
    #[must_use]
    fn magnitude(self) -> Self;

    /// Neither infinite nor NaN.
    fn finite(self) -> bool;

    /// A count, exact up to the width of the significand.
    fn count(count: usize) -> Self {
        Self::rounded(count as f64)
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;

    fn rounded(value: f64) -> Self {
        value as f32
    }

    fn magnitude(self) -> Self {
        self.abs()
    }

    fn finite(self) -> bool {
        self.is_finite()
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;

    fn rounded(value: f64) -> Self {
        value
    }

    fn magnitude(self) -> Self {
        self.abs()
    }

    fn finite(self) -> bool {
        self.is_finite()
    }
}

/// A list computed in `f64`, each value rounded once to the sample type.
pub fn rounded<T: Real>(values: &[f64]) -> Vec<T> {
    values.iter().map(|&value| T::rounded(value)).collect()
}

/// The value of a range that is nearest to this one.
pub fn clamped<T: PartialOrd>(value: T, min: T, max: T) -> T {
    if value < min {
        min
    } else if value > max {
        max
    } else {
        value
    }
}
