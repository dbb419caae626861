//! Where the neurons of a population are centred.

use super::cells::Cells;
use super::search::count_preceding;
use super::spaced::for_each_spaced;
use crate::curve::normal_quantile;
use crate::error::{checked, finite};
use crate::{ConfigError, Sample};

/// The centres of `M` neurons, 3 to 1024, and the edges halfway between them, kept in flash and
/// shared by any number of encoders and decoders.
///
/// The neuron of a value is the one whose centre is nearest, exactly, in every sample type: a value
/// halfway between two belongs to the lower, a value outside to the neuron at that end.
///
/// - **Memory:** the centres, as many edges, `2 M` bytes for a table of even cells, and 8 bytes.
/// - **Work:** one multiplication finds a value's cell, the table a neuron for the cell, and one
///   comparison with an edge whether it is that or the next. Where two edges share a cell, as with
///   Gaussian-spaced centres from about 140 on or the user's own, beyond 256 neurons, and for `f32` without
///   a float unit, it is a binary search instead.
///
/// Fewer than three neurons do not compile:
///
/// ```compile_fail
/// # use spikewire::population::Centres;
/// static NONE: Centres<f32, 2> = Centres::<f32, _>::linear(-1.0, 1.0);
/// # let _ = &NONE;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(transparent, bound = "S: serde::Serialize")
)]
pub struct Centres<S, const M: usize> {
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array"))]
    values: [S; M],
    /// `edges[i]` is the largest value that still belongs to neuron `i`; the last is not used.
    #[cfg_attr(feature = "serde", serde(skip))]
    edges: [S; M],
    #[cfg_attr(feature = "serde", serde(skip))]
    cells: Cells,
    /// The number of the lowest neuron of each cell's values, from 1.
    #[cfg_attr(feature = "serde", serde(skip))]
    starts: [[u8; 2]; M],
}

impl<S, const M: usize> Centres<S, M> {
    pub(super) const SHAPE: () =
        assert!(M >= 3 && M <= 1024, "a population takes 3 to 1024 neurons");

