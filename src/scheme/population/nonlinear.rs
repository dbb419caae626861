//! Non-linear receptive fields: any centres and widths, of which the strongest response wins.

use core::ops::RangeInclusive;

use super::centres::{Centres, halfway_edges};
use super::position::Position;
use crate::error::{positive, range, tri, unwrap};
use crate::num::curve::growth;
use crate::num::{DoubleDouble, floor_from_f64, from_f64, to_f64};
use crate::{ConfigError, Sample};

/// Non-linear receptive fields: the neuron with the strongest Gaussian response fires, whose field may be narrower
/// or wider than the others.
///
/// The strongest response is the least `|x - mu| / sigma`. Between two centres the winner changes at
/// `E[i] = (sigma[i+1] mu[i] + sigma[i] mu[i+1]) / (sigma[i] + sigma[i+1])`, which belongs to the lower neuron, so
/// that no exponential is needed. Outside the centres the neuron at that end fires, and the decoder gives the
/// centre: the error is at most the distance from a centre to the farther of its edges.
///
/// - **Centres:** strictly rising: the user's own, [companded](Self::companded), or the
///   [quantiles](crate::Histogram::centres) of a signal.
/// - **Widths:** `sigma` above 0, in the samples' unit, or [from the spacing](Self::spaced). Only their ratios matter
///   here: the `beta` of fields from the spacing cancels out.
/// - **Set-up:** of the order of `M²` operations in double precision.
///
/// Source: Bohté et al. 2002, for the fields; ITU-T G.711 (µ-law), for the companding.
///
/// ```
/// use spikewire::{Scheme, population::Gaussian};
///
/// const ERROR: Gaussian<i16, 5> = Gaussian::spaced([0, 10, 30, 70, 150]);
/// let mut encoder = ERROR.encoder();
/// let neurons = [4, 5, 43, 104, 105].map(|x| encoder.encode(x).map(|neuron| neuron.index()));
/// assert_eq!(neurons, [Some(0), Some(1), Some(2), Some(3), Some(4)]);
/// ```
impl<S: Sample, const M: usize> Position<S, M> {
    /// Fields with these centres and widths `sigma`. For constants, where bad ones fail the build.
    ///
    /// # Panics
    /// Panics if [`try_with_widths`](Self::try_with_widths) returns an error.
    pub const fn with_widths(centres: [S; M], widths: [f32; M]) -> Self {
        unwrap(Self::try_with_widths(centres, widths))
    }

    /// Fields with these centres and widths `sigma`.
    ///
    /// # Errors
    /// Returns an error if a centre is not finite, or does not exceed the one before; a width is not above 0 and
    /// finite; a field wins where two others meet, or wins nowhere.
    pub const fn try_with_widths(centres: [S; M], widths: [f32; M]) -> Result<Self, ConfigError> {
        let mut sigmas = [0.0; M];
        tri!(own_widths(&widths, &mut sigmas));
        Self::of_fields(centres, &sigmas)
    }

    /// Fields with these centres, each as wide as the distance between its neighbours. For constants, where bad
    /// centres fail the build.
    ///
    /// # Panics
    /// Panics if [`try_spaced`](Self::try_spaced) returns an error.
    pub const fn spaced(centres: [S; M]) -> Self {
        unwrap(Self::try_spaced(centres))
    }

    /// Fields with these centres, each as wide as the distance between its neighbours:
    /// `sigma[i] = (mu[i+1] - mu[i-1]) / 2 beta`, and the one spacing over `beta` at either end.
    ///
    /// # Errors
    /// Returns an error if a centre is not finite, or does not exceed the one before; a field wins where two others
    /// meet, as may happen beside a gap many times as wide as the spacings before it: then take [equal
    /// widths](Self::try_new).
    pub const fn try_spaced(centres: [S; M]) -> Result<Self, ConfigError> {
        let mut sigmas = [0.0; M];
        spacings(&centres, &mut sigmas);
        Self::of_fields(centres, &sigmas)
    }

    /// Companded centres, dense in the middle of the range, with fields [as wide as their spacing](Self::spaced).
    /// For constants, where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_companded`](Self::try_companded) returns an error.
    pub const fn companded(range: RangeInclusive<S>, companding: f32) -> Self {
        unwrap(Self::try_companded(range, companding))
    }

    /// Companded centres, dense in the middle of the range, with fields [as wide as their spacing](Self::try_spaced):
    /// `mu[i] = middle ± (max - min) / 2 * ((1 + A)^|t| - 1) / A`, with the sign of `t = 2 i / (M - 1) - 1`, rounded
    /// to the nearest sample, halves upwards.
    ///
    /// - **Companding:** `A` above 0; the larger, the denser the middle. Telephony takes 255.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise; the companding is not above 0 and finite; the
    /// sample type is too coarse to tell the centres apart.
    pub const fn try_companded(
        range: RangeInclusive<S>,
        companding: f32,
    ) -> Result<Self, ConfigError> {
        let mut centres = [S::ZERO; M];
        tri!(companded(&range, companding, &mut centres));
        Self::try_spaced(centres)
    }

