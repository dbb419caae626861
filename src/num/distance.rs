//! Arithmetic of the population codes: the bin of a value, its distance from a centre, and the mean of centres.

use bytemuck::Pod;

use super::convert::{floor, units};
use super::{DoubleDouble, EvenBins, Sample, SampleKind, word};

/// Arithmetic of centres and distances in one sample type.
pub(crate) trait Spaced: Sized {
    /// A distance from a centre, as tables store it: the bits of an `f32`, which sort as the distances do, or a
    /// count of [`parts`] of a unit in the last place.
    type Reach: Distance<Self> + Pod + core::fmt::Debug + Send + Sync;
    /// A distance of a value that [is near](Self::is_near) the range.
    type Short: Distance<Self>;
    /// A sum of centres, each times the level of its neuron.
    type Weighted: Copy + Default;

    /// Whether the distance of this value from every centre fits [`Short`](Self::Short). `near` comes from [`near`].
    fn is_near(&self, near: [Self; 2]) -> bool;

    /// Whether [`bin`](Self::bin) is quicker than a search: false for floats on a core without a float unit.
    const HAS_BINS: bool;

    /// The bin of this value.
    fn bin(self, bins: EvenBins) -> usize;

    /// Whether a finite value exceeds an edge. Compares integers, which is quick without a float unit.
    fn is_beyond(&self, edge: Self) -> bool;

    /// Adds the centre of a neuron, times its level, to the sum.
    fn weigh(sum: Self::Weighted, centre: Self, neuron: usize, level: u32) -> Self::Weighted;

    /// The mean of the centres by their levels: the sum over `levels`, which is the sum of the levels.
    fn mean(sum: Self::Weighted, levels: u32, neurons: usize, min: Self, max: Self) -> Self;
}

/// How far a value is from a centre.
pub(crate) trait Distance<S: Spaced>: Copy + PartialOrd {
    /// The distance of a value from a centre. `f32` takes the centre; integers compute it exactly from the neuron
    /// and the range, as a count of [`parts`].
    fn between(value: S, centre: S, neuron: usize, neurons: usize, min: S, max: S) -> Self;

    /// A distance of a table, in this type.
    fn of(reach: S::Reach) -> Self;
}

/// `count` bins of this width from this origin, both in [`units`].
pub(crate) const fn even_bins<S: Sample>(origin: f64, width: f64, count: usize) -> EvenBins {
    match S::KIND {
        SampleKind::F32 => EvenBins::of_floats(origin, width),
        // No value of 16 bits lies above this origin, and differences from it fit 32 bits.
        SampleKind::Fixed16 { .. } => EvenBins::of_integers(origin.min(32_768.0), width, count),
        SampleKind::Fixed32 { .. } => EvenBins::of_integers(origin, width, count),
    }
}

/// The bin of a value.
pub(crate) const fn bin_of<S: Sample>(bins: EvenBins, value: S) -> usize {
    match S::KIND {
        SampleKind::F32 => bins.of_float(units(value) as f32),
        SampleKind::Fixed16 { .. } => bins.of_short(units(value) as i16),
        SampleKind::Fixed32 { .. } => bins.of_integer(units(value) as i32),
    }
}

/// A distance in [`units`], as tables store it; rounded down in fixed point.
pub(crate) const fn reach<S: Sample>(distance: DoubleDouble, neurons: usize) -> S::Reach {
    let in_parts = distance.times(DoubleDouble::new(parts(neurons))).rounded();
    match S::KIND {
        SampleKind::F32 => word((distance.rounded() as f32).to_bits() as u64),
        SampleKind::Fixed16 { .. } => word(in_parts as i32 as u64),
        SampleKind::Fixed32 { .. } => word(in_parts as i64 as u64),
    }
}

/// An upper bound of the values within a reach of a centre, both in [`units`]. In `f32` it also covers values
/// whose distance is within the reach only after rounding.
pub(crate) const fn top<S: Sample>(centre: f64, reach: f64) -> S {
    let bits = match S::KIND {
        SampleKind::F32 => {
            let centre = centre as f32 as f64;
            ((centre + reach * (1.0 + 1e-6)) as f32).next_up().to_bits() as u64
        }
        SampleKind::Fixed16 { .. } => floor(centre + reach + 1e-3) as i16 as u64,
        SampleKind::Fixed32 { .. } => floor(centre + reach + 1e-3) as i32 as u64,
    };
    word(bits)
}

