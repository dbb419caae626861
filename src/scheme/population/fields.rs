//! Gaussian receptive fields of equal width, computed with a table of distances instead of exponentials.

#[cfg(feature = "rand-010")]
use core::hint::black_box;
use core::ops::RangeInclusive;

#[cfg(feature = "rand-010")]
use super::FiredNeurons;
use super::centres::{Centres, even_centre};
use crate::error::{positive, tri};
use crate::num::curve::ln;
use crate::num::{Distance, DoubleDouble, EvenBins, bin_of, even_bins, near, reach, top, units};
use crate::scheme::cells::count_preceding;
use crate::{ConfigError, Fingerprint, Sample};

/// Receptive fields of `M` neurons, 3 to 1024, whose responses to a value are rounded to `N` levels, 2 to 256.
///
/// The response is `r = exp(-(x - mu)² / (2 sigma²))` with even centres and
/// `sigma = (max - min) / (beta (M - 2))`; its level is `N r`, rounded half up. Each level has a largest distance from
/// the centre, its reach, so that a table of `N` reaches replaces the exponential.
///
/// - **Memory:** `4 M + 4 N + 28` bytes in `f32`.
/// - **Exactness:** `f32` compares the distance to the rounded centre, rounded once, with the
///   rounded table; fixed point compares exact distances to the unrounded centre.
///
/// Source: Bohté et al. 2002; paper, section II-A.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub(super) struct ReceptiveFields<S: Sample, const M: usize, const N: usize> {
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array::serialize"))]
    centres: [S; M],
    min: S,
    max: S,
    beta: f32,
    /// No neuron below `i` responds to a value in bin `i`.
    #[cfg_attr(feature = "serde", serde(skip))]
    bins: EvenBins,
    /// The lowest and the highest value whose distances fit `S::Short`.
    #[cfg_attr(feature = "serde", serde(skip))]
    near: [S; 2],
    /// `reaches[slot]` is the largest distance at which the level is at least `N - slot`. They rise.
    #[cfg_attr(feature = "serde", serde(skip))]
    reaches: [S::Reach; N],
}

/// Leaves out the tables, which follow from the rest.
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

/// The distance from the centre at which a response, in `n` levels, falls below level `k`: in widths of the field.
pub(super) const fn level_radius(k: usize, n: usize) -> DoubleDouble {
    let inverse = DoubleDouble::new(n as f64).over(DoubleDouble::new(k as f64 - 0.5));
    DoubleDouble::new(2.0).times(ln(inverse)).sqrt()
}

/// The width of a field.
const fn sigma(min: f64, max: f64, beta: f64, m: usize) -> DoubleDouble {
    DoubleDouble::sum(max, -min).over(DoubleDouble::product(beta, m as f64 - 2.0))
}

/// Sets the reaches of `m` neurons. Returns the bins that give the first neuron that may respond to a value, and the
/// lowest and the highest value whose distances fit `S::Short`.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn tables<S: Sample>(
    m: usize,
    range: &RangeInclusive<S>,
    beta: f32,
    reaches: &mut [S::Reach],
) -> (EvenBins, [S; 2]) {
    let (low, high) = (units(*range.start()), units(*range.end()));
    let n = reaches.len();
    let sigma = sigma(low, high, beta as f64, m);
    let mut k = 0;
    while k < n {
        reaches[k] = reach::<S>(sigma.times(level_radius(n - k, n)), m);
        k += 1;
    }
    let farthest = sigma.times(level_radius(1, n)).nearest();
    let width = (high - low) / (m as f64 - 2.0);
    // One and a half bins, less a 32nd of a bin as a margin for rounding.
    let bins = even_bins::<S>(low + farthest - 1.46875 * width, width, m + 2);
    let mut hold = true;
    let mut i = 0;
    while i < m {
        let top = top::<S>(even_centre(low, high, i, m), farthest);
        hold &= bin_of(bins, top) <= i;
        i += 1;
    }
    (if hold { bins } else { EvenBins::ONE }, near(low, high, m, farthest))
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const M: usize, const N: usize> ReceptiveFields<S, M, N> {
    const SHAPE: () = {
        let () = Centres::<S, M>::SHAPE;
        assert!(N >= 2 && N <= 256, "a response has 2 to 256 levels");
    };

    /// Fields over a range. The smaller `beta`, the wider the fields.
    ///
    /// # Errors
    /// Returns an error if `beta` is not above 0, or as for [`Centres::try_linear`].
    pub(super) const fn try_new(range: &RangeInclusive<S>, beta: f32) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        tri!(positive("beta", beta as f64));
        let centres = *tri!(Centres::<S, M>::try_linear(range)).as_array();
        let mut reaches = [reach::<S>(DoubleDouble::ZERO, M); N];
        let (bins, near) = tables::<S>(M, range, beta, &mut reaches);
        let (min, max) = (*range.start(), *range.end());
        Ok(Self { centres, min, max, beta, bins, near, reaches })
    }

    /// The centres, lowest first.
    pub(super) const fn centres(&self) -> &[S; M] {
        &self.centres
    }

    pub(super) const fn beta(&self) -> f32 {
        self.beta
    }

    /// The fields without their sizes.
    #[allow(clippy::inline_always)] // lengths of arrays stay known
    #[inline(always)]
    pub(super) const fn fields(&self) -> Fields<'_, S> {
        let Self { centres, min, max, bins, near, reaches, .. } = self;
        Fields { centres, reaches, min: *min, max: *max, bins: *bins, near: *near }
    }

    /// The mean of the centres of the neurons that fired; `None` if none did.
    #[cfg(feature = "rand-010")]
    #[inline]
    pub(super) fn mean_of(&self, neurons: &FiredNeurons<M>) -> Option<S> {
        // Hidden from the compiler, which would otherwise add up the centres of all neurons and drop most sums, as
        // most neurons do not fire.
        let centres = black_box(&self.centres);
        let mut weighted = S::Weighted::default();
        let mut total = 0_u32;
        neurons.for_each(|neuron| {
            if let Some(&centre) = centres.get(neuron) {
                weighted = S::weigh(weighted, centre, neuron, 1);
                total += 1;
            }
        });
        self.fields().mean(weighted, total)
    }
}

