//! Arithmetic of the temporal codes: a step up, a step down, and the comparison with a threshold.

use core::cmp::Ordering;

use super::HAS_VECTORS;

/// Steps and comparisons: one rounding in `f32`; exact and saturating in fixed point.
pub(crate) trait Arithmetic: Sized {
    const ZERO: Self;

    /// The baseline before the first sample: in `f32` NaN, which lies near no sample; in fixed point a value that may also
    /// be a true baseline, which then costs a little more. In 16 bits it is not 0, where coarse samples rest.
    const NO_BASELINE: Self;

    /// A bound of a band: of 16 bits in 32, where it needs not saturate.
    type Bound: Copy + PartialOrd;

    fn bound(self) -> Self::Bound;

    /// The sample at a bound that another sample has passed.
    fn of_bound(bound: Self::Bound) -> Self;

    /// A sum of steps in a register. A Cortex-M0, which has no 16-bit arithmetic, keeps 16 bits in the upper half of a
    /// word, where they saturate as 32 do.
    type Level: Copy;

    fn level(self) -> Self::Level;

    fn of_level(level: Self::Level) -> Self;

    fn climb(level: Self::Level, step: Self::Level) -> Self::Level;

    /// The bounds one threshold below and above.
    fn bounds(around: Self::Bound, threshold: Self::Bound) -> [Self::Bound; 2];

    fn is_finite(&self) -> bool;

    /// A check over a slice's samples, including this one. If the last check is finite, so was every sample: one test
    /// at the end replaces one a sample. Fixed point, which is always finite, returns `self`.
    fn including(self, sample: Self) -> Self;

    /// `self + step`.
    fn plus(self, step: Self) -> Self;

    /// `self - step`.
    fn minus(self, step: Self) -> Self;

    /// `-self`, for a step above 0.
    fn negated(self) -> Self;

    /// `self * 2^times`, for results that the type holds.
    fn doubled(self, times: u8) -> Self;

    /// Compares `self - previous` with the threshold: `Greater` above it, `Less` below its negative, else `Equal`.
    fn step(self, previous: Self::Bound, threshold: Self::Bound) -> Ordering;
}

impl Arithmetic for f32 {
    const ZERO: Self = 0.0;

    const NO_BASELINE: Self = f32::NAN;

    type Bound = f32;

    #[inline]
    fn bound(self) -> f32 {
        self
    }

    #[inline]
    fn of_bound(bound: f32) -> f32 {
        bound
    }

    type Level = f32;

    #[inline]
    fn level(self) -> f32 {
        self
    }

    #[inline]
    fn of_level(level: f32) -> f32 {
        level
    }

    #[inline]
    fn climb(level: f32, step: f32) -> f32 {
        level + step
    }

    #[inline]
    fn bounds(around: f32, threshold: f32) -> [f32; 2] {
        [around - threshold, around + threshold]
    }

    #[inline]
    fn is_finite(&self) -> bool {
        f32::is_finite(*self)
    }

    #[inline]
    fn including(self, sample: Self) -> Self {
        check(self, sample)
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
    fn negated(self) -> Self {
        -self
    }

    #[inline]
    fn doubled(self, times: u8) -> Self {
        self * f32::from_bits(u32::from(times).wrapping_add(127) << 23)
    }

    #[inline]
    fn step(self, previous: f32, threshold: f32) -> Ordering {
        beyond(self - previous, magnitude(threshold))
    }
}

/// A float that is finite only if both the check so far and the value are. Their sum takes one instruction; but every
/// sum waits for the one before it, so that a core with vectors collects bits instead, which it may do in any order.
#[inline]
pub(super) fn check(check: f32, value: f32) -> f32 {
    if HAS_VECTORS {
        // NaN unless the value is finite.
        let zero = value * 0.0;
        f32::from_bits(check.to_bits() | zero.to_bits())
    } else {
        check + value
    }
}

/// An integer that orders floats by their absolute value.
#[inline]
pub(super) const fn magnitude(value: f32) -> u32 {
    value.to_bits() << 1
}

/// Compares a difference, which is not NaN, with the [`magnitude`] of a threshold: `Greater` above it, `Less` below
/// its negative, else `Equal`.
#[inline]
pub(super) fn beyond(difference: f32, threshold: u32) -> Ordering {
    if magnitude(difference) <= threshold {
        Ordering::Equal
    } else if difference.is_sign_positive() {
        Ordering::Greater
    } else {
        Ordering::Less
    }
}

/// Calls a macro once for each integer type with its generics, its raw integer, and the conversions
/// between the two.
macro_rules! for_each_integer {
    ($callback:ident) => {
        $callback! { [] i16, i16, core::convert::identity, core::convert::identity }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU16 + 'static] fixed::FixedI16<Frac>, i16,
        fixed::FixedI16::to_bits, fixed::FixedI16::from_bits }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU32 + 'static] fixed::FixedI32<Frac>, i32,
        fixed::FixedI32::to_bits, fixed::FixedI32::from_bits }
    };
}
pub(super) use for_each_integer;

