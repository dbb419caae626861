//! The paper's pseudo-code, transcribed: whole recordings, one index after the other, its slips of sign and index
//! mended. What the codecs are measured against, in the same sample type, for the same core, by the same compiler.

#![allow(clippy::needless_range_loop)] // index by index, as the pseudo-code

use core::ops::{Add, AddAssign, Div, Mul, Sub, SubAssign};

use fixed::{
    FixedI16, FixedI32, FixedI64,
    types::extra::{U8, U16},
};
use spikewire::Sample;

/// What the pseudo-code needs of a number: a type that its sums and products fit in.
pub trait Plain: Sample + Into<Self::Wide> {
    type Wide: Copy
        + Default
        + PartialOrd
        + Add<Output = Self::Wide>
        + Sub<Output = Self::Wide>
        + Mul<Output = Self::Wide>
        + Div<Output = Self::Wide>
        + AddAssign
        + SubAssign;

    /// By how much a mean of centres may be off, as whole numbers hold neither exactly.
    const MEAN: f64;

    fn wide(value: f64) -> Self::Wide;
    fn count(count: i16) -> Self::Wide;
    fn narrow(wide: Self::Wide) -> Self;
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
}

impl Plain for FixedI16<U8> {
    type Wide = FixedI32<U8>;

    const MEAN: f64 = 1.0 / 256.0;

    fn wide(value: f64) -> FixedI32<U8> {
        FixedI32::from_num(value)
    }

    fn count(count: i16) -> FixedI32<U8> {
        FixedI32::from_num(count)
    }

    fn narrow(wide: FixedI32<U8>) -> Self {
        Self::from_bits(wide.to_bits() as i16)
    }
}

impl Plain for FixedI32<U16> {
    type Wide = FixedI64<U16>;

    const MEAN: f64 = 1.0 / 65_536.0;

    fn wide(value: f64) -> FixedI64<U16> {
        FixedI64::from_num(value)
    }

    fn count(count: i16) -> FixedI64<U16> {
        FixedI64::from_num(count)
    }

    fn narrow(wide: FixedI64<U16>) -> Self {
        Self::from_bits(wide.to_bits() as i32)
    }
}

fn magnitude<W: Copy + Default + PartialOrd + Sub<Output = W>>(value: W) -> W {
    if value < W::default() { W::default() - value } else { value }
}

/// Algorithm 6.
#[inline(never)]
pub fn temporal_contrast<S: Plain>(input: &[S], threshold: S, spikes: &mut [i8]) {
    let threshold = threshold.into();
    for i in 1..input.len() {
        let difference = input[i].into() - input[i - 1].into();
        spikes[i] = if difference > threshold {
            1
        } else if difference < S::Wide::default() - threshold {
            -1
        } else {
            0
        };
    }
}

/// Algorithm 7.
#[inline(never)]
pub fn step_forward<S: Plain>(input: &[S], threshold: S, spikes: &mut [i8]) {
    let threshold = threshold.into();
    let mut base = input[0].into();
    for i in 1..input.len() {
        if input[i].into() > base + threshold {
            spikes[i] = 1;
            base += threshold;
        } else if input[i].into() < base - threshold {
            spikes[i] = -1;
            base -= threshold;
        } else {
            spikes[i] = 0;
        }
    }
}

/// Algorithm 8, from its second loop on; times the samples averaged, as the mean of whole numbers need not be one.
#[inline(never)]
pub fn moving_window<S: Plain>(input: &[S], averaged: usize, threshold: S, spikes: &mut [i8]) {
    let count = S::wide(averaged as f64);
    let margin = threshold.into() * count;
    for i in averaged..input.len() {
        let mut sum = S::Wide::default();
        for j in i - averaged..i {
            sum += input[j].into();
        }
        spikes[i] = if input[i].into() * count > sum + margin {
            1
        } else if input[i].into() * count < sum - margin {
            -1
        } else {
            0
        };
    }
}

/// The temporal codes' decoder.
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

/// Algorithm 3, on the shifted input.
#[inline(never)]
pub fn hough<S: Plain>(input: &mut [S], filter: &[S], spikes: &mut [i8]) {
    for i in 0..input.len() {
        let mut count = 0;
        for j in 0..filter.len() {
            if i + j < input.len() && input[i + j] >= filter[j] {
                count += 1;
            }
        }
        spikes[i] = 0;
        if count == filter.len() {
            spikes[i] = 1;
            for j in 0..filter.len() {
                input[i + j] = S::narrow(input[i + j].into() - filter[j].into());
            }
        }
    }
}

/// Algorithm 4, on the shifted input.
#[inline(never)]
pub fn threshold_hough<S: Plain>(input: &mut [S], filter: &[S], threshold: S, spikes: &mut [i8]) {
    for i in 0..input.len() {
        let mut error = S::Wide::default();
        for j in 0..filter.len() {
            if i + j < input.len() && input[i + j] < filter[j] {
                error += filter[j].into() - input[i + j].into();
            }
        }
        spikes[i] = 0;
        if error <= threshold.into() {
            spikes[i] = 1;
            for j in 0..filter.len() {
                if i + j < input.len() {
                    input[i + j] = S::narrow(input[i + j].into() - filter[j].into());
                }
            }
        }
    }
}

