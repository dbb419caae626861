//! The centres of a population of neurons, and the search for the one nearest to a value.

use core::ops::RangeInclusive;

use super::search::count_preceding;
use crate::error::finite;
use crate::num::curve::normal_quantile;
use crate::num::{Cells, cell, cells, floor_from_f64, from_f64, to_f64, units};
use crate::{ConfigError, Sample, SampleKind};

/// The centres of `M` neurons, 3 to 1024, and the edges halfway between them.
///
/// A value belongs to the neuron whose centre is nearest, exactly, in every sample type: halfway between two centres
/// to the lower one, outside the range to the neuron at that end. Even centres are compared unrounded, others as
/// rounded to the sample type.
///
/// - **Memory:** the centres, as many edges, `2 M` bytes for a table of even cells, and 8 bytes.
/// - **Work:** one multiplication finds the cell of a value, a table gives the lowest neuron of that cell, and one
///   comparison with an edge decides between it and the next. A binary search takes their place where two edges
///   share a cell, as with Gaussian-spaced centres from about 140 on or the user's own, with more than 256 neurons,
///   and for `f32` without a float unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(transparent, bound = "S: serde::Serialize")
)]
pub(super) struct Centres<S, const M: usize> {
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array"))]
    values: [S; M],
    /// `edges[i]` is the largest value that still belongs to neuron `i`; the last is not used.
    #[cfg_attr(feature = "serde", serde(skip))]
    edges: [S; M],
    #[cfg_attr(feature = "serde", serde(skip))]
    cells: Cells,
    /// For each cell, the number (from 1) of the lowest neuron to which one of its values belongs.
    #[cfg_attr(feature = "serde", serde(skip))]
    starts: [[u8; 2]; M],
}

/// `min < max`, both finite.
pub(super) const fn check_range(min: f64, max: f64) -> Result<(), ConfigError> {
    match (finite("min", min), finite("max", max)) {
        (Err(error), _) | (_, Err(error)) => Err(error),
        _ if min < max => Ok(()),
        _ => Err(not_rising("min and max", 1, max, min)),
    }
}

const fn not_rising(
    parameter: &'static str,
    index: usize,
    value: f64,
    previous: f64,
) -> ConfigError {
    ConfigError::NotRising { parameter, index, value: value as f32, previous: previous as f32 }
}

/// The midpoint of two doubles, rounded down: that of two `f32` of very different size may be no double.
const fn halfway(low: f64, high: f64) -> f64 {
    let sum = low + high;
    let rest = sum - low;
    let error = (low - (sum - rest)) + (high - rest);
    if error < 0.0 { (sum / 2.0).next_down() } else { sum / 2.0 }
}

/// `mu[i] = min + (2i - 1) / 2 * (max - min) / (m - 2)`.
pub(super) const fn even_centre(min: f64, max: f64, i: usize, m: usize) -> f64 {
    min + (2.0 * i as f64 - 1.0) * (max - min) / (2.0 * (m as f64 - 2.0))
}

/// The largest value not above the edge halfway between `mu[i]` and `mu[i+1]`, which is
/// `min + i (max - min) / (m - 2)`.
const fn even_edge<S: Sample>(min: f64, max: f64, i: usize, m: usize) -> S {
    let parts = m as f64 - 2.0;
    let near = min + i as f64 * (max - min) / parts;
    if !matches!(S::KIND, SampleKind::F32) {
        return floor_from_f64(near);
    }
    // A double holds each of these products of a float exactly, but not their sum.
    let (from_min, from_max) = ((parts - i as f64) * min, i as f64 * max);
    let sum = from_min + from_max;
    let rest = sum - from_min;
    let error = (from_min - (sum - rest)) + (from_max - rest);
    let mut edge = (sum / parts) as f32;
    while !is_at_most(edge as f64 * parts, sum, error) {
        edge = edge.next_down();
    }
    while is_at_most(edge.next_up() as f64 * parts, sum, error) {
        edge = edge.next_up();
    }
    // An edge of -0, which total order places below 0, becomes 0.
    from_f64(edge as f64 + 0.0)
}

