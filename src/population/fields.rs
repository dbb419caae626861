//! Gaussian receptive fields of equal width, as distances instead of exponentials.

use super::centres::{Centres, check_range};
use crate::curve::{ln, sqrt};
use crate::error::{checked, positive};
use crate::sample::{for_each_integer, for_each_sample};
use crate::{ConfigError, Sample};

/// `M` neurons, 3 to 1024, whose responses to a value are told apart in `N` levels, 2 to 256. Kept in
/// flash and shared.
///
/// The response is `r = exp(-(x - mu)² / (2 sigma²))` with even centres and
/// `sigma = (max - min) / (beta (M - 2))`; its level is `N r`, rounded half up. A level is reached
/// within a distance from the centre, so that a table of `N` distances replaces the exponential.
///
/// - **Memory:** `8 M + 4 N` bytes of flash in `f32`.
/// - **Exactness:** `f32` compares the distance to the rounded centre, rounded once, with the
///   rounded table; fixed point compares exact distances to the unrounded centre.
///
/// Source: Bohté et al. 2002; paper, section II-A.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ReceptiveFields<S: Sample, const M: usize, const N: usize> {
    centres: Centres<S, M>,
    min: S,
    max: S,
    beta: f32,
    /// `reaches[k]` is the largest distance with a level above `k`: falling.
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
        let reaches = core::array::from_fn(|k| {
            S::reach(radius(min.to_f64(), max.to_f64(), width, M, k + 1, N), M)
        });
        Ok(Self { centres, min, max, beta, reaches })
    }

    /// The centres, lowest first.
    pub fn centres(&self) -> &[S; M] {
        self.centres.as_array()
    }

    pub(super) fn table(&self) -> &Centres<S, M> {
        &self.centres
    }

    /// How far a value is from a centre, in the unit of the table.
    #[inline]
    fn distance(&self, value: S, neuron: usize) -> Option<S::Reach> {
        let centre = self.centres.get(neuron)?;
        Some(S::distance(value, centre, neuron, M, self.min, self.max))
    }

    /// The level of a neuron's response, 0 to `N`.
    #[inline]
    pub(super) fn level(&self, value: S, neuron: usize) -> usize {
        self.distance(value, neuron)
            .map_or(0, |distance| self.reaches.partition_point(|&reach| distance <= reach))
    }

    /// Whether a neuron's response has at least this level, 1 to `N`.
    #[inline]
    pub(super) fn reaches(&self, value: S, neuron: usize, level: usize) -> bool {
        match (self.distance(value, neuron), self.reaches.get(level.wrapping_sub(1))) {
            (Some(distance), Some(reach)) => distance <= *reach,
            _ => false,
        }
    }

    /// The neurons, from the first, whose response to a finite value has at least this level.
    #[inline]
    pub(super) fn responding(&self, value: S, level: usize) -> impl Iterator<Item = usize> {
        let mut first = self.centres.nearest(value);
        while first > 0 && self.reaches(value, first - 1, level) {
            first -= 1;
        }
        // Halfway between two centres rounding may leave only the other within reach.
        if !self.reaches(value, first, level) {
            first += 1;
        }
        (first..M).take_while(move |&neuron| self.reaches(value, neuron, level))
    }

    /// The mean of the centres weighted by their levels, or `None` without any.
    pub(super) fn mean(&self, levels: impl Iterator<Item = (usize, u32)>) -> Option<S> {
        let mut weighted = S::Weighted::default();
        let mut total = 0;
        for (neuron, level) in levels {
            weighted = S::weigh(weighted, self.centres.get(neuron)?, neuron, level);
            total += level;
        }
        (total > 0).then(|| S::mean(weighted, total, M, self.min, self.max))
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path, $reach:path, $scale:path) => {
        // Constants are built by index: there are no iterators in constants.
        #[allow(clippy::indexing_slicing)]
        impl<const M: usize, const N: usize, $($generics)*> ReceptiveFields<$sample, M, N> {
            /// For constants: [`new`](Self::new). Parameters that make no sense fail the build.
            ///
            /// # Panics
            /// As `new` fails; at compile time where it initialises a constant.
            pub const fn checked(min: $sample, max: $sample, beta: f32) -> Self {
                const { Self::SHAPE };
                let width = beta as f64;
                checked!(positive("beta", width));
                checked!(check_range($to_f64(min), $to_f64(max)));
                let mut reaches = [$reach(0.0, M); N];
                let mut k = 0;
                while k < N {
                    reaches[k] = $reach(radius($to_f64(min), $to_f64(max), width, M, k + 1, N), M);
                    k += 1;
                }
                Self { centres: Centres::<$sample, M>::linear(min, max), min, max, beta, reaches }
            }
        }
    };
}
for_each_sample!(constants);

