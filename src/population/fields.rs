//! Gaussian receptive fields of equal width, as distances instead of exponentials.

use super::cells::Cells;
use super::centres::{Centres, check_range, even_centre};
use super::search::count_preceding;
use super::spaced::{Distance, for_each_spaced};
use crate::curve::{ln, sqrt};
use crate::error::{checked, positive};
use crate::{ConfigError, Sample};

/// `M` neurons, 3 to 1024, whose responses to a value are told apart in `N` levels, 2 to 256. Kept in
/// flash and shared.
///
/// The response is `r = exp(-(x - mu)² / (2 sigma²))` with even centres and
/// `sigma = (max - min) / (beta (M - 2))`; its level is `N r`, rounded half up. A level is reached
/// within a distance from the centre, so that a table of `N` distances replaces the exponential.
///
/// - **Memory:** `4 M + 4 N + 20` bytes of flash in `f32`.
/// - **Exactness:** `f32` compares the distance to the rounded centre, rounded once, with the
///   rounded table; fixed point compares exact distances to the unrounded centre.
///
/// Source: Bohté et al. 2002; paper, section II-A.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ReceptiveFields<S: Sample, const M: usize, const N: usize> {
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array"))]
    centres: [S; M],
    min: S,
    max: S,
    beta: f32,
    /// A value in cell `i` is out of reach of the neurons below `i`.
    #[cfg_attr(feature = "serde", serde(skip))]
    cells: Cells,
    #[cfg_attr(feature = "serde", serde(skip))]
    near: S::Near,
    /// `reaches[slot]` is the largest distance with a level of at least `N - slot`: rising.
    #[cfg_attr(feature = "serde", serde(skip))]
    reaches: [S::Reach; N],
}

/// Without the table, which follows from the rest.
#[cfg(feature = "defmt")]
impl<S: Sample + defmt::Format, const M: usize, const N: usize> defmt::Format
    for ReceptiveFields<S, M, N>
{
    fn format(&self, f: defmt::Formatter<'_>) {
        let Self { centres, min, max, beta, .. } = self;
        defmt::write!(
            f,
            "ReceptiveFields {{ centres: {}, min: {}, max: {}, beta: {} }}",
            centres,
            min,
            max,
            beta
        );
    }
}

/// The distance from its centre at which a response of `N` levels falls below level `k`.
const fn radius(min: f64, max: f64, beta: f64, m: usize, k: usize, n: usize) -> f64 {
    let sigma = (max - min) / (beta * (m as f64 - 2.0));
    sigma * sqrt(2.0 * ln(n as f64 / (k as f64 - 0.5)))
}

impl<S: Sample, const M: usize, const N: usize> ReceptiveFields<S, M, N> {
    const SHAPE: () = {
        let () = Centres::<S, M>::SHAPE;
        assert!(N >= 2 && N <= 256, "a response has 2 to 256 levels");
    };

