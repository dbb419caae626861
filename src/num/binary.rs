//! Arithmetic of the weighted phase code: a value's place in its range, in binary digits.

use super::Field;
use super::arithmetic::for_each_integer;

/// Fractions of a range in binary.
pub(crate) trait Binary: Sized {
    /// The first `count` binary digits of `(self - min) / (max - min)`, up to 16; all ones from `max` on.
    fn digits(self, min: Self, max: Self, count: u32) -> u32;

    /// The middle of the values with these digits.
    fn of_digits(digits: u32, count: u32, min: Self, max: Self) -> Self;

    /// The middle of two values, rounded down in fixed point and once in `f32`.
    fn middle(self, other: Self) -> Self;

    /// The largest value below this one; in `f32` this one itself, as cells there end where the next one starts.
    fn before(self) -> Self;
}

/// Ones in the last `count` places, up to 16.
#[inline]
const fn ones(count: u32) -> u32 {
    1_u32.wrapping_shl(count).wrapping_sub(1)
}

/// In a function of its own, or the usual path would compute it, too.
#[cold]
#[inline(never)]
fn add_halves(one: f32, other: f32) -> f32 {
    one * 0.5 + other * 0.5
}

/// The first `count` binary digits of `rest / range`, of which the rounded quotient is the whole number `rounded`.
#[cold]
#[inline(never)]
fn digits_at_an_edge(mut rest: f32, range: f32, count: u32, rounded: u32) -> u32 {
    // Dividing by a power of two does not round, unless the distance itself has been rounded up to the range.
    if is_power_of_two(range) && rounded >> (count & 31) == 0 {
        return rounded;
    }
    let mut digits = 0;
    for _ in 0..count {
        rest += rest;
        digits <<= 1;
        if rest >= range {
            rest -= range;
            digits |= 1;
        }
    }
    digits
}

/// Whether a number above 0 is a power of two, and not subnormal: it has no fraction. Also true of infinity.
#[inline]
const fn is_power_of_two(number: f32) -> bool {
    number.to_bits() << 9 == 0
}

impl Binary for f32 {
    /// Rounds `self - min` and `max - min` once each; the rest is exact.
    ///
    /// A rounded quotient has the digits of the exact one, unless it is their very number: the exact one may have been
    /// less.
    #[inline]
    fn digits(self, min: f32, max: f32, count: u32) -> u32 {
        if self >= max {
            return ones(count);
        }
        if self <= min {
            return 0;
        }
        let (rest, range) = (self - min, max - min);
        let place = rest / range * (1_u32 << (count & 31)) as f32;
        let digits = place as u32;
        if digits as f32 == place { digits_at_an_edge(rest, range, count, digits) } else { digits }
    }

    /// `min + (max - min) (2 digits + 1) / 2^(count + 1)`: the quotient is exact, the rest rounded once each.
    #[inline]
    fn of_digits(digits: u32, count: u32, min: f32, max: f32) -> f32 {
        let half = f32::from_bits((126_u32.wrapping_sub(count) & 0xff) << 23);
        min + (max - min) * ((2 * digits + 1) as f32 * half)
    }

    /// Half of the sum rounds once, as does the sum of halves where the sum is infinite.
    #[inline]
    fn middle(self, other: f32) -> f32 {
        let sum = self + other;
        if sum.is_finite() { sum * 0.5 } else { add_halves(self, other) }
    }

    #[inline]
    fn before(self) -> f32 {
        self
    }
}

/// The first `count` binary digits of `rest / range`, exactly; `rest` is less than `range`.
#[inline]
fn by_doubling(mut rest: u32, range: u32, count: u32) -> u32 {
    let mut digits = 0;
    for _ in 0..count {
        // Twice the rest may exceed 32 bits, so that the rest is compared with `range - rest`.
        let lacking = range.wrapping_sub(rest);
        digits <<= 1;
        if rest >= lacking {
            rest = rest.wrapping_sub(lacking);
            digits |= 1;
        } else {
            rest = rest.wrapping_add(rest);
        }
    }
    digits
}

/// [`by_doubling`] out of line, for ranges so wide that a division has no room for the digits.
#[cold]
#[inline(never)]
fn without_room(rest: u32, range: u32, count: u32) -> u32 {
    by_doubling(rest, range, count)
}

/// Whether the core calls the runtime to divide and to count leading zeros: an Arm core without compare-and-swap, as are
/// the Cortex-M0, M0+ and M1. `cargo verify scalar` tests its forms on the host: `--cfg without_vectors`.
pub(crate) const LACKS_DIVISION: bool =
    cfg!(any(without_vectors, all(target_arch = "arm", not(target_has_atomic = "32"))));

macro_rules! integer {
    // 16 digits of a range of 16 bits fit 32.
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path) => {
        integer!(@ [$($generics)*] $sample, i16, u32, $to_bits, $from_bits);
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path) => {
        integer!(@ [$($generics)*] $sample, i32, u64, $to_bits, $from_bits);
    };
    (@ [$($generics:tt)*] $sample:ty, $bits:ty, $wide:ty, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Binary for $sample {
            #[inline]
            fn digits(self, min: Self, max: Self, count: u32) -> u32 {
                if self >= max {
                    return ones(count);
                }
                let [value, min, max] = [self.max(min), min, max].map(|x| i32::from($to_bits(x)));
                let range = max.wrapping_sub(min).cast_unsigned();
                let rest = value.wrapping_sub(min).cast_unsigned();
                if LACKS_DIVISION {
                    by_doubling(rest, range, count)
                } else if <$bits>::BITS == 16 || range.leading_zeros() >= count {
                    (rest << (count & 31)).checked_div(range).unwrap_or(0)
                } else {
                    without_room(rest, range, count)
                }
            }

            #[inline]
            fn of_digits(digits: u32, count: u32, min: Self, max: Self) -> Self {
                let [low, high] = [min, max].map(|x| i32::from($to_bits(x)));
                let range = <$wide>::from(high.wrapping_sub(low).cast_unsigned());
                // How far above the minimum the first value with these digits is, and the first one after them.
                let above = range.wrapping_mul(digits.into()).wrapping_add(ones(count).into());
                let first = (above >> (count & 31)) as i32;
                let after = (above.wrapping_add(range) >> (count & 31)) as i32;
                let is_last = digits == ones(count);
                let middle = if <$bits>::BITS == 16 {
                    first.wrapping_add(after).wrapping_add(is_last.into()).wrapping_sub(1) >> 1
                } else {
                    let last = if is_last { range as i32 } else { after.wrapping_sub(1) };
                    first.wrapping_add(last.wrapping_sub(first) >> 1)
                };
                $from_bits(low.wrapping_add(middle) as $bits)
            }

            #[inline]
            fn middle(self, other: Self) -> Self {
                self.midway(other)
            }

            #[inline]
            fn before(self) -> Self {
                $from_bits($to_bits(self).wrapping_sub(1))
            }
        }
    };
}
for_each_integer!(integer);
