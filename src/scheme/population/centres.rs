//! The centres of a population of neurons, and the search for the one nearest to a value.

use core::ops::RangeInclusive;

use crate::error::{finite, not_rising, range, tri};
use crate::num::curve::normal_quantile;
use crate::num::{DoubleDouble, floor_from_f64, from_f64, to_f64};
use crate::scheme::cells::Partition;
use crate::{ConfigError, Sample, SampleKind};

/// The centres of `M` neurons, 3 to 1024, and the edges halfway between them.
///
/// A value belongs to the neuron whose centre is nearest, exactly, in every sample type: halfway between two centres
/// to the lower one, outside the range to the neuron at that end. Even centres are compared unrounded, others as
/// rounded to the sample type.
pub(super) type Centres<S, const M: usize> = Partition<S, M>;

/// The midpoint of two doubles, rounded down where no double holds it, as for two `f32` of very different size.
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

/// Sets each edge but the last to the largest value not above halfway between two centres.
///
/// # Errors
/// Returns an error if a centre is not finite, or does not exceed the one before.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn halfway_edges<S: Sample>(
    centres: &[S],
    edges: &mut [S],
) -> Result<(), ConfigError> {
    let mut before = None;
    let mut i = 0;
    while i < centres.len() {
        let value = to_f64(centres[i]);
        tri!(finite("centre", value));
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
/// Returns an error if the ends are not finite, or do not rise, or the sample type is too coarse to tell the centres
/// apart.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn even<S: Sample>(
    over: &RangeInclusive<S>,
    centres: &mut [S],
    edges: &mut [S],
) -> Result<(), ConfigError> {
    let (min, max) = (to_f64(*over.start()), to_f64(*over.end()));
    tri!(range(min, max));
    let count = centres.len();
    let mut i = 0;
    while i < count {
        centres[i] = from_f64(even_centre(min, max, i, count));
        i += 1;
    }
    tri!(halfway_edges(centres, edges));
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
/// Returns an error if the ends are not finite, or do not rise.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn gaussian_spaced<S: Sample>(
    over: &RangeInclusive<S>,
    centres: &mut [S],
) -> Result<(), ConfigError> {
    let (min, max) = (to_f64(*over.start()), to_f64(*over.end()));
    tri!(range(min, max));
    let (twice_middle, width) = (DoubleDouble::sum(min, max), DoubleDouble::sum(max, -min));
    // The quantile `(2i + 1) / 2m`, for the upper half.
    let count = centres.len();
    let probabilities = count.saturating_mul(2);
    let mut quantile = DoubleDouble::ZERO;
    let outermost = normal_quantile(probabilities.saturating_sub(1), probabilities, quantile);
    let mut i = count / 2;
    while i < count {
        quantile = normal_quantile(i.saturating_mul(2).saturating_add(1), probabilities, quantile);
        let offset = width.times(quantile).over(outermost);
        centres[i] = from_f64(twice_middle.plus(offset).rounded() / 2.0);
        let mirrored = count.wrapping_sub(1).wrapping_sub(i);
        if mirrored < count {
            centres[mirrored] = from_f64(twice_middle.minus(offset).rounded() / 2.0);
        }
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
    /// Returns an error if a centre is not finite, or does not exceed the one before.
    pub(super) const fn try_new(values: [S; M]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut edges = values;
        tri!(halfway_edges(&values, &mut edges));
        Ok(Self::new(values, edges, M))
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type. The edges are
    /// halfway between the centres before rounding.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or the sample type is too coarse to tell the
    /// centres apart.
    pub(super) const fn try_linear(range: &RangeInclusive<S>) -> Result<Self, ConfigError> {
        let mut values = [S::ZERO; M];
        let mut edges = [S::ZERO; M];
        tri!(even(range, &mut values, &mut edges));
        Ok(Self::new(values, edges, M))
    }

    /// Centres over a range spaced as the quantiles of a normal distribution: dense around the middle.
    ///
    /// # Errors
    /// Returns an error if [`try_linear`](Self::try_linear) does.
    pub(super) const fn try_gaussian_spaced(
        range: &RangeInclusive<S>,
    ) -> Result<Self, ConfigError> {
        let mut values = [S::ZERO; M];
        tri!(gaussian_spaced(range, &mut values));
        Self::try_new(values)
    }
}
