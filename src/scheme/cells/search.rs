//! Binary search in a number of steps that depends only on the length.

/// How many indices below `length` are such that `precedes` is true; they must come before all others.
#[inline]
pub(in crate::scheme) fn count_preceding(length: usize, precedes: impl Fn(usize) -> bool) -> usize {
    let mut preceding = 0_usize;
    let mut possible = length.wrapping_add(1);
    while possible > 1 {
        let half = possible / 2;
        if precedes(preceding.wrapping_add(half).wrapping_sub(1)) {
            preceding = preceding.wrapping_add(half);
        }
        possible = possible.wrapping_sub(half);
    }
    preceding
}
