//! The number types of potentials and currents.

use crate::checksum::Checksum;
use crate::sealed::Sealed;
use core::{fmt::Debug, hint::black_box};

/// The type of potentials, currents, thresholds and biases: `f32`, or `i32` with weights of 8 bits.
///
/// | | `f32` | `i32` |
/// |---|---|---|
/// | weights | `f32` | `i8`, shifted up by [`Weights`](crate::Weights)' shift |
/// | decays | `f32`, 0 to 1 | [`u32`], 65 536 stands for 1; a product is rounded down |
/// | values of inputs, 128 at most | `f32` up to ±10⁶ | `i16` |
/// | spikes in a step | any number | 4096; more are [counted](crate::State::rejected) |
/// | largest weight, bias, threshold | ±10¹⁵ | ±2²⁷ (biases, thresholds) |
/// | largest potential, current | any finite | ±2²⁹; saturates there, and counts it |
pub trait Number: Copy + Default + PartialOrd + Debug + Sealed + 'static {
    /// The type of a decay.
    type Factor: Copy + Debug + PartialEq;
    /// The type of an input's value.
    type Value: Copy + Default + Debug;
    /// The weights of one input onto `OUT` neurons.
    type Row<const OUT: usize>: Copy + Debug + 'static;
    /// The type of the factor by which sums of weights are multiplied: a power of two, or none.
    type Scale: Copy + Debug + Default + PartialEq;

    /// Number of groups of four neurons that are summed at once over all spikes of a step; as many as the core has
    /// registers for. It does not affect results.
    #[doc(hidden)]
    const BLOCK: usize;
    /// Maximum number of rows that are added at once.
    #[doc(hidden)]
    const MOST_ROWS: usize;
    /// Maximum number of spikes that a step takes from outside.
    #[doc(hidden)]
    const MOST_SPIKES: usize;

    #[doc(hidden)]
    #[must_use]
    fn scaled(self, factor: Self::Factor) -> Self;
    #[doc(hidden)]
    #[must_use]
    fn plus(self, other: Self) -> Self;
    #[doc(hidden)]
    #[must_use]
    fn minus(self, other: Self) -> Self;
    /// Returns a number above [`OUTSIDE`] if the potential or current has left its range.
    #[doc(hidden)]
    fn outside(self) -> u32;
    /// Clamps the number to its range; returns 1 if it was outside, or else 0.
    #[doc(hidden)]
    fn clamp(&mut self) -> u32;
    /// Returns the value, or `None` if it is not finite or out of range.
    #[doc(hidden)]
    fn accept(value: Self::Value) -> Option<Self::Value>;
    /// Returns the bits, for a checksum.
    #[doc(hidden)]
    fn word(self) -> u32;
    /// Returns the bits of a decay, for a checksum: the same on every core.
    #[doc(hidden)]
    fn word_of_factor(factor: Self::Factor) -> u32;
    /// Adds rows of weights and their scale to a checksum.
    #[doc(hidden)]
    fn add_rows<const OUT: usize>(rows: &[Self::Row<OUT>], scale: Self::Scale, sum: &mut Checksum);
    /// Adds the weights of two lists of rows, in the order of the lists, to the sums of `W` groups of four neurons;
    /// `first` is the first group. The sums start from `start`. The lists have the same scale, and together at most
    /// [`MOST_ROWS`](Self::MOST_ROWS) rows.
    #[doc(hidden)]
    fn sums<const W: usize, const OUT: usize>(
        start: impl FnOnce() -> [[Self; 4]; W],
        lists: [&[&Self::Row<OUT>]; 2],
        scale: Self::Scale,
        first: usize,
    ) -> [[Self; 4]; W];
    /// Adds the weights of a list of rows to the sum of one neuron.
    #[doc(hidden)]
    fn add_rows_to_one<const OUT: usize>(
        rows: &[&Self::Row<OUT>],
        scale: Self::Scale,
        neuron: usize,
        sum: &mut Self,
    );
    /// Adds, to the sums of the neurons from `first` on, every input's weight times its value, in the order of the
    /// inputs.
    #[doc(hidden)]
    fn add_values<const OUT: usize>(
        rows: &[Self::Row<OUT>],
        scale: Self::Scale,
        values: &[Self::Value],
        first: usize,
        sums: &mut [Self],
    );
}

