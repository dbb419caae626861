//! Binary search in a number of steps that depends only on the length.

/// How many indices below `length` are such that `precedes` is true; they must come before all others.
#[inline]
pub(in crate::scheme) fn count_preceding(length: usize, precedes: impl Fn(usize) -> bool) -> usize {
    let mut preceding = 0;
    let mut possible = length + 1;
    while possible > 1 {
        let half = possible / 2;
        if precedes(preceding + half - 1) {
            preceding += half;
        }
        possible -= half;
    }
    preceding
}