    const fn of_fields(centres: [S; M], widths: &[f64]) -> Result<Self, ConfigError> {
        const { Centres::<S, M>::SHAPE };
        let mut edges = centres;
        tri!(crossings(&centres, widths, &mut edges));
        Ok(Self::of_edges(centres, edges))
    }
}

/// Copies the user's widths as doubles.
///
/// # Errors
/// Returns an error if a width is not above 0 and finite.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn own_widths(widths: &[f32], sigmas: &mut [f64]) -> Result<(), ConfigError> {
    let mut i = 0;
    while i < widths.len() && i < sigmas.len() {
        sigmas[i] = widths[i] as f64;
        tri!(positive("width", sigmas[i]));
        i += 1;
    }
    Ok(())
}

/// The value at an index, or 0 beyond the end.
#[allow(clippy::indexing_slicing)] // constants have no iterators
const fn real<S: Sample>(values: &[S], index: usize) -> f64 {
    if index < values.len() { to_f64(values[index]) } else { 0.0 }
}

/// The width at an index, or 0 beyond the end.
#[allow(clippy::indexing_slicing)] // constants have no iterators
const fn width(widths: &[f64], index: usize) -> f64 {
    if index < widths.len() { widths[index] } else { 0.0 }
}

/// `2 beta sigma` of fields as wide as their spacing: the distance between the neighbours of each, and twice the
/// one spacing at either end.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn spacings<S: Sample>(centres: &[S], widths: &mut [f64]) {
    let mut i = 0;
    while i < centres.len() && i < widths.len() {
        let lower = if i > 0 { i - 1 } else { i };
        let upper = if i + 1 < centres.len() { i + 1 } else { i };
        let distance = real(centres, upper) - real(centres, lower);
        widths[i] = if lower < i && i < upper { distance } else { 2.0 * distance };
        i += 1;
    }
}

/// Sets each edge but the last to the largest value not above where the next field begins to win.
///
/// # Errors
/// Returns an error if a centre is not finite, or does not exceed the one before; a field wins where two others meet,
/// or wins nowhere.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn crossings<S: Sample>(
    centres: &[S],
    widths: &[f64],
    edges: &mut [S],
) -> Result<(), ConfigError> {
    tri!(halfway_edges(centres, edges));
    let mut i = 0;
    while i + 1 < centres.len() && i < edges.len() {
        let (low, high) = (real(centres, i), real(centres, i + 1));
        let (narrow, wide) = (width(widths, i), width(widths, i + 1));
        // The edge times the sum of the two widths.
        let (edge, sum) = (wide * low + narrow * high, narrow + wide);
        let mut j = 0;
        while j < centres.len() {
            let distance = edge - real(centres, j) * sum;
            let distance = if distance < 0.0 { -distance } else { distance };
            if j != i && j != i + 1 && distance < width(widths, j) * (high - low) {
                return Err(ConfigError::FieldTooWide { field: j, lower: i });
            }
            j += 1;
        }
        let exact = DoubleDouble::product(wide, low).plus(DoubleDouble::product(narrow, high));
        let floor: S = floor_from_f64(exact.over(DoubleDouble::sum(narrow, wide)).rounded());
        // An edge of -0, which total order places below 0, becomes 0.
        edges[i] = from_f64(to_f64(floor) + 0.0);
        if i > 0 && real(edges, i) <= real(edges, i - 1) {
            return Err(ConfigError::EmptyCell { cell: i, cells: centres.len() });
        }
        i += 1;
    }
    Ok(())
}

/// Sets companded centres over a range.
///
/// # Errors
/// Returns an error if the ends are not finite, or do not rise; the companding is not above 0 and finite.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn companded<S: Sample>(
    over: &RangeInclusive<S>,
    companding: f32,
    centres: &mut [S],
) -> Result<(), ConfigError> {
    let (min, max) = (to_f64(*over.start()), to_f64(*over.end()));
    tri!(range(min, max));
    tri!(positive("companding", companding as f64));
    let (twice_middle, width) = (DoubleDouble::sum(min, max), DoubleDouble::sum(max, -min));
    let companding = companding as f64;
    let last = centres.len().saturating_sub(1);
    let mut i = 0;
    while i < centres.len() {
        let from_end = last.wrapping_sub(i);
        let growth = growth(companding, i.abs_diff(from_end), last);
        let offset = width.times(growth).over(DoubleDouble::new(companding));
        let offset = if i < from_end { offset.negated() } else { offset };
        centres[i] = from_f64(twice_middle.plus(offset).rounded() / 2.0);
        i += 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{crossings, spacings};
    use crate::ConfigError;

    #[test]
    fn check_values() {
        let centres = [0_i16, 10, 30, 70, 150];
        let (mut widths, mut edges) = ([0.0; 5], centres);
        spacings(&centres, &mut widths);
        assert_eq!(widths, [20.0, 30.0, 60.0, 120.0, 160.0]);
        assert_eq!(crossings(&centres, &widths, &mut edges), Ok(()));
        assert_eq!(edges[..4], [4, 16, 43, 104]);

        let centres = [0_i16, 1, 2, 3, 1003];
        spacings(&centres, &mut widths);
        let error = ConfigError::FieldTooWide { field: 3, lower: 0 };
        assert_eq!(crossings(&centres, &widths, &mut edges), Err(error));
    }
}
