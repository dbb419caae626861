//! Filters of 16-bit samples: products of 64 bits, of which no bit is lost.

use super::{FRACTION, Recursive, Section};
use crate::num::arithmetic::for_each_integer;

/// How many fraction bits an output has that the sample type has not. With 11, every sum fits 32 bits, except those that
/// are of 64.
const FINER: u32 = 11;
/// Half a unit of the sample type, which outputs have added: their floor is the nearest sample.
const HALF: i32 = 1 << (FINER - 1);
/// The outputs that round to a sample.
const LEAST: i32 = -1 << (15 + FINER);
const MOST: i32 = !LEAST;

/// The state of a second-order section. The slope, how much the output changes a sample, has [`FRACTION`] bits more than
/// the output.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NarrowSecond {
    slope: i64,
    output: i32,
    /// The sample before, and the one before that.
    before: [i16; 2],
}

impl NarrowSecond {
    /// No output, as it is below all.
    const NONE: i32 = i32::MIN;

    const fn steady(sample: i16) -> Self {
        Self { slope: 0, output: ((sample as i32) << FINER) + HALF, before: [sample; 2] }
    }

    #[inline(always)]
    fn step(&mut self, section: Section<i32>, sample: i16) -> i16 {
        let [last, second_last] = self.before.map(i32::from);
        let error = (last << FINER).wrapping_add(HALF).wrapping_sub(self.output);
        let bend = i32::from(sample).wrapping_add(second_last).wrapping_sub(last << 1) << FINER;
        let slope = self
            .slope
            .wrapping_add(product(section.gain, error))
            .wrapping_add(product(section.tap, bend))
            .wrapping_sub(product(section.damping, whole(self.slope)));
        let free = self.output.wrapping_add(whole(slope));
        let output = free.clamp(LEAST, MOST);
        self.slope = if output == free {
            slope
        } else {
            i64::from(output.wrapping_sub(self.output)) << FRACTION
        };
        self.output = output;
        self.before = [sample, last as i16];
        (output >> FINER) as i16
    }
}

/// The state of a first-order low-pass: its output with [`FRACTION`] bits more.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NarrowFirst(i64);

impl NarrowFirst {
    /// No output, as it is below all.
    const NONE: i64 = i64::MIN;

    const fn steady(sample: i16) -> Self {
        Self((sample as i64) << (FINER + FRACTION))
    }

    #[inline(always)]
    fn step(&mut self, gain: i32, sample: i16) -> i16 {
        let error = (i32::from(sample) << FINER).wrapping_sub(whole(self.0));
        self.0 = self.0.wrapping_add(product(gain, error));
        (whole(self.0).wrapping_add(HALF) >> FINER) as i16
    }
}

#[inline(always)]
fn product(coefficient: i32, value: i32) -> i64 {
    i64::from(coefficient).wrapping_mul(i64::from(value))
}

/// The value without its last [`FRACTION`] bits.
#[inline(always)]
const fn whole(value: i64) -> i32 {
    (value >> FRACTION) as i32
}

macro_rules! narrow {
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $from_bits:path) => {
        impl<$($generics)*> Recursive for $sample {
            type Coefficient = i32;
            type Second = NarrowSecond;
            type First = NarrowFirst;

            const SECOND: NarrowSecond =
                NarrowSecond { output: NarrowSecond::NONE, ..NarrowSecond::steady(0) };
            const FIRST: NarrowFirst = NarrowFirst(NarrowFirst::NONE);

            super::integers!(NarrowSecond, NarrowFirst, $to_bits, $from_bits);
        }
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $from_bits:path) => {};
}
for_each_integer!(narrow);
