//! Arithmetic of receptive fields of different widths: distances in widths of a field, and means of their centres.

use core::fmt::Debug;

use bytemuck::Pod;

use super::arithmetic::for_each_integer;
use super::convert::{floor_from_f64, one};
use super::{Sample, SampleKind, word};

/// What a sample type computes of a field.
pub(crate) trait Field: Sized {
    /// `1 / sigma` as the bits of an `f32`; or the integer `2³² / sigma`, with `sigma` in units of the last place.
    type Scale: Pod + PartialEq + Debug + Send + Sync;
    /// `|x - mu| / sigma` as the bits of an `f32`, which sort as it does; or the integer `2³² |x - mu| / sigma`.
    type Widths: Pod + Ord + Debug + Send + Sync;
    /// A sum of levels, each times a centre (`f32`) or the distance of a centre from the lowest one (integers).
    type Centroid: Copy + Default;

    /// `|x - mu|` as the bits of an `f32`, which sort as it does; or an integer in units of the last place.
    fn distance(self, centre: Self) -> u32;

    /// Halfway to a higher value, rounded down; in `f32` to the nearest.
    fn midway(self, higher: Self) -> Self;

    /// The next larger value, for any value but the largest; in `f32` the value itself.
    fn next(self) -> Self;

    /// A distance in widths, for distances up to about four widths.
    fn in_widths(distance: u32, scale: Self::Scale) -> Self::Widths;

    /// Adds a centre times a level. No centre is below `lowest`.
    fn add_centre(sum: Self::Centroid, centre: Self, lowest: Self, level: u32) -> Self::Centroid;

    /// The mean, rounded to the nearest, halves upwards; `levels` is above 0.
    fn mean_of(sum: Self::Centroid, lowest: Self, levels: u32) -> Self;
}

/// Four widths, times 2³²: no level reaches as far.
const FAR: f64 = 17_179_869_184.0;

/// `1 / sigma`; in fixed point rounded half up, and at most [`FAR`], at which only the centre itself responds.
pub(crate) const fn scale<S: Sample>(sigma: f64) -> S::Scale {
    if matches!(S::KIND, SampleKind::F32) {
        return word(((1.0 / sigma) as f32).to_bits() as u64);
    }
    let scale = 4_294_967_296.0 / (sigma / one::<S>());
    word(if scale < FAR { (scale + 0.5) as u64 } else { FAR as u64 })
}

/// A number of widths, rounded down.
pub(crate) const fn widths<S: Sample>(widths: f64) -> S::Widths {
    match S::KIND {
        SampleKind::F32 => word(floor_from_f64::<f32>(widths).to_bits() as u64),
        _ => word((widths * 4_294_967_296.0) as u64),
    }
}

/// The largest distance from the centre that is at most `widths` widths of a field.
pub(crate) const fn within_widths<S: Sample>(widths: S::Widths, scale: S::Scale) -> u32 {
    let (widths, scale) = (number(widths), number(scale));
    if !matches!(S::KIND, SampleKind::F32) {
        return match widths.checked_div(scale) {
            Some(distance) if distance < u32::MAX as u64 => distance as u32,
            _ => u32::MAX,
        };
    }
    let (widths, scale) = (f32::from_bits(widths as u32), f32::from_bits(scale as u32));
    let near = widths as f64 / scale as f64;
    let mut distance = if near < f32::MAX as f64 { near as f32 } else { f32::MAX };
    while distance > 0.0 && distance * scale > widths {
        distance = distance.next_down();
    }
    while distance < f32::MAX && distance.next_up() * scale <= widths {
        distance = distance.next_up();
    }
    distance.to_bits()
}

/// The unsigned integer of 4 or 8 bytes.
const fn number<T: Pod>(value: T) -> u64 {
    let values = [value];
    let bytes: &[u8] = bytemuck::must_cast_slice(&values);
    if let Some(words) = bytes.first_chunk() {
        return u64::from_ne_bytes(*words);
    }
    match bytes.first_chunk() {
        Some(word) => u32::from_ne_bytes(*word) as u64,
        None => 0,
    }
}

impl Field for f32 {
    type Scale = u32;
    type Widths = u32;
    type Centroid = f32;

    #[inline]
    fn distance(self, centre: f32) -> u32 {
        (self - centre).abs().to_bits()
    }

    #[inline]
    fn midway(self, higher: f32) -> f32 {
        (self + higher) * 0.5
    }

    #[inline]
    fn next(self) -> f32 {
        self
    }

    #[inline]
    fn in_widths(distance: u32, scale: u32) -> u32 {
        (f32::from_bits(distance) * f32::from_bits(scale)).to_bits()
    }

    #[inline]
    fn add_centre(sum: f32, centre: f32, _: f32, level: u32) -> f32 {
        sum + centre * level as f32
    }

    #[inline]
    fn mean_of(sum: f32, _: f32, levels: u32) -> f32 {
        sum / levels as f32
    }
}

/// `sum / levels`, rounded to the nearest, halves upwards: by a division of 32 bits where that will do.
#[inline]
fn mean(sum: u64, levels: u32) -> u32 {
    let (dividend, divisor) =
        (sum.wrapping_mul(2).wrapping_add(levels.into()), levels.wrapping_mul(2));
    match u32::try_from(dividend) {
        Ok(dividend) => dividend.checked_div(divisor).unwrap_or(0),
        Err(_) => long_division(dividend, divisor),
    }
}

#[cold]
fn long_division(dividend: u64, divisor: u32) -> u32 {
    dividend.checked_div(divisor.into()).unwrap_or(0) as u32
}

macro_rules! integer_field {
    ([$($generics:tt)*] $sample:ty, $bits:ty, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Field for $sample {
            type Scale = u64;
            type Widths = u64;
            type Centroid = u64;

            #[inline]
            fn distance(self, centre: Self) -> u32 {
                $to_bits(self).abs_diff($to_bits(centre)).into()
            }

            // The bits that both have, and half of the bits that one of them has: no sum overflows.
            #[inline]
            fn midway(self, higher: Self) -> Self {
                let (low, high) = ($to_bits(self), $to_bits(higher));
                $from_bits((low & high).wrapping_add((low ^ high) >> 1))
            }

            #[inline]
            fn next(self) -> Self {
                $from_bits($to_bits(self).wrapping_add(1))
            }

            #[inline]
            fn in_widths(distance: u32, scale: u64) -> u64 {
                u64::from(distance).wrapping_mul(scale)
            }

            // At most 1024 neurons of 256 levels: the sum stays below 2^50.
            #[inline]
            fn add_centre(sum: u64, centre: Self, lowest: Self, level: u32) -> u64 {
                let above: u32 = $to_bits(centre).abs_diff($to_bits(lowest)).into();
                sum.wrapping_add(u64::from(above).wrapping_mul(level.into()))
            }

            #[inline]
            fn mean_of(sum: u64, lowest: Self, levels: u32) -> Self {
                $from_bits($to_bits(lowest).wrapping_add(mean(sum, levels) as $bits))
            }
        }
    };
}
for_each_integer!(integer_field);