/// Whether `value <= sum + error`, where the error is that of a rounded sum.
const fn is_at_most(value: f64, sum: f64, error: f64) -> bool {
    value < sum || value - sum <= error
}

/// The quantile `(2i + 1) / 2m` of a normal distribution, scaled so that the first one is `min` and the last `max`.
const fn gaussian_centre(min: f64, max: f64, i: usize, m: usize) -> f64 {
    let middle = f64::midpoint(min, max);
    let from_end = m.wrapping_sub(1).wrapping_sub(i);
    let mirrored = if i < from_end { from_end } else { i };
    let (neuron, neurons) = (mirrored as f64, m as f64);
    let outermost = normal_quantile((2.0 * neurons - 1.0) / (2.0 * neurons));
    let quantile = normal_quantile((2.0 * neuron + 1.0) / (2.0 * neurons));
    let offset = (max - min) / 2.0 * quantile / outermost;
    if mirrored == i { middle + offset } else { middle - offset }
}

/// The number (from 1) of the neuron that a finite value belongs to, given the edges of all neurons but the last.
#[allow(clippy::inline_always)]
#[inline(always)] // it has one caller for each scheme
pub(super) fn nearest_by_search<S: Sample>(edges: &[S], value: S) -> usize {
    1 + count_preceding(edges.len(), |i| edges.get(i).is_some_and(|&edge| value.is_beyond(edge)))
}

/// Sets each edge but the last to the largest value not above halfway between two centres.
///
/// # Errors
/// A centre is not finite, or does not exceed the one before.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn halfway_edges<S: Sample>(
    centres: &[S],
    edges: &mut [S],
) -> Result<(), ConfigError> {
    let mut before = None;
    let mut i = 0;
    while i < centres.len() {
        let value = to_f64(centres[i]);
        if let Err(error) = finite("centre", value) {
            return Err(error);
        }
        if let Some(below) = before {
            if value <= below {
                return Err(not_rising("centres", i, value, below));
            }
            let edge = i.wrapping_sub(1);
            if edge < edges.len() {
                edges[edge] = floor_from_f64(halfway(below, value));
            }
        }
        before = Some(value);
        i += 1;
    }
    Ok(())
}

/// Sets even centres over a range, and the edges halfway between them before they are rounded.
///
/// # Errors
/// The ends are not finite, or do not rise, or the sample type is too coarse to tell the centres apart.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn even<S: Sample>(
    range: &RangeInclusive<S>,
    centres: &mut [S],
    edges: &mut [S],
) -> Result<(), ConfigError> {
    let (min, max) = (to_f64(*range.start()), to_f64(*range.end()));
    if let Err(error) = check_range(min, max) {
        return Err(error);
    }
    let count = centres.len();
    let mut i = 0;
    while i < count {
        centres[i] = from_f64(even_centre(min, max, i, count));
        i += 1;
    }
    if let Err(error) = halfway_edges(centres, edges) {
        return Err(error);
    }
    i = 0;
    while i < count && i < edges.len() {
        edges[i] = even_edge(min, max, i, count);
        i += 1;
    }
    Ok(())
}

