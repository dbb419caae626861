//! Filters of 32-bit samples: outputs of 64 bits, and products rounded down to their last place.

use super::{FRACTION, Recursive, Section};
use crate::num::arithmetic::for_each_integer;

/// How many fraction bits an output has that the sample type has not.
const FINER: u32 = 24;
/// Half a unit of the sample type, which outputs have added: their floor is the nearest sample.
const HALF: i64 = 1 << (FINER - 1);
/// The outputs that round to a sample.
const LEAST: i64 = -1 << (31 + FINER);
const MOST: i64 = !LEAST;

/// No output, as it is below all.
const NONE: i64 = i64::MIN;

/// The state of a second-order section.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WideSecond {
    /// How much the output changes a sample.
    slope: i64,
    output: i64,
    /// The sample before, and the one before that.
    before: [i32; 2],
}

impl WideSecond {
    const NONE: i64 = NONE;

    const fn steady(sample: i32) -> Self {
        Self { slope: 0, output: ((sample as i64) << FINER) + HALF, before: [sample; 2] }
    }

    #[inline(always)]
    fn step(&mut self, section: Section<i32>, sample: i32) -> i32 {
        let [last, second_last] = self.before.map(i64::from);
        let error = (last << FINER).wrapping_add(HALF).wrapping_sub(self.output);
        let bend = i64::from(sample).wrapping_add(second_last).wrapping_sub(last << 1) << FINER;
        let slope = self
            .slope
            .wrapping_add(product(section.gain, error))
            .wrapping_add(product(section.tap, bend))
            .wrapping_sub(product(section.damping, self.slope));
        let free = self.output.wrapping_add(slope);
        let output = free.clamp(LEAST, MOST);
        self.slope = if output == free { slope } else { output.wrapping_sub(self.output) };
        self.output = output;
        self.before = [sample, last as i32];
        (output >> FINER) as i32
    }
}

/// The state of a first-order low-pass: its output.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WideFirst(i64);

impl WideFirst {
    const NONE: i64 = NONE;

    const fn steady(sample: i32) -> Self {
        Self(((sample as i64) << FINER) + HALF)
    }

    #[inline(always)]
    fn step(&mut self, gain: i32, sample: i32) -> i32 {
        let error = (i64::from(sample) << FINER).wrapping_add(HALF).wrapping_sub(self.0);
        self.0 = self.0.wrapping_add(product(gain, error));
        (self.0 >> FINER) as i32
    }
}

/// The product, rounded down to an integer: that of the upper half is one, that of the lower is rounded.
#[inline(always)]
fn product(coefficient: i32, value: i64) -> i64 {
    let upper = i64::from(coefficient).wrapping_mul(value >> 32);
    let lower = u64::from(coefficient.cast_unsigned()).wrapping_mul(u64::from(value as u32));
    (upper << (32 - FRACTION)).wrapping_add((lower >> FRACTION).cast_signed())
}

macro_rules! wide {
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path) => {};
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Recursive for $sample {
            type Coefficient = i32;
            type Second = WideSecond;
            type First = WideFirst;

            const SECOND: WideSecond = WideSecond { output: NONE, ..WideSecond::steady(0) };
            const FIRST: WideFirst = WideFirst(NONE);

            super::integers!(WideSecond, WideFirst, $to_bits, $from_bits);
        }
    };
}
for_each_integer!(wide);
