//! Binary search in a number of steps that depends on the length alone.

/// How many come before the first of `length` that does not precede, if all that precede come first.
#[inline]
pub(super) fn count_preceding(length: usize, precedes: impl Fn(usize) -> bool) -> usize {
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
