//! Partition: looks up the cell in which a value lies.

use super::count_preceding;
use crate::num::{EvenBins, bin_of, even_bins, from_f64, units};
use crate::{Fingerprint, Sample};

/// `C` cells that cover the line of values, 2 to 1024, each of which stands for a value.
///
/// A value belongs to the lowest cell whose edge it does not exceed, and above all edges to the last.
///
/// - **Memory:** the values, as many edges, `2 C` bytes for a table of even bins, and 8 bytes.
/// - **Work:** one multiplication finds the bin of a value, a table gives the lowest cell of that bin, and one
///   comparison with an edge decides between it and the next. A binary search takes their place where two edges
///   share a bin, as with logarithmic cells, Gaussian-spaced centres from about 140 on or the user's own, with
///   more than 256 cells, and for `f32` without a float unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(transparent, bound = "S: serde::Serialize")
)]
pub(in crate::scheme) struct Partition<S, const C: usize> {
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array::serialize"))]
    values: [S; C],
    /// `edges[c]` is the largest value that still belongs to cell `c`; the last is not used.
    #[cfg_attr(feature = "serde", serde(skip))]
    edges: [S; C],
    #[cfg_attr(feature = "serde", serde(skip))]
    bins: EvenBins,
    /// For each bin, the number (from 1) of the lowest cell to which one of its values belongs.
    #[cfg_attr(feature = "serde", serde(skip))]
    starts: [[u8; 2]; C],
}

/// The number (from 1) of the cell that a finite value belongs to, given the edges of all cells but the last.
#[allow(clippy::inline_always)]
#[inline(always)] // it has one caller for each scheme
pub(in crate::scheme) fn number_by_search<S: Sample>(edges: &[S], value: S) -> usize {
    1 + count_preceding(edges.len(), |i| edges.get(i).is_some_and(|&edge| value.is_beyond(edge)))
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const C: usize> Partition<S, C> {
    /// The first `count` of the cells, with strictly rising edges, the last of which is not used.
    pub(in crate::scheme) const fn new(values: [S; C], mut edges: [S; C], count: usize) -> Self {
        const { assert!(C >= 2 && C <= 1024, "there are 2 to 1024 cells") };
        let mut i = count.saturating_sub(1);
        // No value exceeds the edges of cells that there are not.
        while i < C && count < C {
            edges[i] = from_f64(f64::INFINITY);
            i += 1;
        }
        let bins = Self::bins(&edges, count);
        let (starts, is_unique) = Self::starts(&edges, count, bins);
        let bins = if is_unique { bins } else { EvenBins::ONE };
        Self { values, edges, bins, starts }
    }

    /// Twice as many bins as there may be cells. The first edge lies in the first, the last edge in the last.
    const fn bins(edges: &[S; C], count: usize) -> EvenBins {
        if count < 2 || count > C {
            return EvenBins::ONE;
        }
        let lowest = units(edges[0]);
        let width = (units(edges[count - 2]) - lowest) / (2 * C - 1) as f64;
        even_bins::<S>(lowest - width / 16.0, width, 2 * C)
    }

    /// The table of bins, and whether no two edges share one.
    const fn starts(edges: &[S; C], count: usize, bins: EvenBins) -> ([[u8; 2]; C], bool) {
        let mut starts = [[1; 2]; C];
        let mut edge = 0;
        let mut i = 0;
        while i < 2 * C && edge < u8::MAX as usize {
            starts[i / 2][i % 2] = edge as u8 + 1;
            if edge + 1 < count && edge < C && bin_of(bins, edges[edge]) == i {
                edge += 1;
            }
            i += 1;
        }
        // Otherwise two edges share a bin, or there are more cells than a byte of the table can number.
        (starts, edge + 1 == count && i == 2 * C)
    }

    /// The number (from 1) of the cell that a finite value belongs to.
    #[inline]
    pub(in crate::scheme) fn number(&self, value: S) -> usize {
        if self.has_bins() { self.by_bin(value) } else { self.by_search(value) }
    }

    /// Whether [`by_bin`](Self::by_bin) finds the cell of every value.
    #[inline]
    pub(in crate::scheme) fn has_bins(&self) -> bool {
        S::HAS_BINS && !self.bins.is_one()
    }

    /// [`number`](Self::number) by the table of bins; 1 for NaN.
    #[inline]
    pub(in crate::scheme) fn by_bin(&self, value: S) -> usize {
        // A value above all bins lies above the last edge, as do values of the last bin.
        let bin = value.bin(self.bins).min(2 * C - 1);
        let lowest = self.starts.as_flattened().get(bin).copied().map_or(C, usize::from);
        let is_beyond = self.edges().get(lowest.wrapping_sub(1)).is_some_and(|&edge| value > edge);
        if is_beyond { lowest.wrapping_add(1) } else { lowest }
    }

    /// [`number`](Self::number) by binary search.
    #[inline(never)] // the search is unrolled, and one copy is enough
    pub(in crate::scheme) fn by_search(&self, value: S) -> usize {
        number_by_search(self.edges(), value)
    }

    /// The edges of all cells but the last, which has none.
    #[inline]
    fn edges(&self) -> &[S] {
        self.edges.get(..C - 1).unwrap_or_default()
    }

    /// The name of a scheme, and these cells, of which it has `count`.
    pub(in crate::scheme) fn named(&self, name: &str, count: usize) -> Fingerprint {
        let values = self.values.get(..count).unwrap_or_default();
        let edges = self.edges.get(..count.saturating_sub(1)).unwrap_or_default();
        Fingerprint::new(name).samples(values).samples(edges)
    }

    /// What a cell stands for; cells are counted from 0.
    #[inline]
    pub(in crate::scheme) fn get(&self, cell: usize) -> Option<S> {
        self.values.get(cell).copied()
    }

    /// What the cells stand for, the lowest first.
    pub(in crate::scheme) const fn as_array(&self) -> &[S; C] {
        &self.values
    }
}
