//! The number types of a network: double precision, and the types of the controller.

use std::fmt::Debug;

/// A type for the numbers of a neuron, such as its potential. The operations of the type round exactly as in
/// `spikewire-network`.
pub(super) trait Number: Copy + Default + PartialOrd + Debug + Send + Sync {
    /// The type of a decay factor.
    type Factor: Copy + PartialEq + Debug + Send + Sync;

    fn scaled(self, factor: Self::Factor) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;

    /// Limits a potential or current to its range. Returns the result, and whether the number was outside the range.
    fn bounded(self) -> (Self, bool) {
        (self, false)
    }
}

macro_rules! float {
    ($type:ty) => {
        impl Number for $type {
            type Factor = Self;

            fn scaled(self, factor: Self) -> Self {
                self * factor
            }

            fn plus(self, other: Self) -> Self {
                self + other
            }

            fn minus(self, other: Self) -> Self {
                self - other
            }
        }
    };
}

float!(f64);
float!(f32);

/// Bound of potentials and currents in integers: they lie in `-RANGE..RANGE`.
pub(super) const RANGE: i32 = 1 << 29;

/// The integer that stands for a decay factor of 1.
pub(super) const ONE: f64 = 65_536.0;

impl Number for i32 {
    type Factor = u32;

    fn scaled(self, factor: u32) -> Self {
        ((i64::from(self) * i64::from(factor)) >> 16) as i32
    }

    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }

    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }

    fn bounded(self) -> (Self, bool) {
        let bounded = self.clamp(-RANGE, RANGE - 1);
        (bounded, bounded != self)
    }
}