    /// The centres, lowest first.
    pub const fn as_array(&self) -> &[S; M] {
        &self.values
    }
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

/// Halfway between two, rounded to the next double below where it is none: `f32` centres may be of
/// very different size.
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

/// Halfway between `mu[i]` and `mu[i+1]`.
const fn even_edge(min: f64, max: f64, i: usize, m: usize) -> f64 {
    min + i as f64 * (max - min) / (m as f64 - 2.0)
}

/// Quantile `(2i + 1) / 2m` of a normal distribution whose outermost quantiles lie at min and max.
const fn gaussian_centre(min: f64, max: f64, i: usize, m: usize) -> f64 {
    let middle = f64::midpoint(min, max);
    let mirrored = if 2 * i + 1 < m { m - 1 - i } else { i };
    let outermost = normal_quantile((2 * m - 1) as f64 / (2 * m) as f64);
    let offset =
        (max - min) / 2.0 * normal_quantile((2 * mirrored + 1) as f64 / (2 * m) as f64) / outermost;
    if mirrored == i { middle + offset } else { middle - offset }
}

impl<S: Sample, const M: usize> Centres<S, M> {
    /// The user's own centres, strictly rising.
    ///
    /// # Errors
    /// A centre is not finite, or does not exceed the one before.
    pub fn new(values: [S; M]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut edges = values;
        let mut previous: Option<(S, &mut S)> = None;
        for (index, (value, edge)) in values.into_iter().zip(&mut edges).enumerate() {
            finite("centre", value.to_f64())?;
            if let Some((below, edge_below)) = previous {
                let (low, high) = (below.to_f64(), value.to_f64());
                if high <= low {
                    return Err(not_rising("centres", index, high, low));
                }
                *edge_below = S::floor_from_f64(halfway(low, high));
            }
            previous = Some((value, edge));
        }
        Ok(S::centres(values, edges))
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type.
    ///
    /// # Errors
    /// `min` and `max` are not finite, or `min` is not below `max`, or the sample type is too coarse
    /// to tell the centres apart.
    pub fn new_linear(min: S, max: S) -> Result<Self, ConfigError> {
        let (min, max) = (min.to_f64(), max.to_f64());
        check_range(min, max)?;
        let mut centres =
            Self::new(core::array::from_fn(|i| S::from_f64(even_centre(min, max, i, M))))?;
        for (i, edge) in centres.edges.iter_mut().enumerate() {
            *edge = S::floor_from_f64(even_edge(min, max, i, M));
        }
        Ok(S::centres(centres.values, centres.edges))
    }

    /// Centres from `min` to `max` spaced as the quantiles of a normal distribution: dense around
    /// the middle, for an error around its set point.
    ///
    /// # Errors
    /// As for [`new_linear`](Self::new_linear).
    pub fn new_gaussian_spaced(min: S, max: S) -> Result<Self, ConfigError> {
        let (min, max) = (min.to_f64(), max.to_f64());
        check_range(min, max)?;
        Self::new(core::array::from_fn(|i| S::from_f64(gaussian_centre(min, max, i, M))))
    }

    /// The number of a finite value's neuron, from 1.
    #[inline]
    pub(super) fn nearest(&self, value: S) -> usize {
        if self.has_cells() { self.by_cell(value) } else { self.by_search(value) }
    }

    /// Whether [`by_cell`](Self::by_cell) tells the neuron of every value.
    #[inline]
    pub(super) fn has_cells(&self) -> bool {
        S::HAS_CELLS && self.cells != Cells::ONE
    }

    /// As [`nearest`](Self::nearest), by cell; 1 for what is not a number.
    #[inline]
    pub(super) fn by_cell(&self, value: S) -> usize {
        let cell = value.cell(self.cells).min(2 * M - 1);
        let lowest = self.starts.as_flattened().get(cell).copied().map_or(1, usize::from);
        let is_beyond = self.edges().get(lowest - 1).is_some_and(|&edge| value > edge);
        if is_beyond { lowest + 1 } else { lowest }
    }

    /// As [`nearest`](Self::nearest), by binary search.
    #[inline(never)] // unrolled, and not to be so more than once
    pub(super) fn by_search(&self, value: S) -> usize {
        let edges = self.edges();
        1 + count_preceding(M - 1, |i| edges.get(i).is_some_and(|&edge| value.is_beyond(edge)))
    }

    /// Those of all neurons but the last, which has none.
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
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path, $raw:path, $kind:ident) => {
        // Constants are built by index: there are no iterators in constants.
        #[allow(clippy::indexing_slicing)]
        impl<const M: usize, $($generics)*> Centres<$sample, M> {
            /// For constants: the user's own centres. Centres that do not rise fail the build.
            ///
            /// # Panics
            /// As [`new`](Self::new) fails; at compile time where it initialises a constant.
            pub const fn checked(values: [$sample; M]) -> Self {
                const { Self::SHAPE };
                let mut edges = values;
                let mut i = 0;
                while i < M {
                    let value = $to_f64(values[i]);
                    checked!(finite("centre", value));
                    if i > 0 {
                        let below = $to_f64(values[i - 1]);
                        assert!(below < value, "centres must rise strictly");
                        edges[i - 1] = $floor(halfway(below, value));
                    }
                    i += 1;
                }
                Self::with_cells(values, edges)
            }

            /// For constants: [`new_linear`](Self::new_linear). A range that is not one fails the build.
            ///
            /// # Panics
            /// As `new_linear` fails; at compile time where it initialises a constant.
            pub const fn linear(min: $sample, max: $sample) -> Self {
                let (min, max) = ($to_f64(min), $to_f64(max));
                checked!(check_range(min, max));
                let mut values = [$nearest(0.0); M];
                let mut i = 0;
                while i < M {
                    values[i] = $nearest(even_centre(min, max, i, M));
                    i += 1;
                }
                let mut centres = Self::checked(values);
                let mut i = 0;
                while i < M {
                    centres.edges[i] = $floor(even_edge(min, max, i, M));
                    i += 1;
                }
                Self::with_cells(centres.values, centres.edges)
            }

            /// For constants: [`new_gaussian_spaced`](Self::new_gaussian_spaced). A range that is not
            /// one fails the build.
            ///
            /// # Panics
            /// As `new_gaussian_spaced` fails; at compile time where it initialises a constant.
            pub const fn gaussian_spaced(min: $sample, max: $sample) -> Self {
                let (min, max) = ($to_f64(min), $to_f64(max));
                checked!(check_range(min, max));
                let mut values = [$nearest(0.0); M];
                let mut i = 0;
                while i < M {
                    values[i] = $nearest(gaussian_centre(min, max, i, M));
                    i += 1;
                }
                Self::checked(values)
            }

            /// With the table for the edges, where no two of them share a cell.
            pub(super) const fn with_cells(values: [$sample; M], edges: [$sample; M]) -> Self {
                use super::spaced::$kind::{cell, cells, units};
                let lowest = units($raw(edges[0]));
                let count = 2 * M;
                let width = (units($raw(edges[M - 2])) - lowest) / (count - 1) as f64;
                let cells = cells(lowest - width / 16.0, width, count);
                let mut starts = [[1; 2]; M];
                let mut edge = 0;
                let mut i = 0;
                while i < count && edge < 256 {
                    starts[i / 2][i % 2] = (edge + 1) as u8;
                    if edge < M - 1 && cell(cells, $raw(edges[edge])) == i {
                        edge += 1;
                    }
                    i += 1;
                }
                // Two edges in one cell, and the second was not passed.
                let cells = if edge == M - 1 && i == count { cells } else { Cells::ONE };
                Self { values, edges, cells, starts }
            }
        }
    };
}
for_each_spaced!(constants);
