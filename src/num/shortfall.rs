//! Arithmetic of T-HSA: by how much residuals fall short of their taps.

// A decision and the subtraction after it share what they load only where both are inlined.
#![allow(clippy::inline_always)]

/// Compares the shortfall, the sum of `max(0, tap - residual)` over pairs, with a threshold.
pub(crate) trait Shortfall: Sized {
    /// Whether the shortfall over pairs of a residual and its tap is at most the threshold.
    fn falls_short_by_at_most(threshold: Self, pairs: impl Iterator<Item = (Self, Self)>) -> bool;

    /// [`falls_short_by_at_most`](Self::falls_short_by_at_most) with the pairs in any order; `None` if the result
    /// depends on the order.
    fn falls_short_in_any_order(
        threshold: Self,
        pairs: impl Iterator<Item = (Self, Self)>,
    ) -> Option<bool>;
}

/// Twice the shortfall, first pair first; `None` if it is more than `most`.
#[inline(always)]
fn twice_shortfall(most: f32, pairs: impl Iterator<Item = (f32, f32)>) -> Option<f32> {
    let mut sum = 0.0;
    let mut count = 0_usize;
    for (residual, tap) in pairs {
        let left = residual - tap;
        sum += left.abs() - left;
        // The sum never shrinks, so that a comparison every fourth pair is enough.
        if count % 4 == 3 && sum > most {
            return None;
        }
        count = count.wrapping_add(1);
    }
    (sum <= most).then_some(sum)
}

impl Shortfall for f32 {
    #[inline(always)]
    fn falls_short_by_at_most(threshold: f32, pairs: impl Iterator<Item = (f32, f32)>) -> bool {
        twice_shortfall(threshold + threshold, pairs).is_some()
    }

    /// Adding at most 4096 terms of 0 or more in another order changes their sum by less than 2⁻¹⁰ of it. If the
    /// limit is farther away than that, every order gives one result.
    #[inline(always)]
    fn falls_short_in_any_order(
        threshold: f32,
        pairs: impl Iterator<Item = (f32, f32)>,
    ) -> Option<bool> {
        const ABOVE: f32 = 1.0 + 1.0 / 1024.0;
        let most = threshold + threshold;
        match twice_shortfall(most * ABOVE, pairs) {
            None => Some(false),
            Some(sum) => (sum * ABOVE <= most).then_some(true),
        }
    }
}

impl Shortfall for i32 {
    #[inline(always)]
    fn falls_short_by_at_most(threshold: i32, pairs: impl Iterator<Item = (i32, i32)>) -> bool {
        let mut left = threshold.unsigned_abs();
        for (residual, tap) in pairs {
            if residual < tap {
                let shortfall = tap.abs_diff(residual);
                if shortfall > left {
                    return false;
                }
                left -= shortfall;
            }
        }
        true
    }

    #[inline(always)]
    fn falls_short_in_any_order(
        threshold: i32,
        pairs: impl Iterator<Item = (i32, i32)>,
    ) -> Option<bool> {
        Some(i32::falls_short_by_at_most(threshold, pairs))
    }
}
