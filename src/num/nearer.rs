//! Arithmetic of BSA: whether taps bring residuals nearer to zero.

// A decision and the subtraction after it share what they load only where both are inlined.
#![allow(clippy::inline_always)]

use super::Ratio;

/// Compares `e1 = sum |residual - tap|` with `e2 = sum |residual|` over pairs of a residual and its tap.
pub(crate) trait Nearer: Sized {
    /// A sum of magnitudes.
    type Sum;

    /// The sum of `|residual - other|` over pairs, in 32 bits for up to `short` pairs.
    fn distance(short: usize, pairs: impl Iterator<Item = (Self, Self)>) -> Self::Sum;

    /// `left <= right * ratio`.
    fn at_most(left: Self::Sum, right: Self::Sum, ratio: Ratio) -> bool;

    /// Whether `e1` is within the bound, so that subtracting the taps brings the residuals nearer to zero.
    /// `magnitude` is the sum of the taps' magnitudes over the pairs; the sums of up to `short` pairs fit 32 bits.
    fn is_nearer(
        bound: Bound<Self>,
        short: usize,
        magnitude: Self,
        pairs: impl Iterator<Item = (Self, Self)>,
    ) -> bool;
}

/// The largest `e1` at which the filter fires.
#[derive(Clone, Copy)]
pub(crate) enum Bound<R> {
    /// `e2` minus this threshold.
    Less(R),
    /// `e2` times this ratio.
    Part(Ratio),
}

impl Nearer for f32 {
    type Sum = f32;

    #[inline]
    fn distance(_: usize, pairs: impl Iterator<Item = (f32, f32)>) -> f32 {
        pairs.fold(0.0, |sum, (residual, other)| sum + (residual - other).abs())
    }

    #[inline]
    fn at_most(left: f32, right: f32, ratio: Ratio) -> bool {
        left <= right * ratio.float
    }

    #[inline(always)]
    fn is_nearer(
        bound: Bound<f32>,
        _: usize,
        _: f32,
        pairs: impl Iterator<Item = (f32, f32)>,
    ) -> bool {
        let (mut with, mut without) = (0.0, 0.0);
        for (residual, tap) in pairs {
            with += (residual - tap).abs();
            without += residual.abs();
        }
        match bound {
            Bound::Less(threshold) => with - without <= -threshold,
            Bound::Part(ratio) => f32::at_most(with, without, ratio),
        }
    }
}

/// Whether these are up to `short` pairs; where a filter's length is a constant, so is the answer.
#[inline(always)]
fn are_short(pairs: &impl Iterator, short: usize) -> bool {
    pairs.size_hint().1.is_some_and(|count| count <= short)
}

impl Nearer for i32 {
    type Sum = i64;

    #[inline]
    fn distance(short: usize, pairs: impl Iterator<Item = (i32, i32)>) -> i64 {
        if are_short(&pairs, short) {
            pairs.fold(0_u32, |sum, (r, other)| sum.wrapping_add(r.abs_diff(other))).into()
        } else {
            pairs.fold(0, |sum, (r, other)| i64::from(r.abs_diff(other)).wrapping_add(sum))
        }
    }

    #[inline]
    fn at_most(left: i64, right: i64, ratio: Ratio) -> bool {
        left << 14 <= right.wrapping_mul(ratio.fixed.into())
    }

    #[inline(always)]
    fn is_nearer(
        bound: Bound<i32>,
        short: usize,
        magnitude: i32,
        pairs: impl Iterator<Item = (i32, i32)>,
    ) -> bool {
        match bound {
            // No pair lowers `e1 - e2 + sum |tap|`, so that the loop ends once that sum exceeds its limit. For a tap
            // `h >= 0`, the pair adds `|r - h| - |r| + |h| = 2 max(0, h - max(0, r))`.
            Bound::Less(threshold) => {
                let mut left = magnitude.wrapping_sub(threshold) >> 1;
                for (residual, tap) in pairs {
                    // One comparison for `tap >= 0 && residual >= tap`.
                    if residual.wrapping_sub(tap) | tap >= 0 {
                        continue;
                    }
                    let residual = if tap < 0 { residual.wrapping_neg() } else { residual };
                    let lack = tap.wrapping_abs().wrapping_sub(residual.max(0));
                    left = left.wrapping_sub(lack.max(0));
                    if left < 0 {
                        return false;
                    }
                }
                left >= 0
            }
            Bound::Part(ratio) if are_short(&pairs, short) => {
                let (mut with, mut without) = (0_u32, 0_u32);
                for (residual, tap) in pairs {
                    with = with.wrapping_add(residual.abs_diff(tap));
                    without = without.wrapping_add(residual.unsigned_abs());
                }
                i32::at_most(with.into(), without.into(), ratio)
            }
            Bound::Part(ratio) => {
                let (mut with, mut without) = (0_i64, 0_i64);
                for (residual, tap) in pairs {
                    with = with.wrapping_add(residual.abs_diff(tap).into());
                    without = without.wrapping_add(residual.unsigned_abs().into());
                }
                i32::at_most(with, without, ratio)
            }
        }
    }
}