/// Receptive fields in arrays or on the heap.
#[derive(Clone, Copy)]
pub(super) struct Fields<'f, S: Sample> {
    pub(super) centres: &'f [S],
    pub(super) reaches: &'f [S::Reach],
    pub(super) min: S,
    pub(super) max: S,
    pub(super) bins: EvenBins,
    pub(super) near: [S; 2],
}

impl<'f, S: Sample> Fields<'f, S> {
    /// The name of a scheme, and its fields.
    pub(super) fn named(&self, name: &str, beta: f32) -> Fingerprint {
        let ends = Fingerprint::new(name).samples(self.centres).sample(self.min).sample(self.max);
        ends.sample(beta).number(self.reaches.len() as u32)
    }

    /// Whether the distance of a value from every centre fits `S::Short`, which is quicker.
    #[inline]
    pub(super) fn is_near(&self, value: S) -> bool {
        value.is_near(self.near)
    }

    /// The first neuron that may respond to a finite value. If it does not, the next one may while the value
    /// [is above](Self::is_above) its centre.
    #[inline]
    pub(super) fn first(&self, value: S) -> usize {
        value.bin(self.bins)
    }

    /// Whether a value is above the centre of a neuron.
    #[inline]
    pub(super) fn is_above(&self, value: S, neuron: usize) -> bool {
        self.centres.get(neuron).is_some_and(|&centre| value > centre)
    }

    /// The distances of a finite value from the centres of neuron `first` and those after it; `None` if there is no
    /// such neuron.
    #[inline]
    pub(super) fn distances<D: Distance<S> + 'f>(
        self,
        value: S,
        first: usize,
    ) -> Option<impl ExactSizeIterator<Item = D> + 'f> {
        let Self { centres, min, max, .. } = self;
        let count = centres.len();
        let centres = centres.get(first..).filter(|_| first < count)?;
        let distance =
            move |(i, &centre)| D::between(value, centre, first.wrapping_add(i), count, min, max);
        Some(centres.iter().enumerate().map(distance))
    }

    /// The largest distance at which the level is at least this one, from 1.
    #[inline]
    pub(super) fn reach<D: Distance<S>>(&self, level: usize) -> Option<D> {
        self.reaches.get(self.reaches.len().wrapping_sub(level)).copied().map(D::of)
    }

    /// The slot at this distance, which is within the reach of level 1: `N` minus the level.
    #[inline]
    pub(super) fn slot<D: Distance<S>>(&self, distance: D) -> usize {
        count_preceding(self.reaches.len().wrapping_sub(1), |slot| {
            self.reaches.get(slot).is_some_and(|&reach| distance > D::of(reach))
        })
    }

    /// The mean of the centres from `first` on, weighted by their levels; `None` if no neuron has a level.
    #[inline]
    pub(super) fn weighted_mean(
        &self,
        first: usize,
        levels: impl ExactSizeIterator<Item = u32>,
    ) -> Option<S> {
        let centres = self.centres.get(first..first.wrapping_add(levels.len()))?;
        let mut weighted = S::Weighted::default();
        let mut total = 0_u32;
        for (i, (level, &centre)) in levels.zip(centres).enumerate() {
            weighted = S::weigh(weighted, centre, first.wrapping_add(i), level);
            total = total.wrapping_add(level);
        }
        self.mean(weighted, total)
    }
    #[inline]
    fn mean(self, weighted: S::Weighted, levels: u32) -> Option<S> {
        (levels > 0).then(|| S::mean(weighted, levels, self.centres.len(), self.min, self.max))
    }
}
