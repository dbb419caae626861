//! The sample types' part in the population codes.

use super::cells::Cells;
use super::centres::Centres;
use super::fields::ReceptiveFields;
use crate::Sample;

/// The sample type's part in the population codes. Sealed: only this crate can name it.
pub trait Spaced: Sized {
    /// A distance from a centre, in tables: the bits of an `f32`, which have its order, or an integer in
    /// units of the type's last place over `2 (M - 2)`, in which every centre is whole.
    type Reach: Distance<Self> + core::fmt::Debug;
    /// The same of values near the range.
    type Short: Distance<Self>;
    /// Which values are.
    type Near: Copy + PartialEq + core::fmt::Debug;
    /// Centres times levels, summed.
    type Weighted: Default;

    /// Whether every distance of this value fits [`Short`](Self::Short).
    fn is_near(&self, near: Self::Near) -> bool;

    /// Whether a multiplication is quicker than a search: not where floats have no unit.
    const HAS_CELLS: bool;

    fn cell(self, cells: Cells) -> usize;

    /// Whether a finite value exceeds an edge, by whole numbers: quick where floats have no unit.
    fn is_beyond(&self, edge: Self) -> bool;

    /// Centres with the table for their edges.
    fn centres<const M: usize>(values: [Self; M], edges: [Self; M]) -> Centres<Self, M>;

    /// Receptive fields with their table, around even centres.
    fn fields<const M: usize, const N: usize>(
        centres: [Self; M],
        min: Self,
        max: Self,
        beta: f32,
    ) -> ReceptiveFields<Self, M, N>
    where
        Self: Sample;

    fn weigh(sum: Self::Weighted, centre: Self, neuron: usize, level: u32) -> Self::Weighted;

    fn mean(sum: Self::Weighted, levels: u32, neurons: usize, min: Self, max: Self) -> Self;
}

/// How far a value is from a centre.
pub trait Distance<S: Spaced>: Copy + PartialOrd {
    fn between(value: S, centre: S, neuron: usize, neurons: usize, min: S, max: S) -> Self;

    fn of(reach: S::Reach) -> Self;
}

/// Calls a macro once for each sample type with its generics, its set-up conversions, the conversion to its
/// raw number, and the module with what is computed of that: constructors can be `const fn`, which trait
/// methods cannot be.
macro_rules! for_each_spaced {
    ($callback:ident) => {
        $callback! { [] f32, $crate::sample::f32_to_f64, $crate::sample::f32_nearest,
        $crate::sample::f32_floor, core::convert::identity, float }
        $callback! { [] i16, $crate::sample::i16_to_f64, $crate::sample::i16_nearest,
        $crate::sample::i16_floor, core::convert::identity, short }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU16 + 'static] fixed::FixedI16<Frac>,
        $crate::sample::fixed16_to_f64, $crate::sample::fixed16_nearest,
        $crate::sample::fixed16_floor, fixed::FixedI16::to_bits, short }
        #[cfg(feature = "fixed")]
        $callback! { [Frac: fixed::types::extra::LeEqU32 + 'static] fixed::FixedI32<Frac>,
        $crate::sample::fixed32_to_f64, $crate::sample::fixed32_nearest,
        $crate::sample::fixed32_floor, fixed::FixedI32::to_bits, long }
    };
}
pub(super) use for_each_spaced;

/// Set-up in `f32`.
pub(super) mod float {
    use super::Cells;

    pub(crate) const fn units(value: f32) -> f64 {
        value as f64
    }

    pub(crate) const fn cells(origin: f64, width: f64, count: usize) -> Cells {
        Cells::of_floats(origin, width, count)
    }

    pub(crate) const fn cell(cells: Cells, value: f32) -> usize {
        cells.of_float(value)
    }

    /// Not below the largest value whose rounded distance from a centre may be within a reach.
    pub(crate) const fn top(centre: f64, reach: f64) -> f32 {
        let centre = centre as f32 as f64;
        ((centre + reach * (1.0 + 1e-6)) as f32).next_up()
    }

    pub(crate) const fn reach(distance: f64, _: usize) -> u32 {
        (distance as f32).to_bits()
    }

    pub(crate) const fn near(_: f64, _: f64, _: usize, _: u32) {}
}

