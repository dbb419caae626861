//! Arithmetic of BSA: whether taps bring residuals nearer to zero.

// A decision and the subtraction after it share what they load only where both are inlined.
#![allow(clippy::inline_always)]

use super::Ratio;

/// Compares `e1 = sum |residual - tap|` with `e2 = sum |residual|` over pairs of a residual and its tap.
pub(crate) trait Nearer: Sized {
    /// A sum of magnitudes.
    type Sum: Copy + core::fmt::Debug + Send + Sync;

    const EMPTY: Self::Sum;

    /// `sum + |self - other|`.
    fn add_distance(self, other: Self, sum: Self::Sum) -> Self::Sum;

    /// `left <= right * ratio`.
    fn at_most(left: Self::Sum, right: Self::Sum, ratio: Ratio) -> bool;

    /// Whether `e1` is within the bound, so that subtracting the taps brings the residuals nearer to zero.
    /// `magnitude` is the sum of the taps' magnitudes over the pairs.
    fn is_nearer(
        bound: Bound<Self>,
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

    const EMPTY: f32 = 0.0;

    #[inline(always)]
    fn add_distance(self, other: f32, sum: f32) -> f32 {
        sum + (self - other).abs()
    }

    #[inline]
    fn at_most(left: f32, right: f32, ratio: Ratio) -> bool {
        left <= right * ratio.float
    }

    #[inline(always)]
    fn is_nearer(bound: Bound<f32>, _: f32, pairs: impl Iterator<Item = (f32, f32)>) -> bool {
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

impl Nearer for i32 {
    type Sum = i64;

    const EMPTY: i64 = 0;

    #[inline(always)]
    fn add_distance(self, other: i32, sum: i64) -> i64 {
        sum.wrapping_add(i64::from(self.abs_diff(other)))
    }

    #[inline]
    fn at_most(left: i64, right: i64, ratio: Ratio) -> bool {
        left << 14 <= right.wrapping_mul(ratio.fixed.into())
    }

    #[inline(always)]
    fn is_nearer(
        bound: Bound<i32>,
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
            Bound::Part(ratio) => {
                let (mut with, mut without) = (i32::EMPTY, i32::EMPTY);
                for (residual, tap) in pairs {
                    with = residual.add_distance(tap, with);
                    without = residual.add_distance(0, without);
                }
                i32::at_most(with, without, ratio)
            }
        }
    }
}
