//! Sums over a moving window, in every sample type.

use core::cmp::Ordering;
use core::fmt::Debug;

use bytemuck::Pod;

use super::arithmetic::{beyond, for_each_integer, magnitude};
use super::convert::units;
use super::{Sample, SampleKind, word};

/// How a sample type sums a window.
pub(crate) trait Windowed: SummedIn<Self::Sum> + SummedIn<Self::Fast> {
    /// Wide enough for 16 384 samples.
    type Sum: Difference;

    /// Wide enough while they are small.
    type Fast: Difference;

    /// The sum, if the fast one is wide enough for it and for what a block of small samples adds.
    fn fast(sum: Self::Sum) -> Option<Self::Fast>;

    fn exact(sum: Self::Fast) -> Self::Sum;

    /// Whether these samples, and those whose slots they take, are small enough for the fast sum.
    fn are_small<const M: usize>(count: usize, samples: &[Self; M], slots: &[Self; M]) -> bool;

    /// At the end of a block, before the first slot's turn comes again.
    fn close_block(ring: &mut [Self], partial: &mut Self::Sum);
}

/// What a window is summed in.
pub(crate) trait SummedIn<T>: Sized {
    /// `N` times the sample, less the sum over the window, of which the slot is the oldest part; then
    /// takes the sample into the partial sum.
    fn excess(self, count: usize, slot: Self, partial: &mut T) -> T;
}

/// A sum, or the difference of `N` times a sample from it.
pub(crate) trait Difference: Copy + Default + Debug {
    /// What it is compared with.
    type Margin: Pod + PartialEq + Debug;

    const ZERO: Self;

    /// What no difference exceeds.
    const WIDEST: Self::Margin;

    fn is_nan(self) -> bool;

    fn is_finite(self) -> bool;

    /// Takes up a difference, so that whether all of a group are finite can be asked once.
    fn taint(self, difference: Self) -> Self;

    /// Whether a difference that is a number is above the margin, or below its negative.
    fn beyond(self, margin: Self::Margin) -> Ordering;
}

/// `count` times a threshold, to compare differences with.
pub(crate) const fn margin<S: Sample>(
    threshold: S,
    count: usize,
) -> <S::Sum as Difference>::Margin {
    match S::KIND {
        SampleKind::F32 => word(magnitude(units(threshold) as f32 * count as f32) as u64),
        _ => word((units(threshold) as i64).wrapping_mul(count as i64) as u64),
    }
}

/// The [`margin`] of fast sums, where it is finite: a difference within it is finite, too.
pub(crate) const fn fast_margin<S: Sample>(
    threshold: S,
    count: usize,
) -> <S::Fast as Difference>::Margin {
    if matches!(S::KIND, SampleKind::F32) {
        let margin = units(threshold) as f32 * count as f32;
        word(magnitude(if margin < f32::MAX { margin } else { f32::MAX }) as u64)
    } else {
        let margin = (units(threshold) as i64).wrapping_mul(count as i64);
        let widest = i32::MAX as i64;
        word(if margin < widest { margin } else { widest } as u64)
    }
}

impl Difference for f32 {
    type Margin = u32;

    const ZERO: f32 = 0.0;

    const WIDEST: u32 = magnitude(f32::INFINITY);