/// The lowest and the highest value whose distance from every centre fits 32 bits. The range is empty if `reach`,
/// the largest distance of the table, does not fit. All in [`units`]; only 32-bit fixed point uses it.
pub(crate) const fn near<S: Sample>(min: f64, max: f64, neurons: usize, reach: f64) -> [S; 2] {
    let parts = parts(neurons);
    let room = (i32::MAX as f64 - 2.0 * neurons as f64 * (max - min)) / parts - 1.0;
    let [low, high] = if reach * parts < i32::MAX as f64 && room > 0.0 {
        [(min - room) as i32, (min + room) as i32]
    } else {
        [i32::MAX, i32::MIN]
    };
    [word(low as u64), word(high as u64)]
}

/// How many parts a unit in the last place is divided into: in these parts every centre is a whole number.
const fn parts(neurons: usize) -> f64 {
    2.0 * (neurons as f64 - 2.0)
}

impl Spaced for f32 {
    type Reach = u32;
    type Short = u32;
    type Weighted = f32;

    #[inline]
    fn is_near(&self, _: [f32; 2]) -> bool {
        true
    }

    const HAS_BINS: bool = !cfg!(target_abi = "eabi");

    #[inline]
    fn bin(self, bins: EvenBins) -> usize {
        bins.of_float(self)
    }

    // `total_cmp` sorts -0 below 0, but no edge is -0: it is a sum, or the float below a sum.
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
    ([$($generics:tt)*] $sample:ty, $bits:ty, $reach:ty, $bin:ident, $is_near:expr, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Spaced for $sample {
            type Reach = $reach;
            type Short = i32;
            type Weighted = i32;

            #[inline]
            fn is_near(&self, near: [Self; 2]) -> bool {
                let is_near: fn($bits, [$bits; 2]) -> bool = $is_near;
                is_near($to_bits(*self), near.map($to_bits))
            }

            const HAS_BINS: bool = true;

            #[inline]
            fn bin(self, bins: EvenBins) -> usize {
                bins.$bin($to_bits(self))
            }

            #[inline]
            fn is_beyond(&self, edge: Self) -> bool {
                *self > edge
            }

            // With at most 1024 neurons of 256 levels, this sum and that of the levels fit 30 bits.
            #[inline]
            fn weigh(sum: i32, _: Self, neuron: usize, level: u32) -> i32 {
                sum.wrapping_add((neuron as i32).wrapping_mul(2).wrapping_sub(1).wrapping_mul(level as i32))
            }

            #[inline]
            fn mean(sum: i32, levels: u32, neurons: usize, min: Self, max: Self) -> Self {
                let parts = (neurons as i32).wrapping_sub(2).wrapping_mul(levels as i32);
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
    let quotient =
        ((dividend ^ sign) as u32).checked_div((parts as u32).wrapping_mul(2)).unwrap_or(0);
    min.saturating_add(quotient as i32 ^ sign)
}

#[cold]
fn long_mean(min: i32, max: i32, sum: i32, parts: i32) -> i32 {
    let [min, max, sum, parts] = [min, max, sum, parts].map(i64::from);
    let product = (max - min).wrapping_mul(sum).wrapping_add(parts);
    let value = product.div_euclid(2 * parts.max(1)).wrapping_add(min);
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
                let centre = (neuron as Self).wrapping_mul(2).wrapping_sub(1).wrapping_mul(range);
                let spacings = (neurons as Self).wrapping_sub(2);
                offset.wrapping_mul(spacings.wrapping_mul(2)).wrapping_sub(centre).wrapping_abs()
            }

            #[inline]
            fn of(reach: <$sample as Spaced>::Reach) -> Self {
                reach as Self
            }
        }
    };
}

integer!([] i16, i16, i32, of_short, |_, _| true, core::convert::identity, core::convert::identity);
distance!([] i16, i32, core::convert::identity);

#[cfg(feature = "fixed")]
mod fixed_point {
    use super::{Distance, EvenBins, Spaced, mean};
    use fixed::types::extra::{LeEqU16, LeEqU32};
    use fixed::{FixedI16, FixedI32};

    integer!([Frac: LeEqU16 + 'static] FixedI16<Frac>, i16, i32, of_short, |_, _| true,
        FixedI16::to_bits, FixedI16::from_bits);
    distance!([Frac: LeEqU16 + 'static] FixedI16<Frac>, i32, FixedI16::to_bits);

    integer!([Frac: LeEqU32 + 'static] FixedI32<Frac>, i32, i64, of_integer,
        |value, [low, high]| value >= low && value <= high,
        FixedI32::to_bits, FixedI32::from_bits);
    distance!([Frac: LeEqU32 + 'static] FixedI32<Frac>, i32, FixedI32::to_bits);
    distance!([Frac: LeEqU32 + 'static] FixedI32<Frac>, i64, FixedI32::to_bits);
}
