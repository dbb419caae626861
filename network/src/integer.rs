//! Integer potentials, with weights of 8 bits.

use crate::checksum::Checksum;
use crate::number::{IS_SMALL, Number, OUTSIDE, block};
use crate::sealed::Sealed;
use core::hint::black_box;

/// Largest bias, threshold and reset value.
pub(crate) const LARGEST: i32 = 1 << 27;

/// The integer that represents a decay of 1.
pub(crate) const ONE: u32 = 1 << 16;

/// Bits by which a decay is shifted left, so that the upper word of its product is the potential.
pub(crate) const DECAY_SHIFT: u32 = if IS_SMALL { 0 } else { 14 };

/// Largest shift of sums of weights.
pub(crate) const MOST_SHIFT: u32 = 10;

/// Bound of potentials and currents, which lie in `-RANGE..RANGE`. A step's sum then stays below 2³¹. It adds the
/// potential and the current, both scaled by at most 1; 4096 spikes of weight 128, shifted by 10; and two biases and a
/// threshold of up to 2²⁷ each.
const RANGE: i32 = 1 << 29;

/// The weights of one input, as word-aligned bytes. A weight `w` is stored as `w + 128`, so that four of them are added
/// in two registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(4))]
pub struct Packed<const OUT: usize>([u8; OUT]);

impl<const OUT: usize> Packed<OUT> {
    /// Packs the weights of one input.
    #[expect(clippy::indexing_slicing, reason = "below the arrays' lengths")]
    pub const fn new(weights: &[i8; OUT]) -> Self {
        let mut packed = [0; OUT];
        let mut at = 0;
        while at < OUT {
            packed[at] = weights[at].cast_unsigned() ^ 0x80;
            at += 1;
        }
        Self(packed)
    }

    #[inline(always)]
    fn one(&self, neuron: usize) -> i32 {
        self.0.get(neuron).map_or(0, |&byte| i32::from(byte) - 128)
    }
}

/// Sums the bytes of two lists of rows, four bytes in each word: one word holds the sums of the first and third in 16 bits
/// each, another those of the second and fourth. It is a separate function so that nothing else takes the registers of the
/// sums.
#[inline(always)]
fn halves<const W: usize, const OUT: usize>(
    lists: [&[&Packed<OUT>]; 2],
    first: usize,
) -> ([u32; W], [u32; W]) {
    let [one, other] = lists.map(<[_]>::len);
    let count = one.wrapping_add(other) as u32;
    // Bytes are 128 above their weights; halves begin at 2^15 less that, so that none carries into the next.
    let begin = 0x8000_u32.wrapping_sub(count << 7).wrapping_mul(0x0001_0001);
    // `odd` sums the second and fourth bytes, and `all` these times 256 and the others.
    let (mut all, mut odd) = ([begin.wrapping_mul(257); W], [begin; W]);
    // On a Cortex-M0 in bytes, so that the loop shifts nothing; the compiler must see that they begin a word.
    let (byte, first) = if IS_SMALL { (first.wrapping_mul(4) & !3, 0) } else { (0, first) };
    for rows in lists {
        for row in rows {
            let words = row.0.get(byte..).and_then(|bytes| block::<_, W>(bytes, first));
            let Some(words) = words else { continue };
            for ((all, odd), bytes) in all.iter_mut().zip(&mut odd).zip(words) {
                let word = u32::from_le_bytes(*bytes);
                *all = all.wrapping_add(word);
                *odd = odd.wrapping_add((word >> 8) & 0x00ff_00ff);
            }
            black_box(()); // keeps the compiler from unrolling the loop
        }
    }
    for (all, odd) in all.iter_mut().zip(&mut odd) {
        *all = all.wrapping_sub(*odd << 8) ^ 0x8000_8000;
        *odd ^= 0x8000_8000;
    }
    (all, odd)
}

impl Sealed for i32 {}

impl Number for i32 {
    type Factor = u32;
    type Value = i16;
    type Row<const OUT: usize> = Packed<OUT>;
    type Scale = i16;
    const BLOCK: usize = if IS_SMALL { 1 } else { 2 };
    /// Largest number of weights, as unsigned bytes, whose sum fits in 16 bits beside the other half of its word.
    const MOST_ROWS: usize = 256;
    const MOST_SPIKES: usize = 4096;

    /// Returns the product divided by 65 536 and rounded down, exactly; without a 64-bit product on cores that have
    /// none.
    #[inline(always)]
    fn scaled(self, factor: u32) -> Self {
        if !IS_SMALL {
            let product =
                i64::from(self << (16 - DECAY_SHIFT)).wrapping_mul(factor.cast_signed().into());
            return (product >> 32) as Self;
        }
        let low = (self.cast_unsigned() & 0xffff).wrapping_mul(factor) >> 16;
        (self >> 16).wrapping_mul(factor.cast_signed()).wrapping_add(low.cast_signed())
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }

    #[inline(always)]
    fn outside(self) -> u32 {
        self.wrapping_add(RANGE).cast_unsigned()
    }

    fn clamp(&mut self) -> u32 {
        let is_outside = self.outside() > OUTSIDE;
        *self = (*self).clamp(-RANGE, RANGE - 1);
        is_outside.into()
    }

    fn accept(value: i16) -> Option<i16> {
        Some(value)
    }

    fn word(self) -> u32 {
        self.cast_unsigned()
    }

    fn word_of_factor(factor: u32) -> u32 {
        factor >> DECAY_SHIFT
    }

    fn add_rows<const OUT: usize>(rows: &[Packed<OUT>], scale: i16, sum: &mut Checksum) {
        for row in rows {
            for &byte in &row.0 {
                sum.add(byte.into());
            }
        }
        sum.add(u32::from(scale.cast_unsigned()));
    }

    #[inline(always)]
    fn sums<const W: usize, const OUT: usize>(
        start: impl FnOnce() -> [[Self; 4]; W],
        lists: [&[&Packed<OUT>]; 2],
        scale: i16,
        first: usize,
    ) -> [[Self; 4]; W] {
        let (even, odd) = halves::<W, OUT>(lists, first);
        let mut sums = start();
        for ((even, odd), sums) in even.iter().zip(&odd).zip(&mut sums) {
            let each = [*even as i16, *odd as i16, (even >> 16) as i16, (odd >> 16) as i16];
            for (sum, each) in sums.iter_mut().zip(each) {
                *sum = sum.wrapping_add(i32::from(each).wrapping_mul(scale.into()));
            }
        }
        sums
    }

    #[inline(always)]
    fn add_rows_to_one<const OUT: usize>(
        rows: &[&Packed<OUT>],
        scale: i16,
        neuron: usize,
        sum: &mut Self,
    ) {
        for row in rows {
            *sum = sum.wrapping_add(row.one(neuron).wrapping_mul(scale.into()));
        }
    }

    #[inline(always)]
    fn add_values<const OUT: usize>(
        rows: &[Packed<OUT>],
        scale: i16,
        values: &[i16],
        first: usize,
        sums: &mut [Self],
    ) {
        for (sum, neuron) in sums.iter_mut().zip(first..) {
            let mut own = 0_i32;
            for (row, &value) in rows.iter().zip(values) {
                own = own.wrapping_add(row.one(neuron).wrapping_mul(value.into()));
            }
            *sum = sum.wrapping_add(own.wrapping_shr(scale.trailing_zeros()));
        }
    }
}
