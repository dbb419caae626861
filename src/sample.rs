//! The numbers that encoders work on.

use core::fmt::Debug;

#[cfg(feature = "fixed")]
use fixed::{
    FixedI16, FixedI32,
    types::extra::{LeEqU16, LeEqU32},
};

use crate::Spike;
use crate::population::Spaced;
use crate::rate::Rated;
use crate::temporal::Windowed;

/// A number that comes from a sensor: `f32`, raw `i16` counts, or, with the feature `fixed`,
/// `FixedI16` and `FixedI32` with any fraction.
///
/// - `f32` uses only `+ - * /` and comparisons in a documented order, so that every machine gives
///   the same bits.
/// - Fixed point and counts are exact: the spikes are those of exact arithmetic on the same
///   samples. Values that leave the range of the type saturate.
///
/// The trait is sealed.
pub trait Sample:
    Copy + PartialOrd + Default + Debug + Arithmetic + Windowed + Rated + Spaced + 'static
{
    /// The value as a double, exactly. For set-up, not for the hot path.
    fn to_f64(self) -> f64;

    /// The nearest value of this type, halves upwards, saturating; NaN gives 0 in fixed point.
    /// For set-up, not for the hot path.
    fn from_f64(value: f64) -> Self;

    /// The largest value of this type that is not above `value`, saturating.
    #[doc(hidden)]
    fn floor_from_f64(value: f64) -> Self;
}

/// Arithmetic of the step codes. Sealed: only this crate can name it.
pub trait Arithmetic: Sized {
    const ZERO: Self;

    fn is_finite(&self) -> bool;

    /// Takes up a sample, so that whether all of a slice were finite can be asked once at its end: a
    /// sum in `f32`, which no later sample makes finite again; nothing in fixed point.
    fn taint(self, sample: Self) -> Self;

    /// `self + step`: rounded once in `f32`, saturating in fixed point.
    fn plus(self, step: Self) -> Self;

    /// `self - step`: rounded once in `f32`, saturating in fixed point.
    fn minus(self, step: Self) -> Self;

    /// The step from `previous`: its difference rounded once in `f32`, exact in fixed point.
    fn step(self, previous: Self, threshold: Self) -> Spike;
}

impl Arithmetic for f32 {
    const ZERO: Self = 0.0;

    #[inline]
    fn is_finite(&self) -> bool {
        f32::is_finite(*self)
    }

    #[inline]
    fn taint(self, sample: Self) -> Self {
        self + sample
    }

    #[inline]
    fn plus(self, step: Self) -> Self {
        self + step
    }

    #[inline]
    fn minus(self, step: Self) -> Self {
        self - step
    }

    #[inline]
    fn step(self, previous: Self, threshold: Self) -> Spike {
        judge(self - previous, magnitude(threshold))
    }
}

/// In the order of the values without their sign.
#[inline]
pub(crate) const fn magnitude(value: f32) -> u32 {
    value.to_bits() << 1
}

/// The spike of a difference that is not NaN, against the magnitude of a threshold.
#[inline]
pub(crate) fn judge(difference: f32, threshold: u32) -> Spike {
    if magnitude(difference) <= threshold {
        Spike::None
    } else if difference.is_sign_positive() {
        Spike::Up
    } else {
        Spike::Down
    }
}

impl Sample for f32 {
    fn to_f64(self) -> f64 {
        f32_to_f64(self)
    }

    fn from_f64(value: f64) -> Self {
        f32_nearest(value)
    }

    fn floor_from_f64(value: f64) -> Self {
        f32_floor(value)
    }
}

/// Calls a macro once for each integer type with its generics, its raw integer, the conversions
/// between the two, and the set-up conversions.
macro_rules! for_each_integer {
    ($callback:ident) => {
        $callback! { [] i16, i16, core::convert::identity, core::convert::identity,
            $crate::sample::i16_to_f64, $crate::sample::i16_nearest, $crate::sample::i16_floor }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU16 + 'static] fixed::FixedI16<Frac>, i16,
            fixed::FixedI16::to_bits, fixed::FixedI16::from_bits,
            $crate::sample::fixed16_to_f64, $crate::sample::fixed16_nearest, $crate::sample::fixed16_floor }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU32 + 'static] fixed::FixedI32<Frac>, i32,
            fixed::FixedI32::to_bits, fixed::FixedI32::from_bits,
            $crate::sample::fixed32_to_f64, $crate::sample::fixed32_nearest, $crate::sample::fixed32_floor }
    };
}
pub(crate) use for_each_integer;

/// Calls a macro once for each sample type with its generics and the set-up conversions, so that
/// constructors can be `const fn`, which trait methods cannot be.
macro_rules! for_each_sample {
    ($callback:ident) => {
        $callback! { [] f32,
            $crate::sample::f32_to_f64, $crate::sample::f32_nearest, $crate::sample::f32_floor }
        $callback! { [] i16,
            $crate::sample::i16_to_f64, $crate::sample::i16_nearest, $crate::sample::i16_floor }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU16] fixed::FixedI16<Frac>,
            $crate::sample::fixed16_to_f64, $crate::sample::fixed16_nearest, $crate::sample::fixed16_floor }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU32] fixed::FixedI32<Frac>,
            $crate::sample::fixed32_to_f64, $crate::sample::fixed32_nearest, $crate::sample::fixed32_floor }
    };
}
pub(crate) use for_each_sample;