/// Set-up in integers of 16 bits, in units of the last place.
pub(super) mod short {
    use super::Cells;
    use crate::sample::floor;

    pub(crate) const fn units(value: i16) -> f64 {
        value as f64
    }

    pub(crate) const fn cells(origin: f64, width: f64, count: usize) -> Cells {
        Cells::of_integers(origin, width, count)
    }

    pub(crate) const fn cell(cells: Cells, value: i16) -> usize {
        cells.of_integer(value as i32)
    }

    /// The largest value within a reach of a centre.
    pub(crate) const fn top(centre: f64, reach: f64) -> i16 {
        floor(centre + reach + 1e-3) as i16
    }

    pub(crate) const fn reach(distance: f64, neurons: usize) -> i32 {
        (distance * super::parts(neurons)) as i32
    }

    pub(crate) const fn near(_: f64, _: f64, _: usize, _: i32) {}
}

/// Set-up in integers of 32 bits, in units of the last place.
#[cfg(feature = "fixed")]
pub(super) mod long {
    use super::Cells;
    use crate::sample::floor;

    pub(crate) const fn units(value: i32) -> f64 {
        value as f64
    }

    pub(crate) const fn cells(origin: f64, width: f64, count: usize) -> Cells {
        Cells::of_integers(origin, width, count)
    }

    pub(crate) const fn cell(cells: Cells, value: i32) -> usize {
        cells.of_integer(value)
    }

    /// The largest value within a reach of a centre.
    pub(crate) const fn top(centre: f64, reach: f64) -> i32 {
        floor(centre + reach + 1e-3) as i32
    }

    pub(crate) const fn reach(distance: f64, neurons: usize) -> i64 {
        (distance * super::parts(neurons)) as i64
    }

    /// The lowest and the highest value whose distances from every centre fit 32 bits: none, if a reach
    /// does not.
    pub(crate) const fn near(min: f64, max: f64, neurons: usize, reach: i64) -> [i32; 2] {
        let parts = super::parts(neurons);
        let room = (i32::MAX as f64 - 2.0 * neurons as f64 * (max - min)) / parts - 1.0;
        if reach < i32::MAX as i64 && room > 0.0 {
            [(min - room) as i32, (min + room) as i32]
        } else {
            [i32::MAX, i32::MIN]
        }
    }
}

/// Into how many parts a centre divides the unit.
const fn parts(neurons: usize) -> f64 {
    2.0 * (neurons as f64 - 2.0)
}

macro_rules! assembled {
    () => {
        fn centres<const M: usize>(values: [Self; M], edges: [Self; M]) -> Centres<Self, M> {
            Centres::<Self, M>::with_cells(values, edges)
        }

        fn fields<const M: usize, const N: usize>(
            centres: [Self; M],
            min: Self,
            max: Self,
            beta: f32,
        ) -> ReceptiveFields<Self, M, N> {
            ReceptiveFields::<Self, M, N>::with_table(centres, min, max, beta)
        }
    };
}

impl Spaced for f32 {
    type Reach = u32;
    type Short = u32;
    type Near = ();
    type Weighted = f32;

    assembled!();

    #[inline]
    fn is_near(&self, (): ()) -> bool {
        true
    }

    const HAS_CELLS: bool = !cfg!(target_abi = "eabi");

    #[inline]
    fn cell(self, cells: Cells) -> usize {
        cells.of_float(self)
    }