    /// Fields over a range; the wider, the smaller `beta`. The paper takes 1.5.
    ///
    /// # Errors
    /// `beta` is not above 0, or as for [`Centres::new_linear`].
    pub fn new(min: S, max: S, beta: f32) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let width = f64::from(beta);
        positive("beta", width)?;
        let centres = Centres::new_linear(min, max)?;
        Ok(S::fields(*centres.as_array(), min, max, beta))
    }

    /// The centres, lowest first.
    pub const fn centres(&self) -> &[S; M] {
        &self.centres
    }

    pub(super) fn middle(&self) -> S {
        self.centres.get(M / 2).copied().unwrap_or(S::ZERO)
    }

    /// Whether the distances of a value fit [`Short`](super::Spaced::Short).
    #[inline]
    pub(super) fn is_near(&self, value: S) -> bool {
        value.is_near(self.near)
    }

    /// The first neuron that may respond to a finite value: it, or the next if the value
    /// [is above](Self::is_above) it.
    #[inline]
    pub(super) fn first(&self, value: S) -> usize {
        value.cell(self.cells)
    }

    #[inline]
    pub(super) fn is_above(&self, value: S, neuron: usize) -> bool {
        self.centres.get(neuron).is_some_and(|&centre| value > centre)
    }

    /// The distances of a finite value from this neuron and those after it, if there is one.
    #[inline]
    pub(super) fn distances<'f, D: Distance<S> + 'f>(
        &'f self,
        value: S,
        first: usize,
    ) -> Option<impl ExactSizeIterator<Item = D> + 'f> {
        let &Self { min, max, .. } = self;
        let centres = self.centres.get(first..).filter(|_| first < M)?;
        let distance = move |(i, &centre)| D::between(value, centre, first + i, M, min, max);
        Some(centres.iter().enumerate().map(distance))
    }

    /// The largest distance with at least this level, 1 to `N`.
    #[inline]
    pub(super) fn reach<D: Distance<S>>(&self, level: usize) -> Option<D> {
        self.reaches.get(N.wrapping_sub(level)).copied().map(D::of)
    }

    /// `N` less the level at this distance, which is at least 1.
    #[inline]
    pub(super) fn slot<D: Distance<S>>(&self, distance: D) -> usize {
        count_preceding(N - 1, |slot| {
            self.reaches.get(slot).is_some_and(|&reach| distance > D::of(reach))
        })
    }

    /// The mean of the centres from `first` on that have levels, weighted by these, or `None` without any.
    #[inline]
    pub(super) fn mean(
        &self,
        first: usize,
        levels: impl ExactSizeIterator<Item = Option<u32>>,
    ) -> Option<S> {
        let centres = self.centres.get(first..first + levels.len())?;
        let mut weighted = S::Weighted::default();
        let mut total = 0;
        for (i, (level, &centre)) in levels.zip(centres).enumerate() {
            if let Some(level) = level {
                weighted = S::weigh(weighted, centre, first + i, level);
                total += level;
            }
        }
        (total > 0).then(|| S::mean(weighted, total, M, self.min, self.max))
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path, $raw:path, $kind:ident) => {
        // Constants are built by index: there are no iterators in constants.
        #[allow(clippy::indexing_slicing)]
        impl<const M: usize, const N: usize, $($generics)*> ReceptiveFields<$sample, M, N> {
            /// For constants: [`new`](Self::new). Parameters that make no sense fail the build.
            ///
            /// # Panics
            /// As `new` fails; at compile time where it initialises a constant.
            pub const fn checked(min: $sample, max: $sample, beta: f32) -> Self {
                const { Self::SHAPE };
                checked!(positive("beta", beta as f64));
                checked!(check_range($to_f64(min), $to_f64(max)));
                let centres = Centres::<$sample, M>::linear(min, max);
                Self::with_table(*centres.as_array(), min, max, beta)
            }

            /// With the table of distances, and the cells in which they end.
            pub(super) const fn with_table(
                centres: [$sample; M],
                min: $sample,
                max: $sample,
                beta: f32,
            ) -> Self {
                use super::spaced::$kind;
                let (low, high) = ($kind::units($raw(min)), $kind::units($raw(max)));
                let mut reaches = [$kind::reach(0.0, M); N];
                let mut k = 0;
                while k < N {
                    reaches[k] = $kind::reach(radius(low, high, beta as f64, M, N - k, N), M);
                    k += 1;
                }
                let farthest = radius(low, high, beta as f64, M, 1, N);
                let width = (high - low) / (M as f64 - 2.0);
                // A 32nd of a cell for what is rounded.
                let cells = $kind::cells(low + farthest - 1.46875 * width, width, M + 2);
                let mut hold = true;
                let mut i = 0;
                while i < M {
                    let top = $kind::top(even_centre(low, high, i, M), farthest);
                    hold &= $kind::cell(cells, top) <= i;
                    i += 1;
                }
                let cells = if hold { cells } else { Cells::ONE };
                let near = $kind::near(low, high, M, reaches[N - 1]);
                Self { centres, min, max, beta, cells, near, reaches }
            }
        }
    };
}
for_each_spaced!(constants);
