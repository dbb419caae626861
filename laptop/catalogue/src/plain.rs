//! What the plain transcriptions share: their number types, and decoders of several codes.
//!
//! A transcription is the paper's pseudo-code, with its slips of sign and index corrected; it works on whole
//! recordings, one index after the other. The codecs are measured against it, in the same sample type, for the same
//! core, with the same compiler.

#![allow(clippy::needless_range_loop)] // index by index, as the pseudo-code

use core::ops::{Add, AddAssign, Div, Mul, Sub, SubAssign};

use fixed::{
    FixedI16, FixedI32, FixedI64,
    types::extra::{U8, U16},
};
use spikewire::Sample;

/// A number type with the arithmetic of the pseudo-code; sums and products are computed in the type `Wide`.
pub trait Plain: Sample + Into<Self::Wide> {
    /// The type of sums and products.
    type Wide: Copy
        + Default
        + PartialOrd
        + Add<Output = Self::Wide>
        + Sub<Output = Self::Wide>
        + Mul<Output = Self::Wide>
        + Div<Output = Self::Wide>
        + AddAssign
        + SubAssign;

    /// How far a mean of centres may be off, as integers hold neither the mean nor the centres exactly.
    const MEAN: f64;

    /// Converts a number.
    fn wide(value: f64) -> Self::Wide;
    /// Converts a count.
    fn count(count: i16) -> Self::Wide;
    /// Converts back to the sample type, in which the value must fit.
    fn narrow(wide: Self::Wide) -> Self;
    /// Doubles the value `times` times.
    fn doubled(wide: Self::Wide, times: u8) -> Self::Wide;
    /// Halves the value `times` times; integers round down.
    fn halved(wide: Self::Wide, times: u8) -> Self::Wide;
    /// Halves the value `times` times; integers round to the nearest, halves upwards.
    fn halved_to_nearest(wide: Self::Wide, times: u8) -> Self::Wide;
    /// Returns whether a 16-bit draw falls below a share of the range: `2^17 part >= (2 draw + 1) range`.
    fn is_drawn(part: Self::Wide, range: Self::Wide, draw: u32) -> bool;
}

impl Plain for f32 {
    type Wide = f32;

    const MEAN: f64 = 0.0;

    fn wide(value: f64) -> f32 {
        value as f32
    }

    fn count(count: i16) -> f32 {
        count.into()
    }

    fn narrow(wide: f32) -> f32 {
        wide
    }

    fn doubled(wide: f32, times: u8) -> f32 {
        wide * (1_u32 << times) as f32
    }

    fn halved(wide: f32, times: u8) -> f32 {
        wide / (1_u32 << times) as f32
    }

    fn halved_to_nearest(wide: f32, times: u8) -> f32 {
        Self::halved(wide, times)
    }

    fn is_drawn(part: f32, range: f32, draw: u32) -> bool {
        131_072.0 * part >= (2 * draw + 1) as f32 * range
    }
}

impl Plain for i16 {
    type Wide = i32;

    const MEAN: f64 = 1.0;

    fn wide(value: f64) -> i32 {
        value as i32
    }

    fn count(count: i16) -> i32 {
        count.into()
    }

    fn narrow(wide: i32) -> i16 {
        wide as i16
    }

    fn doubled(wide: i32, times: u8) -> i32 {
        wide << times
    }

    fn halved(wide: i32, times: u8) -> i32 {
        wide >> times
    }

    fn halved_to_nearest(wide: i32, times: u8) -> i32 {
        (wide + (1 << times) / 2) >> times
    }

    fn is_drawn(part: i32, range: i32, draw: u32) -> bool {
        i64::from(part) << 17 >= i64::from(2 * draw + 1) * i64::from(range)
    }
}

/// Implements the arithmetic for fixed point; sums and products have twice as many bits.
macro_rules! fixed_point {
    ($own:ty, $bits:ty, $wide:ident<$fraction:ty>, $mean:expr) => {
        impl Plain for $own {
            type Wide = $wide<$fraction>;

            const MEAN: f64 = $mean;

            fn wide(value: f64) -> Self::Wide {
                $wide::from_num(value)
            }

            fn count(count: i16) -> Self::Wide {
                $wide::from_num(count)
            }

            fn narrow(wide: Self::Wide) -> Self {
                Self::from_bits(wide.to_bits() as $bits)
            }

            fn doubled(wide: Self::Wide, times: u8) -> Self::Wide {
                wide << times
            }

            fn halved(wide: Self::Wide, times: u8) -> Self::Wide {
                wide >> times
            }

            fn halved_to_nearest(wide: Self::Wide, times: u8) -> Self::Wide {
                (wide + $wide::from_bits((1 << times) / 2)) >> times
            }

            fn is_drawn(part: Self::Wide, range: Self::Wide, draw: u32) -> bool {
                let [part, range] = [part, range].map(|own| i64::from(own.to_bits()));
                part << 17 >= i64::from(2 * draw + 1) * range
            }
        }
    };
}