    #[inline]
    fn is_nan(self) -> bool {
        f32::is_nan(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    #[inline]
    fn taint(self, difference: f32) -> f32 {
        self + difference
    }

    #[inline]
    fn beyond(self, margin: u32) -> Ordering {
        beyond(self, margin)
    }
}

impl SummedIn<f32> for f32 {
    #[inline]
    fn excess(self, count: usize, slot: f32, partial: &mut f32) -> f32 {
        let sum = slot + *partial;
        *partial += self;
        self * count as f32 - sum
    }
}

/// Slots whose turn has come in this block hold its samples, and `partial` their sum. The others hold,
/// for each sample of the block before, the sum from it to that block's end.
impl Windowed for f32 {
    type Sum = f32;
    type Fast = f32;

    #[inline]
    fn fast(sum: f32) -> Option<f32> {
        Some(sum)
    }

    #[inline]
    fn exact(sum: f32) -> f32 {
        sum
    }

    #[inline]
    fn are_small<const M: usize>(_: usize, _: &[f32; M], _: &[f32; M]) -> bool {
        true
    }

    #[inline]
    fn close_block(ring: &mut [f32], partial: &mut f32) {
        // Adding -0 changes no value; adding 0 would turn -0 into 0.
        let mut to_the_end = -0.0;
        for slot in ring.iter_mut().rev() {
            to_the_end += *slot;
            *slot = to_the_end;
        }
        *partial = 0.0;
    }
}

macro_rules! integer_difference {
    ($($sum:ty),*) => {
        $(
            impl Difference for $sum {
                type Margin = $sum;

                const ZERO: $sum = 0;

                const WIDEST: $sum = <$sum>::MAX;

                #[inline]
                fn is_nan(self) -> bool {
                    false
                }

                #[inline]
                fn is_finite(self) -> bool {
                    true
                }

                #[inline]
                fn taint(self, _: $sum) -> $sum {
                    self
                }

                #[inline]
                fn beyond(self, margin: $sum) -> Ordering {
                    if self > margin {
                        Ordering::Greater
                    } else if self < margin.wrapping_neg() {
                        Ordering::Less
                    } else {
                        Ordering::Equal
                    }
                }
            }
        )*
    };
}
integer_difference!(i32, i64);

macro_rules! integer_summed {
    ([$($generics:tt)*] $sample:ty, $to_bits:path, $sum:ty) => {
        impl<$($generics)*> SummedIn<$sum> for $sample {
            #[inline]
            fn excess(self, count: usize, slot: Self, partial: &mut $sum) -> $sum {
                let sum = *partial;
                let (newest, oldest) = (<$sum>::from($to_bits(self)), <$sum>::from($to_bits(slot)));
                *partial = sum.wrapping_add(newest).wrapping_sub(oldest);
                newest.wrapping_mul(count as $sum).wrapping_sub(sum)
            }
        }
    };
}

/// The ring holds the samples and `partial` their sum, which integers keep exactly: in 64 bits if need
/// be, and in 32 for a block of samples that are small.
macro_rules! integer_window {
    ([$($generics:tt)*] $sample:ty, i16, $to_bits:path, $($rest:tt)*) => {
        integer_summed!([$($generics)*] $sample, $to_bits, i32);
        integer_window!(@ [$($generics)*] $sample, i32, $to_bits);
    };
    ([$($generics:tt)*] $sample:ty, i32, $to_bits:path, $($rest:tt)*) => {
        integer_summed!([$($generics)*] $sample, $to_bits, i32);
        integer_summed!([$($generics)*] $sample, $to_bits, i64);
        integer_window!(@ [$($generics)*] $sample, i64, $to_bits);
    };
    (@ [$($generics:tt)*] $sample:ty, $sum:ty, $to_bits:path) => {
        impl<$($generics)*> Windowed for $sample {
            type Sum = $sum;
            type Fast = i32;

            // A sum up to 2^29, a block of small samples that moves it by as much, and N times one of
            // them, which is half of that, stay below 2^31 together.
            #[inline]
            fn fast(sum: $sum) -> Option<i32> {
                let above = sum.wrapping_add(1 << 29).cast_unsigned();
                (<$sum>::BITS == 32 || above < 1 << 30).then_some(sum as i32)
            }

            #[inline]
            fn exact(sum: i32) -> $sum {
                <$sum>::from(sum)
            }

            #[inline]
            fn are_small<const M: usize>(
                count: usize,
                samples: &[Self; M],
                slots: &[Self; M],
            ) -> bool {
                let small: i32 = (1 << 28) / count.next_power_of_two() as i32;
                let above = |taint: u32, value: &Self| {
                    taint | i32::from($to_bits(*value)).wrapping_add(small).cast_unsigned()
                };
                let taint = slots.iter().fold(samples.iter().fold(0, above), above);
                <$sum>::BITS == 32 || taint < 2 * small.cast_unsigned()
            }

            #[inline]
            fn close_block(_: &mut [Self], _: &mut $sum) {}
        }
    };
}
for_each_integer!(integer_window);