/// The sample type's part in the receptive fields. Sealed: only this crate can name it.
pub trait Spaced: Sized {
    /// A distance from a centre: `f32`, or an integer in units of the type's last place over
    /// `2 (M - 2)`, in which every centre is whole.
    type Reach: Copy + PartialOrd + core::fmt::Debug;
    /// Centres times levels, summed.
    type Weighted: Default;

    /// The largest distance in the table's unit that is not above this one in the samples' unit.
    fn reach(distance: f64, neurons: usize) -> Self::Reach;

    fn distance(
        self,
        centre: Self,
        neuron: usize,
        neurons: usize,
        min: Self,
        max: Self,
    ) -> Self::Reach;

    /// What [`spacings`](Self::spacings) takes for even centres over this range.
    fn scale(min: f64, max: f64, neurons: usize) -> Self;

    /// How many whole spacings this lies above the lowest edge, or less by what rounding loses; 0
    /// below it.
    fn spacings(self, lowest: Self, scale: Self) -> usize;

    fn weigh(sum: Self::Weighted, centre: Self, neuron: usize, level: u32) -> Self::Weighted;

    fn mean(sum: Self::Weighted, levels: u32, neurons: usize, min: Self, max: Self) -> Self;
}

impl Spaced for f32 {
    type Reach = f32;
    type Weighted = f32;

    fn reach(distance: f64, neurons: usize) -> f32 {
        crate::sample::f32_reach(distance, neurons)
    }

    #[inline]
    fn distance(self, centre: f32, _: usize, _: usize, _: f32, _: f32) -> f32 {
        (self - centre).abs()
    }

    fn scale(min: f64, max: f64, neurons: usize) -> f32 {
        crate::sample::f32_scale(min, max, neurons)
    }

    #[inline]
    fn spacings(self, lowest: f32, scale: f32) -> usize {
        ((self - lowest) * scale) as u32 as usize
    }

    #[inline]
    fn weigh(sum: f32, centre: f32, _: usize, level: u32) -> f32 {
        sum + centre * level as f32
    }

    #[inline]
    fn mean(sum: f32, levels: u32, _: usize, _: f32, _: f32) -> f32 {
        sum / levels as f32
    }
}

macro_rules! integer_spaced {
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path,
     $to_f64:path, $nearest:path, $floor:path, $reach:path, $scale:path) => {
        integer_spaced!(@ [$($generics)*] $sample, i16, i32, $to_bits, $from_bits, $reach, $scale);
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path,
     $to_f64:path, $nearest:path, $floor:path, $reach:path, $scale:path) => {
        integer_spaced!(@ [$($generics)*] $sample, i32, i64, $to_bits, $from_bits, $reach, $scale);
    };
    (@ [$($generics:tt)*] $sample:ty, $bits:ty, $wide:ty, $to_bits:path, $from_bits:path,
     $reach:path, $scale:path) => {
        impl<$($generics)*> Spaced for $sample {
            type Reach = $wide;
            type Weighted = i64;

            fn reach(distance: f64, neurons: usize) -> $wide {
                $reach(distance, neurons)
            }

            #[inline]
            fn distance(self, _: Self, neuron: usize, neurons: usize, min: Self, max: Self) -> $wide {
                let min = <$wide>::from($to_bits(min));
                let offset = <$wide>::from($to_bits(self)) - min;
                let range = <$wide>::from($to_bits(max)) - min;
                (2 * (neurons as $wide - 2) * offset - (2 * neuron as $wide - 1) * range).abs()
            }

            fn scale(min: f64, max: f64, neurons: usize) -> Self {
                $scale(min, max, neurons)
            }

            // A 16-bit scale has no upper half, and no shift.
            #[inline]
            fn spacings(self, lowest: Self, scale: Self) -> usize {
                if self <= lowest {
                    return 0;
                }
                let above = i32::from($to_bits(self)).wrapping_sub(i32::from($to_bits(lowest))) as u32;
                let scale = i32::from($to_bits(scale)) as u32;
                let scaled = (above >> (scale >> 16)).min(0xffff) * (scale & 0xffff);
                (scaled >> 16) as usize
            }

            #[inline]
            fn weigh(sum: i64, _: Self, neuron: usize, level: u32) -> i64 {
                sum + (2 * neuron as i64 - 1) * i64::from(level)
            }

            #[inline]
            fn mean(sum: i64, levels: u32, neurons: usize, min: Self, max: Self) -> Self {
                let min = i64::from($to_bits(min));
                let range = i64::from($to_bits(max)) - min;
                let parts = (neurons as i64 - 2) * i64::from(levels);
                // The nearest, halves upwards: floor of the quotient and a half.
                let value = min + (range * sum + parts).div_euclid(2 * parts.max(1));
                $from_bits(value.clamp(<$bits>::MIN.into(), <$bits>::MAX.into()) as $bits)
            }
        }
    };
}
for_each_integer!(integer_spaced);
