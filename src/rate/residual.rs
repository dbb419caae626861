//! What is left of a signal after the filters of its spikes are subtracted.

use super::ben::Nearer;
use super::threshold_hough::Lack;
use crate::sample::for_each_integer;

/// The sample type's part in the rate codes. Sealed: only this crate can name it.
pub trait Rated: Sized {
    type Residual: Residual;

    /// `self - shift`, within what `magnitude` of all taps leaves free.
    fn residual(self, shift: Self, magnitude: Self) -> Self::Residual;

    /// A tap or a threshold, in the residual's unit.
    fn widen(self) -> Self::Residual;

    /// `self + sum`, saturating; `self` is the shift.
    fn restore(self, sum: Self::Residual) -> Self;
}

/// Arithmetic on residuals: `f32`, or exact 32-bit integers.
pub trait Residual: Copy + PartialOrd + core::fmt::Debug + Lack + Nearer {
    const ZERO: Self;

    /// Whether sums are exact, in any order.
    const IS_EXACT: bool;

    /// A sum of magnitudes.
    type Sum: Copy + core::fmt::Debug;
    /// The factor of the multiplicative BSA: `f32`, or 14 bits of fraction.
    type Ratio: Copy + core::fmt::Debug;

    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;

    fn no_sum() -> Self::Sum;
    /// `sum + |self - other|`.
    fn add_distance(self, other: Self, sum: Self::Sum) -> Self::Sum;

    fn ratio(value: f32) -> Self::Ratio;
    /// `left <= right * ratio`.
    fn at_most(left: Self::Sum, right: Self::Sum, ratio: Self::Ratio) -> bool;
}

impl Rated for f32 {
    type Residual = f32;

    #[inline]
    fn residual(self, shift: f32, _: f32) -> f32 {
        self - shift
    }

    #[inline]
    fn widen(self) -> f32 {
        self
    }

    #[inline]
    fn restore(self, sum: f32) -> f32 {
        self + sum
    }
}

impl Residual for f32 {
    const ZERO: f32 = 0.0;
    const IS_EXACT: bool = false;

    type Sum = f32;
    type Ratio = f32;

    #[inline]
    fn plus(self, other: f32) -> f32 {
        self + other
    }

    #[inline]
    fn minus(self, other: f32) -> f32 {
        self - other
    }

    #[inline]
    fn no_sum() -> f32 {
        0.0
    }

    #[inline]
    fn add_distance(self, other: f32, sum: f32) -> f32 {
        sum + (self - other).abs()
    }

    #[inline]
    fn ratio(value: f32) -> f32 {
        value
    }

    #[inline]
    fn at_most(left: f32, right: f32, ratio: f32) -> bool {
        left <= right * ratio
    }
}

/// Sums and differences of two residuals never overflow: `Rated::residual` leaves room for all taps.
/// `wrapping` says so to the compiler.
impl Residual for i32 {
    const ZERO: i32 = 0;
    const IS_EXACT: bool = true;

    type Sum = i64;
    type Ratio = u16;

    #[inline]
    fn plus(self, other: i32) -> i32 {
        self.wrapping_add(other)
    }

    #[inline]
    fn minus(self, other: i32) -> i32 {
        self.wrapping_sub(other)
    }

    #[inline]
    fn no_sum() -> i64 {
        0
    }

    #[inline]
    fn add_distance(self, other: i32, sum: i64) -> i64 {
        sum + i64::from(self.abs_diff(other))
    }

    #[inline]
    fn ratio(value: f32) -> u16 {
        (value * 16_384.0 + 0.5) as u16
    }

    #[inline]
    fn at_most(left: i64, right: i64, ratio: u16) -> bool {
        left << 14 <= right * i64::from(ratio)
    }
}

macro_rules! integer_rated {
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path, $($conversions:tt)*) => {
        impl<$($generics)*> Rated for $sample {
            type Residual = i32;

            #[inline]
            fn residual(self, shift: Self, _: Self) -> i32 {
                i32::from($to_bits(self)) - i32::from($to_bits(shift))
            }

            #[inline]
            fn widen(self) -> i32 {
                i32::from($to_bits(self))
            }

            #[inline]
            fn restore(self, sum: i32) -> Self {
                // No filter of 4096 taps of 16 bits overflows.
                let value = i32::from($to_bits(self)).wrapping_add(sum);
                $from_bits(value.clamp(i16::MIN.into(), i16::MAX.into()) as i16)
            }
        }
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path, $($conversions:tt)*) => {
        impl<$($generics)*> Rated for $sample {
            type Residual = i32;

            #[inline]
            fn residual(self, shift: Self, magnitude: Self) -> i32 {
                let limit = i32::MAX - $to_bits(magnitude);
                $to_bits(self).saturating_sub($to_bits(shift)).max(-limit).min(limit)
            }

            #[inline]
            fn widen(self) -> i32 {
                $to_bits(self)
            }

            #[inline]
            fn restore(self, sum: i32) -> Self {
                $from_bits($to_bits(self).saturating_add(sum))
            }
        }
    };
}
for_each_integer!(integer_rated);