    // No edge is -0: it is a sum or a float below one.
    #[inline]
    fn is_beyond(&self, edge: f32) -> bool {
        self.total_cmp(&edge).is_gt()
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

impl Distance<f32> for u32 {
    #[inline]
    fn between(value: f32, centre: f32, _: usize, _: usize, _: f32, _: f32) -> u32 {
        (value - centre).abs().to_bits()
    }

    #[inline]
    fn of(reach: u32) -> u32 {
        reach
    }
}

macro_rules! integer {
    ([$($generics:tt)*] $sample:ty, $bits:ty, $reach:ty, $near:ty, $is_near:expr, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Spaced for $sample {
            type Reach = $reach;
            type Short = i32;
            type Near = $near;
            type Weighted = i32;

            assembled!();

            #[inline]
            fn is_near(&self, near: $near) -> bool {
                let is_near: fn($bits, $near) -> bool = $is_near;
                is_near($to_bits(*self), near)
            }

            const HAS_CELLS: bool = true;

            #[inline]
            fn cell(self, cells: Cells) -> usize {
                cells.of_integer($to_bits(self).into())
            }

            #[inline]
            fn is_beyond(&self, edge: Self) -> bool {
                *self > edge
            }

            // At most 1024 neurons of 256 levels: neither this nor the sum of levels leaves 30 bits.
            #[inline]
            fn weigh(sum: i32, _: Self, neuron: usize, level: u32) -> i32 {
                sum + (2 * neuron as i32 - 1) * level as i32
            }

            #[inline]
            fn mean(sum: i32, levels: u32, neurons: usize, min: Self, max: Self) -> Self {
                let parts = (neurons as i32 - 2) * levels as i32;
                let value = mean($to_bits(min).into(), $to_bits(max).into(), sum, parts);
                $from_bits(value.clamp(<$bits>::MIN.into(), <$bits>::MAX.into()) as $bits)
            }
        }
    };
}

/// `min + (max - min) * sum / (2 * parts)`, to the nearest, halves upwards, saturating. Where 32 bits have room
/// for the product, the division is one of 32 bits.
fn mean(min: i32, max: i32, sum: i32, parts: i32) -> i32 {
    let product = max.checked_sub(min).and_then(|range| range.checked_mul(sum));
    let Some(dividend) = product.and_then(|product| product.checked_add(parts)) else {
        return long_mean(min, max, sum, parts);
    };
    // The floor, also of a negative quotient.
    let sign = dividend >> 31;
    let quotient = ((dividend ^ sign) as u32).checked_div(2 * parts as u32).unwrap_or(0);
    min.saturating_add(quotient as i32 ^ sign)
}

#[cold]
fn long_mean(min: i32, max: i32, sum: i32, parts: i32) -> i32 {
    let [min, max, sum, parts] = [min, max, sum, parts].map(i64::from);
    let value = min + ((max - min) * sum + parts).div_euclid(2 * parts.max(1));
    value.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

macro_rules! distance {
    ([$($generics:tt)*] $sample:ty, $distance:ty, $to_bits:path) => {
        impl<$($generics)*> Distance<$sample> for $distance {
            #[inline]
            fn between(
                value: $sample,
                _: $sample,
                neuron: usize,
                neurons: usize,
                min: $sample,
                max: $sample,
            ) -> Self {
                let min = Self::from($to_bits(min));
                let offset = Self::from($to_bits(value)).wrapping_sub(min);
                let range = Self::from($to_bits(max)).wrapping_sub(min);
                let centre = (2 * neuron as Self - 1).wrapping_mul(range);
                offset.wrapping_mul(2 * (neurons as Self - 2)).wrapping_sub(centre).wrapping_abs()
            }

            #[inline]
            fn of(reach: <$sample as Spaced>::Reach) -> Self {
                reach as Self
            }
        }
    };
}

integer!([] i16, i16, i32, (), |_, ()| true, core::convert::identity, core::convert::identity);
distance!([] i16, i32, core::convert::identity);

#[cfg(feature = "fixed")]
mod fixed_point {
    use super::{Cells, Centres, Distance, ReceptiveFields, Spaced, mean};
    use fixed::types::extra::{LeEqU16, LeEqU32};
    use fixed::{FixedI16, FixedI32};

    integer!([Frac: LeEqU16 + 'static] FixedI16<Frac>, i16, i32, (), |_, ()| true,
        FixedI16::to_bits, FixedI16::from_bits);
    distance!([Frac: LeEqU16 + 'static] FixedI16<Frac>, i32, FixedI16::to_bits);

    integer!([Frac: LeEqU32 + 'static] FixedI32<Frac>, i32, i64, [i32; 2],
        |value, [low, high]| value >= low && value <= high,
        FixedI32::to_bits, FixedI32::from_bits);
    distance!([Frac: LeEqU32 + 'static] FixedI32<Frac>, i32, FixedI32::to_bits);
    distance!([Frac: LeEqU32 + 'static] FixedI32<Frac>, i64, FixedI32::to_bits);
}