fixed_point!(FixedI16<U8>, i16, FixedI32<U8>, 1.0 / 256.0);
fixed_point!(FixedI32<U16>, i32, FixedI64<U16>, 1.0 / 65_536.0);

/// Returns the absolute value.
pub fn magnitude<W: Copy + Default + PartialOrd + Sub<Output = W>>(value: W) -> W {
    if value < W::default() { W::default() - value } else { value }
}

/// Decodes a temporal code.
#[inline(never)]
pub fn step_decode<S: Plain>(spikes: &[i8], step: S, values: &mut [S]) {
    let mut value = S::Wide::default();
    for i in 0..spikes.len() {
        if spikes[i] == 1 {
            value += step.into();
        } else if spikes[i] == -1 {
            value -= step.into();
        }
        values[i] = S::narrow(value);
    }
}

/// Returns how far a sample is above the minimum, clamped to the range.
pub fn above_min<S: Plain>(x: S, min: S, max: S) -> S::Wide {
    if x < min {
        S::Wide::default()
    } else if x > max {
        max.into() - min.into()
    } else {
        x.into() - min.into()
    }
}

/// Decodes spikes by their mean over a window of `2^power` samples.
#[inline(never)]
pub fn window_decode<S: Plain>(spikes: &[i8], min: S, max: S, power: u8, values: &mut [S]) {
    let range = max.into() - min.into();
    for i in 0..spikes.len() {
        let mut count = 0;
        for j in 0..1 << power {
            if i >= j && spikes[i - j] == 1 {
                count += 1;
            }
        }
        values[i] = S::narrow(min.into() + S::halved_to_nearest(S::count(count) * range, power));
    }
}

/// Decodes spikes by a running average, in which a spike directly after `g` others weighs `unit * 2^g`, with `g` up to
/// `doublings`.
#[inline(never)]
pub fn average_decode<S: Plain>(
    spikes: &[i8],
    min: S,
    max: S,
    (unit, doublings): (S::Wide, u8),
    power: u8,
    values: &mut [S],
) {
    let mut average = S::doubled(max.into() - min.into(), power - 1);
    let mut gain = 0;
    for i in 0..spikes.len() {
        average = average - S::halved(average, power);
        if spikes[i] == 1 {
            average += S::doubled(unit, gain);
            gain = doublings.min(gain + 1);
        } else {
            gain = 0;
        }
        values[i] = S::narrow(min.into() + S::halved(average, power));
    }
}

/// Decodes a rate code by a convolution, the oldest spike first.
#[inline(never)]
pub fn rate_decode<S: Plain>(spikes: &[i8], filter: &[S], shift: S, values: &mut [S]) {
    for i in 0..spikes.len() {
        let mut value = S::Wide::default();
        for j in (0..filter.len()).rev() {
            if i >= j && spikes[i - j] == 1 {
                value += filter[j].into();
            }
        }
        values[i] = S::narrow(value + shift.into());
    }
}

/// Decodes to the centre of the neuron that fired.
#[inline(never)]
pub fn position_decode<S: Plain>(neurons: &[i8], centres: &[S], values: &mut [S]) {
    for i in 0..neurons.len() {
        values[i] = centres[neurons[i] as usize];
    }
}

/// Returns the response of a Gaussian receptive field.
pub fn response(x: f32, centre: f32, sigma: f32) -> f32 {
    let u = (x - centre) / sigma;
    libm::expf(-u * u / 2.0)
}

/// Returns the widths of fields that are as wide as the distance between their neighbours, divided by `beta`.
pub fn spaced_widths<const M: usize>(centres: &[f32; M], beta: f32) -> [f32; M] {
    core::array::from_fn(|i| {
        let (lower, upper) = (i.saturating_sub(1), (i + 1).min(M - 1));
        (centres[upper] - centres[lower]) / ((upper - lower) as f32 * beta)
    })
}