/// The register of a 16-bit level, and how far up the level lies in it: in the upper half of a word on a Cortex-M0, the
/// only core without compare-and-swap. `without_vectors` tests that form on the host.
#[cfg(not(any(without_vectors, all(target_arch = "arm", not(target_has_atomic = "32")))))]
type Half = i16;
#[cfg(any(without_vectors, all(target_arch = "arm", not(target_has_atomic = "32"))))]
type Half = i32;
const UP: u32 = Half::BITS - i16::BITS;

macro_rules! integer_arithmetic {
    ([$($generics:tt)*] $sample:ty, i16, $($paths:tt)*) => {
        integer_arithmetic! { @ [$($generics)*] $sample, i16, Half, UP, $($paths)* }
    };
    ([$($generics:tt)*] $sample:ty, i32, $($paths:tt)*) => {
        integer_arithmetic! { @ [$($generics)*] $sample, i32, i32, 0, $($paths)* }
    };
    (@ [$($generics:tt)*] $sample:ty, $bits:ty, $level:ty, $up:expr, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Arithmetic for $sample {
            const ZERO: Self = $from_bits(0);

            const NO_BASELINE: Self = $from_bits(if <$bits>::BITS == 16 { <$bits>::MIN } else { 0 });

            type Bound = i32;

            #[inline]
            fn bound(self) -> i32 {
                i32::from($to_bits(self))
            }

            #[inline]
            fn of_bound(bound: i32) -> Self {
                $from_bits(bound as $bits)
            }

            type Level = $level;

            #[inline]
            fn level(self) -> Self::Level {
                Self::Level::from($to_bits(self)) << $up
            }

            #[inline]
            fn of_level(level: Self::Level) -> Self {
                $from_bits((level >> $up) as $bits)
            }

            #[inline]
            fn climb(level: Self::Level, step: Self::Level) -> Self::Level {
                level.saturating_add(step)
            }

            // A bound that saturates is an end of the type: no sample lies beyond it, nor beyond the exact bound.
            #[inline]
            fn bounds(around: i32, threshold: i32) -> [i32; 2] {
                if <$bits>::BITS == 16 {
                    [around.wrapping_sub(threshold), around.wrapping_add(threshold)]
                } else {
                    [around.saturating_sub(threshold), around.saturating_add(threshold)]
                }
            }

            #[inline]
            fn is_finite(&self) -> bool {
                true
            }

            #[inline]
            fn including(self, _: Self) -> Self {
                self
            }

            #[inline]
            fn plus(self, step: Self) -> Self {
                Self::of_level(Self::climb(self.level(), step.level()))
            }

            #[inline]
            fn minus(self, step: Self) -> Self {
                Self::of_level(self.level().saturating_sub(step.level()))
            }

            #[inline]
            fn negated(self) -> Self {
                self.wrapping_neg()
            }

            #[inline]
            fn doubled(self, times: u8) -> Self {
                self.wrapping_shl(times.into())
            }

            #[inline]
            fn step(self, previous: i32, threshold: i32) -> Ordering {
                let [sample, lower, upper] = if <$bits>::BITS == 16 {
                    let change = self.bound().wrapping_sub(previous);
                    [change, threshold.wrapping_neg(), threshold]
                } else {
                    let [lower, upper] = Self::bounds(previous, threshold);
                    [self.bound(), lower, upper]
                };
                if sample > upper {
                    Ordering::Greater
                } else if sample < lower {
                    Ordering::Less
                } else {
                    Ordering::Equal
                }
            }
        }
    };
}
for_each_integer!(integer_arithmetic);
