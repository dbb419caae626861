//! Arithmetic of the rate codes: what is left of a signal after the filters of its spikes are subtracted.

use bytemuck::Pod;

use super::arithmetic::for_each_integer;
use super::{Nearer, Shortfall, Stored};

/// Turns samples into residuals and back.
pub(crate) trait Rated: Sized {
    type Residual: Residual;

    /// Largest number of pairs whose sum of `|residual - tap|` fits 32 bits. In 16 bits a distance is at most 2¹⁶ plus the
    /// taps' magnitudes: for 256 taps, 2¹⁶ + 2²³, and 256 of these are below 2³².
    const SHORT: usize = 0;

    /// `self - shift`. 32-bit fixed point is clamped so that no subtraction of taps overflows; `magnitude` is the
    /// sum of the taps' magnitudes.
    fn residual(self, shift: Self, magnitude: Self::Residual) -> Self::Residual;

    /// A tap or a threshold, in the residual's unit.
    fn widen(self) -> Self::Residual;

    /// `self + sum`, saturating; `self` is the shift.
    fn restore(self, sum: Self::Residual) -> Self;
}

/// Residuals: `f32`, or exact 32-bit integers.
pub(crate) trait Residual:
    Copy + PartialOrd + Pod + Send + Sync + core::fmt::Debug + Shortfall + Nearer + Stored
{
    const ZERO: Self;

    /// Whether sums are exact, so that their order does not matter.
    const IS_EXACT: bool;

    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;

    /// The residual where the bits of `mask` are all 1, 0 where they are all 0.
    fn masked(self, mask: u32) -> Self;
}

/// The factor of BSA's multiplicative rule: as given for `f32`, with 14 fraction bits for integers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Ratio {
    pub(super) float: f32,
    pub(super) fixed: u16,
}

impl Ratio {
    /// A factor of 2⁻¹⁴ to 4 - 2⁻¹⁴.
    pub(crate) const fn new(factor: f32) -> Self {
        Self { float: factor, fixed: (factor * 16_384.0 + 0.5) as u16 }
    }

    /// The factor as it was given.
    pub(crate) const fn factor(self) -> f32 {
        self.float
    }
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

    #[inline]
    fn plus(self, other: f32) -> f32 {
        self + other
    }

    #[inline]
    fn minus(self, other: f32) -> f32 {
        self - other
    }

    #[inline]
    fn masked(self, mask: u32) -> f32 {
        f32::from_bits(self.to_bits() & mask)
    }
}

/// Sums and differences of two residuals never overflow, since `Rated::residual` leaves room for all taps: hence
/// `wrapping`.
impl Residual for i32 {
    const ZERO: i32 = 0;
    const IS_EXACT: bool = true;

    #[inline]
    fn plus(self, other: i32) -> i32 {
        self.wrapping_add(other)
    }

    #[inline]
    fn minus(self, other: i32) -> i32 {
        self.wrapping_sub(other)
    }

    #[inline]
    fn masked(self, mask: u32) -> i32 {
        self & mask.cast_signed()
    }
}

macro_rules! integer_rated {
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Rated for $sample {
            type Residual = i32;

            const SHORT: usize = 256;

            #[inline]
            fn residual(self, shift: Self, _: i32) -> i32 {
                i32::from($to_bits(self)) - i32::from($to_bits(shift))
            }

            #[inline]
            fn widen(self) -> i32 {
                i32::from($to_bits(self))
            }

            #[inline]
            fn restore(self, sum: i32) -> Self {
                // The sum of 4096 taps of 16 bits fits 32.
                let value = i32::from($to_bits(self)).wrapping_add(sum);
                $from_bits(value.clamp(i16::MIN.into(), i16::MAX.into()) as i16)
            }
        }
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Rated for $sample {
            type Residual = i32;

            #[inline]
            fn residual(self, shift: Self, magnitude: i32) -> i32 {
                let limit = i32::MAX.wrapping_sub(magnitude);
                $to_bits(self).saturating_sub($to_bits(shift)).max(limit.wrapping_neg()).min(limit)
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

/// The factor as it was given.
#[cfg(feature = "serde")]
impl serde::Serialize for Ratio {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_f32(self.float)
    }
}
