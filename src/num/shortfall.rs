//! Arithmetic of T-HSA: by how much residuals fall short of their taps.

// A decision and the subtraction after it share what they load only where both are inlined.
#![allow(clippy::inline_always)]

/// Sums up `max(0, tap - residual)` over pairs.
pub(crate) trait Shortfall: Sized {
    /// Whether the sum over residuals, each with its tap, is at most the threshold.
    fn falls_short_by_at_most(threshold: Self, pairs: impl Iterator<Item = (Self, Self)>) -> bool;

    /// As [`falls_short_by_at_most`](Self::falls_short_by_at_most), with the pairs in any order; `None` if
    /// the order decides.
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
        // The sum only grows. It is compared every fourth pair.
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

    /// Two orders of at most 4096 terms, none negative, make sums that differ by less than 2⁻¹⁰ of
    /// them. Where the limit is farther away than that, either order decides alike.
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