/// Whether the core is a Cortex-M0, with few registers and no long products; it is recognised by its lack of a
/// compare-and-swap. It does not affect results; `without_vectors` runs its code on a host, for tests.
pub(crate) const IS_SMALL: bool = !cfg!(target_has_atomic = "ptr") || cfg!(without_vectors);

/// Largest result of [`Number::outside`] for a number in its range.
pub(crate) const OUTSIDE: u32 = (1 << 30) - 1;

/// Largest weight, bias, threshold and reset value in `f32`.
pub(crate) const LARGEST: f32 = 1e15;

/// Largest value of an input in `f32`. No potential is ever infinite or NaN, however many steps are run: a step adds at
/// most 128 products of a value and a weight, 1.3e23, to a current. A current that is 2²⁵ times as large rounds the sum
/// to itself, and so does the potential, 2²⁵ times as large as the current: 1.5e38.
pub(crate) const LARGEST_VALUE: f32 = 1e6;

impl Sealed for f32 {}

impl Number for f32 {
    type Factor = Self;
    type Value = Self;
    type Row<const OUT: usize> = [Self; OUT];
    type Scale = ();
    const BLOCK: usize = if IS_SMALL { 2 } else { 4 };
    const MOST_ROWS: usize = usize::MAX;
    const MOST_SPIKES: usize = usize::MAX;

    #[inline(always)]
    fn scaled(self, factor: Self) -> Self {
        self * factor
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn outside(self) -> u32 {
        0
    }

    #[inline(always)]
    fn clamp(&mut self) -> u32 {
        0
    }

    #[inline(always)]
    fn accept(value: Self) -> Option<Self> {
        (value.abs() <= LARGEST_VALUE).then_some(value)
    }

    fn word(self) -> u32 {
        self.to_bits()
    }

    fn word_of_factor(factor: Self) -> u32 {
        factor.to_bits()
    }

    fn add_rows<const OUT: usize>(rows: &[[Self; OUT]], (): (), sum: &mut Checksum) {
        for weight in rows.as_flattened() {
            sum.add(weight.to_bits());
        }
    }

    #[inline(always)]
    fn sums<const W: usize, const OUT: usize>(
        start: impl FnOnce() -> [[Self; 4]; W],
        lists: [&[&[Self; OUT]]; 2],
        (): (),
        first: usize,
    ) -> [[Self; 4]; W] {
        let mut sums = start();
        for rows in lists {
            for row in rows {
                let Some(weights) = block::<_, W>(*row, first) else { continue };
                let each = sums.as_flattened_mut().iter_mut().zip(weights.as_flattened());
                for (sum, weight) in each {
                    *sum += weight;
                }
                black_box(()); // keeps the compiler from unrolling the loop
            }
        }
        sums
    }

    #[inline(always)]
    fn add_rows_to_one<const OUT: usize>(
        rows: &[&[Self; OUT]],
        (): (),
        neuron: usize,
        sum: &mut Self,
    ) {
        for row in rows {
            *sum += row.get(neuron).unwrap_or(&0.0);
        }
    }

    #[inline(always)]
    fn add_values<const OUT: usize>(
        rows: &[[Self; OUT]],
        (): (),
        values: &[Self],
        first: usize,
        sums: &mut [Self],
    ) {
        for (row, value) in rows.iter().zip(values) {
            for (sum, weight) in sums.iter_mut().zip(row.get(first..).unwrap_or_default()) {
                *sum += weight * value;
            }
        }
    }
}

/// Returns `W` groups of four numbers of a row, starting at group `first`.
#[inline(always)]
pub(crate) fn block<T, const W: usize>(row: &[T], first: usize) -> Option<&[[T; 4]; W]> {
    row.as_chunks().0.get(first..)?.first_chunk()
}

#[cfg(test)]
mod tests {
    use super::{LARGEST, LARGEST_VALUE};

    /// No number of steps brings a current or potential to infinity: from some size on, a sum is rounded to what it was.
    #[test]
    fn sums_end_before_infinity() {
        let step = 128.0 * LARGEST * LARGEST_VALUE;
        let current = step * (1 << 25) as f32;
        let potential = current * (1 << 25) as f32;
        assert_eq!((current + step, potential + current), (current, potential));
        assert!(potential.is_finite());
    }
}
