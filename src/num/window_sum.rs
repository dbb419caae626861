//! Arithmetic of the moving window: the sum over the window, and how far a sample is from its mean.

use core::cmp::Ordering;
use core::fmt::Debug;
use core::hint::black_box;

use bytemuck::Pod;

use super::arithmetic::{beyond, check, for_each_integer, magnitude};
use super::convert::units;
use super::{Sample, SampleKind, Stored, word};

/// How a sample type sums a window.
pub(crate) trait Windowed: SummedIn<Self::Sum> + SummedIn<Self::Fast> {
    /// A sum of up to 16 384 samples of any size.
    type Sum: Difference;

    /// A sum of samples that [are small](Self::are_small), which takes fewer instructions.
    type Fast: Difference;

    /// The sum as a fast one; `None` if a block of small samples added to it could overflow.
    fn fast(sum: Self::Sum) -> Option<Self::Fast>;

    /// The fast sum, widened.
    fn exact(sum: Self::Fast) -> Self::Sum;

    /// Whether these samples, and the contents of the slots that they take, are small enough for the fast sum.
    fn are_small<const M: usize>(count: usize, samples: &[Self; M], slots: &[Self; M]) -> bool;

    /// Ends a block, when every slot of the ring holds one of its samples.
    fn close_block(ring: &mut [Self], partial: &mut Self::Sum);
}

/// A sample whose windows are summed in `T`.
pub(crate) trait SummedIn<T>: Sized {
    /// `count` times the sample, minus the sum over the window before it. `slot` is the content of the slot that
    /// the sample takes; the partial sum is brought up to date.
    fn excess(self, count: usize, slot: Self, partial: &mut T) -> T;
}

/// The sum over a window, or `N` times a sample minus that sum.
pub(crate) trait Difference: Copy + Default + Debug + Send + Sync + Stored {
    /// What a difference is compared with: `N` times the threshold.
    type Margin: Pod + PartialEq + Debug + Send + Sync;

    const ZERO: Self;

    /// A margin that no difference exceeds.
    const WIDEST: Self::Margin;

    const IS_ALWAYS_FINITE: bool;

    fn is_nan(self) -> bool;

    fn is_finite(self) -> bool;

    /// A check over a group's differences, including this one. If the last check is finite, so was every difference:
    /// one test at the end replaces one a sample. Integers, which are always finite, return `self`.
    fn including(self, difference: Self) -> Self;

    /// Compares a difference, which is not NaN, with the margin: `Greater` above it, `Less` below its negative, else
    /// `Equal`.
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

/// The [`margin`] for fast sums, limited to finite values: a difference within it is finite, too.
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

    const IS_ALWAYS_FINITE: bool = false;

    #[inline]
    fn is_nan(self) -> bool {
        f32::is_nan(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    #[inline]
    fn including(self, difference: f32) -> f32 {
        check(self, difference)
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

/// The slots that the current block has filled hold its samples, and `partial` their sum. Each other slot holds a
/// sum over the previous block, from the sample that was there to the end of that block.
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
        let mut close = |slot: &mut f32| {
            to_the_end += *slot;
            *slot = to_the_end;
        };
        let (rest, groups) = ring.as_rchunks_mut::<4>();
        groups.as_flattened_mut().iter_mut().rev().for_each(&mut close);
        for slot in rest.iter_mut().rev() {
            close(slot);
            black_box(()); // keeps the compiler from unrolling the loop
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

                const IS_ALWAYS_FINITE: bool = true;

                #[inline]
                fn is_nan(self) -> bool {
                    false
                }

                #[inline]
                fn is_finite(self) -> bool {
                    true
                }

                #[inline]
                fn including(self, _: $sum) -> $sum {
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

/// The ring holds the samples and `partial` their exact sum: of 32-bit samples in 64 bits, or in 32 bits for a
/// block of samples that are small.
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

            // Below 2^31 together: a sum of up to 2^29, a block of small samples that moves it by up to 2^29, and
            // N times one of them, up to 2^28.
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
                // `value + small` is below `2 * small`, a power of 2, for every value in `-small..small`: so is the
                // bitwise or of all of them.
                let combine = |bits: u32, value: &Self| {
                    bits | i32::from($to_bits(*value)).wrapping_add(small).cast_unsigned()
                };
                let bits = slots.iter().fold(samples.iter().fold(0, combine), combine);
                <$sum>::BITS == 32 || bits < 2 * small.cast_unsigned()
            }

            #[inline]
            fn close_block(_: &mut [Self], _: &mut $sum) {}
        }
    };
}
for_each_integer!(integer_window);