/// Sets centres over a range spaced as the quantiles of a normal distribution.
///
/// # Errors
/// The ends are not finite, or do not rise.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn gaussian_spaced<S: Sample>(
    range: &RangeInclusive<S>,
    centres: &mut [S],
) -> Result<(), ConfigError> {
    let (min, max) = (to_f64(*range.start()), to_f64(*range.end()));
    if let Err(error) = check_range(min, max) {
        return Err(error);
    }
    let count = centres.len();
    let mut i = 0;
    while i < count {
        centres[i] = from_f64(gaussian_centre(min, max, i, count));
        i += 1;
    }
    Ok(())
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const M: usize> Centres<S, M> {
    pub(super) const SHAPE: () =
        assert!(M >= 3 && M <= 1024, "a population takes 3 to 1024 neurons");

    /// The user's own centres, strictly rising.
    ///
    /// # Errors
    /// A centre is not finite, or does not exceed the one before.
    pub(super) const fn try_new(values: [S; M]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut edges = values;
        if let Err(error) = halfway_edges(&values, &mut edges) {
            return Err(error);
        }
        Ok(Self::with_cells(values, edges))
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type. The edges are
    /// halfway between the centres before rounding.
    ///
    /// # Errors
    /// The ends are not finite, or do not rise, or the sample type is too coarse to tell the centres apart.
    pub(super) const fn try_linear(range: &RangeInclusive<S>) -> Result<Self, ConfigError> {
        let mut values = [S::ZERO; M];
        let mut edges = [S::ZERO; M];
        match even(range, &mut values, &mut edges) {
            Ok(()) => Ok(Self::with_cells(values, edges)),
            Err(error) => Err(error),
        }
    }

    /// Centres over a range spaced as the quantiles of a normal distribution: dense around the middle.
    ///
    /// # Errors
    /// As for [`try_linear`](Self::try_linear).
    pub(super) const fn try_gaussian_spaced(
        range: &RangeInclusive<S>,
    ) -> Result<Self, ConfigError> {
        let mut values = [S::ZERO; M];
        match gaussian_spaced(range, &mut values) {
            Ok(()) => Self::try_new(values),
            Err(error) => Err(error),
        }
    }

    /// Builds the table of cells; a single cell if two edges share one.
    const fn with_cells(values: [S; M], edges: [S; M]) -> Self {
        let lowest = units(edges[0]);
        let count = 2 * M;
        let width = (units(edges[M - 2]) - lowest) / (count - 1) as f64;
        let cells = cells::<S>(lowest - width / 16.0, width, count);
        let mut starts = [[1; 2]; M];
        let mut edge = 0;
        let mut i = 0;
        while i < count && edge < u8::MAX as usize {
            starts[i / 2][i % 2] = edge as u8 + 1;
            if edge < M - 1 && cell(cells, edges[edge]) == i {
                edge += 1;
            }
            i += 1;
        }
        // Otherwise two edges share a cell, or there are more neurons than a byte of the table can number.
        let cells = if edge == M - 1 && i == count { cells } else { Cells::ONE };
        Self { values, edges, cells, starts }
    }

    /// The number (from 1) of the neuron that a finite value belongs to.
    #[inline]
    pub(super) fn nearest(&self, value: S) -> usize {
        if self.has_cells() { self.by_cell(value) } else { self.by_search(value) }
    }

    /// Whether [`by_cell`](Self::by_cell) finds the neuron of every value.
    #[inline]
    pub(super) fn has_cells(&self) -> bool {
        S::HAS_CELLS && !self.cells.is_one()
    }

    /// [`nearest`](Self::nearest) by the table of cells; 1 for NaN.
    #[inline]
    pub(super) fn by_cell(&self, value: S) -> usize {
        let cell = value.cell(self.cells);
        // A value above all cells belongs to the last neuron.
        let lowest = self.starts.as_flattened().get(cell).copied().map_or(M, usize::from);
        let is_beyond = self.edges().get(lowest.wrapping_sub(1)).is_some_and(|&edge| value > edge);
        if is_beyond { lowest.wrapping_add(1) } else { lowest }
    }

    /// [`nearest`](Self::nearest) by binary search.
    #[inline(never)] // the search is unrolled, and one copy is enough
    pub(super) fn by_search(&self, value: S) -> usize {
        nearest_by_search(self.edges(), value)
    }

    /// The edges of all neurons but the last, which has none.
    #[inline]
    fn edges(&self) -> &[S] {
        self.edges.get(..M - 1).unwrap_or_default()
    }

    pub(super) fn get(&self, neuron: usize) -> Option<S> {
        self.values.get(neuron).copied()
    }

    pub(super) fn middle(&self) -> S {
        self.get(M / 2).unwrap_or(S::ZERO)
    }

    pub(super) const fn as_array(&self) -> &[S; M] {
        &self.values
    }
}