macro_rules! integer_sample {
    ([$($generics:tt)*] $sample:ty, $bits:ty, $to_bits:path, $from_bits:path,
     $to_f64:path, $nearest:path, $floor:path) => {
        impl<$($generics)*> Arithmetic for $sample {
            const ZERO: Self = $from_bits(0);

            #[inline]
            fn is_finite(&self) -> bool {
                true
            }

            #[inline]
            fn taint(self, _: Self) -> Self {
                self
            }

            #[inline]
            fn plus(self, step: Self) -> Self {
                self.saturating_add(step)
            }

            #[inline]
            fn minus(self, step: Self) -> Self {
                self.saturating_sub(step)
            }

            // No sample lies beyond a saturated bound, nor would it beyond the exact one.
            #[inline]
            fn step(self, previous: Self, threshold: Self) -> Spike {
                if self > previous.saturating_add(threshold) {
                    Spike::Up
                } else if self < previous.saturating_sub(threshold) {
                    Spike::Down
                } else {
                    Spike::None
                }
            }
        }

        impl<$($generics)*> Sample for $sample {
            fn to_f64(self) -> f64 {
                $to_f64(self)
            }

            fn from_f64(value: f64) -> Self {
                $nearest(value)
            }

            fn floor_from_f64(value: f64) -> Self {
                $floor(value)
            }
        }
    };
}
for_each_integer!(integer_sample);

pub(crate) const fn f32_to_f64(value: f32) -> f64 {
    value as f64
}

pub(crate) const fn f32_nearest(value: f64) -> f32 {
    value as f32
}

pub(crate) const fn f32_floor(value: f64) -> f32 {
    let nearest = value as f32;
    if nearest as f64 > value { nearest.next_down() } else { nearest }
}

pub(crate) const fn i16_to_f64(value: i16) -> f64 {
    value as f64
}

pub(crate) const fn i16_nearest(value: f64) -> i16 {
    clamp_i16(round(value))
}

pub(crate) const fn i16_floor(value: f64) -> i16 {
    clamp_i16(floor(value))
}

#[cfg(feature = "fixed")]
pub(crate) const fn fixed16_to_f64<Frac: LeEqU16>(value: FixedI16<Frac>) -> f64 {
    value.to_bits() as f64 / power_of_two(FixedI16::<Frac>::FRAC_NBITS)
}

#[cfg(feature = "fixed")]
pub(crate) const fn fixed16_nearest<Frac: LeEqU16>(value: f64) -> FixedI16<Frac> {
    FixedI16::from_bits(clamp_i16(round(value * power_of_two(FixedI16::<Frac>::FRAC_NBITS))))
}

#[cfg(feature = "fixed")]
pub(crate) const fn fixed16_floor<Frac: LeEqU16>(value: f64) -> FixedI16<Frac> {
    FixedI16::from_bits(clamp_i16(floor(value * power_of_two(FixedI16::<Frac>::FRAC_NBITS))))
}

#[cfg(feature = "fixed")]
pub(crate) const fn fixed32_to_f64<Frac: LeEqU32>(value: FixedI32<Frac>) -> f64 {
    value.to_bits() as f64 / power_of_two(FixedI32::<Frac>::FRAC_NBITS)
}

#[cfg(feature = "fixed")]
pub(crate) const fn fixed32_nearest<Frac: LeEqU32>(value: f64) -> FixedI32<Frac> {
    FixedI32::from_bits(clamp_i32(round(value * power_of_two(FixedI32::<Frac>::FRAC_NBITS))))
}

#[cfg(feature = "fixed")]
pub(crate) const fn fixed32_floor<Frac: LeEqU32>(value: f64) -> FixedI32<Frac> {
    FixedI32::from_bits(clamp_i32(floor(value * power_of_two(FixedI32::<Frac>::FRAC_NBITS))))
}

#[cfg(feature = "fixed")]
const fn power_of_two(exponent: u32) -> f64 {
    (1_u64 << exponent) as f64
}

/// The nearest integer, halves upwards, saturating.
const fn round(value: f64) -> i64 {
    let towards_zero = value as i64;
    let rest = value - towards_zero as f64;
    if rest >= 0.5 {
        towards_zero.saturating_add(1)
    } else if rest < -0.5 {
        towards_zero.saturating_sub(1)
    } else {
        towards_zero
    }
}

/// The largest integer that is not above `value`, saturating.
pub(crate) const fn floor(value: f64) -> i64 {
    let towards_zero = value as i64;
    if (towards_zero as f64) > value { towards_zero.saturating_sub(1) } else { towards_zero }
}

const fn clamp_i16(value: i64) -> i16 {
    if value > i16::MAX as i64 {
        i16::MAX
    } else if value < i16::MIN as i64 {
        i16::MIN
    } else {
        value as i16
    }
}

#[cfg(feature = "fixed")]
const fn clamp_i32(value: i64) -> i32 {
    if value > i32::MAX as i64 {
        i32::MAX
    } else if value < i32::MIN as i64 {
        i32::MIN
    } else {
        value as i32
    }
}

/// Whether a first sample has been seen, and how many were rejected, times 2: four bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally(u32);

impl Tally {
    const PRIMED: u32 = 1;
    const ONE: u32 = 2;

    #[inline]
    pub(crate) fn is_primed(self) -> bool {
        self.0 & Self::PRIMED != 0
    }

    #[inline]
    pub(crate) fn prime(&mut self) {
        self.0 |= Self::PRIMED;
    }

    #[inline]
    pub(crate) fn reject(&mut self) {
        self.0 = self.0.checked_add(Self::ONE).unwrap_or(self.0);
    }

    #[inline]
    pub(crate) fn rejected(self) -> u32 {
        self.0 / Self::ONE
    }
}
