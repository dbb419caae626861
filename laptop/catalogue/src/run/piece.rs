//! Samples that are coded in one piece, of which a part is scored.

use std::ops::Range;

/// Consecutive samples that are coded in one piece, and the ranges of them that are scored.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    /// The samples.
    pub values: &'a [f64],
    /// Index ranges of the samples that are scored, in order and disjoint.
    pub scored: &'a [Range<usize>],
}

impl Piece<'_> {
    /// Returns, for each sample, whether it is scored.
    pub fn mask(&self) -> Vec<bool> {
        let mut mask = vec![false; self.values.len()];
        for range in self.scored {
            mask.get_mut(range.clone()).into_iter().flatten().for_each(|own| *own = true);
        }
        mask
    }
}
