//! Numbers of a network: double precision, and those of the controller.

use std::fmt::Debug;

/// A number with the operations of a neuron, each rounded by itself, as the crate has them.
pub(super) trait Number: Copy + Default + PartialOrd + Debug + Send + Sync {
    /// A decay.
    type Factor: Copy + PartialEq + Debug + Send + Sync;

    fn scaled(self, factor: Self::Factor) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;

    /// The number in its range, and whether it was outside.
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

/// The range of potentials and currents in whole numbers.
pub(super) const RANGE: i32 = 1 << 29;

/// The decay that stands for 1, in whole numbers.
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