/// BSA as published, subtractive, on the shifted input.
#[inline(never)]
pub fn ben<S: Plain>(input: &mut [S], filter: &[S], threshold: S, spikes: &mut [i8]) {
    for i in 0..input.len() {
        let (mut e1, mut e2) = (S::Wide::default(), S::Wide::default());
        for j in 0..filter.len() {
            if i + j < input.len() {
                e1 += magnitude(input[i + j].into() - filter[j].into());
                e2 += magnitude(input[i + j].into());
            }
        }
        spikes[i] = 0;
        if e1 <= e2 - threshold.into() {
            spikes[i] = 1;
            for j in 0..filter.len() {
                if i + j < input.len() {
                    input[i + j] = S::narrow(input[i + j].into() - filter[j].into());
                }
            }
        }
    }
}

/// Algorithm 5, on the shifted input; the ratio in 14 bits of fraction where products are whole.
#[inline(never)]
pub fn ben_toolbox<S: Plain>(input: &mut [S], filter: &[S], threshold: f64, spikes: &mut [i8]) {
    // The ratio in 128ths, so that counts can take part; the paper's 1.15 is then 1.1484.
    let (parts, threshold) = (S::wide(128.0), S::wide((threshold * 128.0) as i32 as f64));
    for i in 0..input.len() - filter.len() {
        let (mut e1, mut e2) = (S::Wide::default(), S::Wide::default());
        for j in 0..filter.len() {
            e1 += magnitude(input[i + j + 1].into() - filter[j].into());
            e2 += magnitude(input[i + j].into());
        }
        spikes[i] = 0;
        if e1 * parts <= e2 * threshold {
            spikes[i] = 1;
            for j in 0..filter.len() {
                if i + j + 2 < input.len() {
                    input[i + j + 2] = S::narrow(input[i + j + 2].into() - filter[j].into());
                }
            }
        }
    }
}

/// The rate codes' decoder: a convolution, the oldest spike first.
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

/// Algorithm 1.
#[inline(never)]
pub fn position<S: Plain>(input: &[S], centres: &[S], neurons: &mut [i8]) {
    for i in 0..input.len() {
        let (mut winner, mut least) = (0, magnitude(input[i].into() - centres[0].into()));
        for j in 1..centres.len() {
            let distance = magnitude(input[i].into() - centres[j].into());
            if distance < least {
                (winner, least) = (j, distance);
            }
        }
        neurons[i] = winner as i8;
    }
}

/// Algorithm 2 with its exponentials, in `f32` for every sample type: the winner.
#[inline(never)]
pub fn gaussian<S: Plain>(input: &[S], centres: &[f32], sigma: f32, neurons: &mut [i8]) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        let (mut winner, mut largest) = (0, 0.0);
        for j in 0..centres.len() {
            let response = response(x, centres[j], sigma);
            if response > largest {
                (winner, largest) = (j, response);
            }
        }
        neurons[i] = winner as i8;
    }
}

/// The centre of the neuron that fired.
#[inline(never)]
pub fn position_decode<S: Plain>(neurons: &[i8], centres: &[S], values: &mut [S]) {
    for i in 0..neurons.len() {
        values[i] = centres[neurons[i] as usize];
    }
}

/// Algorithm 2 with its exponentials, in `f32` for every sample type: the slot of each neuron, or -1, one sample
/// after the other.
#[inline(never)]
pub fn slots<S: Plain>(input: &[S], centres: &[f32], sigma: f32, levels: usize, slots: &mut [i8]) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        for j in 0..centres.len() {
            let level = (levels as f32 * response(x, centres[j], sigma) + 0.5) as usize;
            slots[i * centres.len() + j] = if level > 0 { (levels - level) as i8 } else { -1 };
        }
    }
}

/// The mean of the centres weighted by their levels; where none fired, the value before.
#[inline(never)]
pub fn slots_decode<S: Plain>(
    slots: &[i8],
    centres: &[S],
    levels: usize,
    mut value: S,
    values: &mut [S],
) {
    for i in 0..values.len() {
        let (mut sum, mut total) = (S::Wide::default(), 0);
        for j in 0..centres.len() {
            let slot = slots[i * centres.len() + j];
            if slot >= 0 {
                let level = levels - slot as usize;
                sum += centres[j].into() * S::count(level as i16);
                total += level;
            }
        }
        if total > 0 {
            value = S::narrow(sum / S::count(total as i16));
        }
        values[i] = value;
    }
}

/// Probabilistic spiking with its exponentials, in `f32` for every sample type: a draw for each neuron that responds,
/// of a number below the levels; whether each fired, one sample after the other.
#[inline(never)]
pub fn probabilistic<S: Plain>(
    input: &[S],
    centres: &[f32],
    sigma: f32,
    levels: u32,
    mut draw: impl FnMut() -> u32,
    fired: &mut [i8],
) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        for j in 0..centres.len() {
            let level = (levels as f32 * response(x, centres[j], sigma) + 0.5) as u32;
            let fires = level > 0 && draw() / (u32::MAX / levels + 1) < level;
            fired[i * centres.len() + j] = fires as i8;
        }
    }
}

/// The mean of the centres that fired; where none did, the value before.
#[inline(never)]
pub fn probabilistic_decode<S: Plain>(fired: &[i8], centres: &[S], mut value: S, values: &mut [S]) {
    for i in 0..values.len() {
        let (mut sum, mut total) = (S::Wide::default(), 0);
        for j in 0..centres.len() {
            if fired[i * centres.len() + j] == 1 {
                sum += centres[j].into();
                total += 1;
            }
        }
        if total > 0 {
            value = S::narrow(sum / S::count(total as i16));
        }
        values[i] = value;
    }
}

/// Of one receptive field.
pub fn response(x: f32, centre: f32, sigma: f32) -> f32 {
    let u = (x - centre) / sigma;
    libm::expf(-u * u / 2.0)
}
