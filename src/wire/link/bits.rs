//! Strings of bits, high bit first, and exponential Golomb codes.

use core::ops::Range;

use crate::num::LACKS_DIVISION;
use crate::wire::bytes::Cursor;

/// A sink of bits.
pub(super) trait PutBits {
    /// Appends a value of `count` bits, up to 32.
    fn put(&mut self, value: u32, count: u32);

    /// Appends `code(value, k)`, for `k` up to 16 and values below 2³²-2ᵏ.
    fn put_code(&mut self, value: u32, k: u32);
}

/// The parts of `code(value, k)`: how many zeros come first, and then what number in how many bits.
#[inline]
fn code(value: u32, k: u32) -> (u32, u32, u32) {
    let number = value.wrapping_add(1_u32.wrapping_shl(k));
    let bits = bits_of(number);
    (bits.wrapping_sub(k).wrapping_sub(1), number, bits)
}

/// The length of a number in bits. A Cortex-M0 has small ones in a table, as it would call the runtime.
#[inline]
fn bits_of(number: u32) -> u32 {
    const SMALL: [u8; 32] = [
        0, 1, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5,
        5, 5,
    ];
    match SMALL.get(number as usize) {
        Some(&bits) if LACKS_DIVISION => bits.into(),
        _ => 32 - number.leading_zeros(),
    }
}

/// A string of fewer than 32 bits. A longer one keeps only its length.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Word {
    bits: u32,
    count: u32,
}

impl Word {
    /// Whether it has all its bits.
    #[inline]
    pub(super) fn is_whole(self) -> bool {
        self.count < 32
    }
}

impl PutBits for Word {
    #[inline]
    fn put(&mut self, value: u32, count: u32) {
        self.bits = self.bits.wrapping_shl(count) | value;
        self.count = self.count.wrapping_add(count);
    }

    #[inline]
    fn put_code(&mut self, value: u32, k: u32) {
        let (zeros, number, bits) = code(value, k);
        self.put(number, zeros.wrapping_add(bits));
    }
}

/// Appends bits to a buffer, 32 at a time.
#[derive(Debug)]
pub(super) struct BitWriter<'a> {
    bytes: Cursor<'a>,
    /// The low `pending` bits, fewer than 32, are not in the buffer yet; the others are.
    bits: u32,
    pending: u32,
    /// How many more bits there is room for; negative if bits were lost for want of room.
    left: i32,
}

/// A position in the string to go back to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    written: usize,
    bits: u32,
    pending: u32,
    left: i32,
}

impl<'a> BitWriter<'a> {
    /// Appends to what is written.
    pub(super) fn new(bytes: Cursor<'a>) -> Self {
        let left = (bytes.room() as i32).wrapping_mul(8);
        Self { bytes, bits: 0, pending: 0, left }
    }

    pub(super) fn mark(&self) -> Mark {
        let Self { bits, pending, left, .. } = *self;
        Mark { written: self.bytes.written(), bits, pending, left }
    }

    pub(super) fn back_to(&mut self, mark: Mark) {
        self.bytes.truncate(mark.written);
        (self.bits, self.pending, self.left) = (mark.bits, mark.pending, mark.left);
    }

    /// Begins behind this many bytes, which are written later. The string ends at the limit, or where the buffer has this
    /// many bytes left.
    #[inline]
    pub(super) fn begin(&mut self, header: usize, limit: usize, left: usize) {
        self.bytes.begin(header, limit, left);
        self.left = (self.bytes.room() as i32).wrapping_mul(8);
    }

    /// Appends the first word after whole bytes. It has fewer than 32 bits, and there is room for it.
    #[inline]
    pub(super) fn put_lead(&mut self, lead: Word) {
        (self.bits, self.pending) = (lead.bits, lead.count);
        self.left = self.left.wrapping_sub(lead.count as i32);
    }

    /// Takes the [first word](Self::put_lead) away again, of a string that has no other bits.
    pub(super) fn take_lead(&mut self) -> Word {
        let lead = Word { bits: self.bits, count: self.pending };
        (self.bits, self.pending) = (0, 0);
        self.left = self.left.wrapping_add(lead.count as i32);
        lead
    }

    /// Appends a word; `None` if it has 32 bits or more, or does not fit.
    #[inline]
    pub(super) fn put_word(&mut self, word: Word) -> Option<()> {
        let fits = word.is_whole() && word.count as i32 <= self.left;
        fits.then(|| self.put(word.bits, word.count))
    }

    /// Appends bits that complete 32 pending bits, which go to the buffer.
    #[inline(never)]
    fn put_across(&mut self, value: u32, count: u32) {
        let free = 32_u32.wrapping_sub(self.pending);
        let rest = count.wrapping_sub(free);
        let bits = self.bits.unbounded_shl(free) | value.wrapping_shr(rest);
        let _ = self.bytes.put(&bits.to_be_bytes());
        self.bits = value;
        self.pending = rest;
    }

    /// Appends whole bytes, before any bits; those that do not fit are left out.
    pub(super) fn put_bytes(&mut self, bytes: &[u8]) {
        let _ = self.bytes.put(bytes);
        self.left = (self.bytes.room() as i32).wrapping_mul(8);
    }

    /// How many whole bytes there is room for.
    pub(super) fn room(&self) -> usize {
        self.bytes.room()
    }

    /// Whether there was room for all bits.
    pub(super) fn is_within_limit(&self) -> bool {
        self.left >= 0
    }

    /// Writes the bits that are not in the buffer yet, with the last byte filled up with 0, and returns the bytes. Behind
    /// its limit the buffer has 4 bytes more, which may be overwritten.
    #[inline]
    pub(super) fn finish(&mut self) -> &mut Cursor<'a> {
        let bits = self.bits.unbounded_shl(32_u32.wrapping_sub(self.pending));
        self.bytes.put_some(bits.to_be_bytes(), self.pending.div_ceil(8) as usize);
        self.pending = 0;
        &mut self.bytes
    }
}

impl PutBits for BitWriter<'_> {
    #[inline]
    fn put(&mut self, value: u32, count: u32) {
        self.left = self.left.wrapping_sub(count as i32);
        let pending = self.pending.wrapping_add(count);
        if pending < 32 {
            self.bits = self.bits.wrapping_shl(count) | value;
            self.pending = pending;
        } else {
            self.put_across(value, count);
        }
    }

    fn put_code(&mut self, value: u32, k: u32) {
        let (zeros, number, bits) = code(value, k);
        self.put(0, zeros);
        self.put(number, bits);
    }
}

/// A source of bits.
pub(super) trait TakeBits {
    /// The next `count` bits, 1 to 32.
    fn take(&mut self, count: u32) -> Option<u32>;

    /// The value of the next `code(value, k)`, for `k` up to 16.
    fn take_code(&mut self, k: u32) -> Option<u32>;
}

/// The next bits, from the highest on. It can be asked for more bits than it has: [`BitReader::pass`] then fails.
#[derive(Clone, Copy, Debug)]
pub(super) struct Glance {
    bits: u32,
    taken: u32,
    /// How many bits it has.
    count: u32,
}

impl Glance {
    /// Whether fewer than 8 bits are left, all of them 0.
    #[inline]
    pub(super) fn is_padding(self) -> bool {
        self.count < 8 && self.bits == 0
    }
}

impl TakeBits for Glance {
    #[inline]
    fn take(&mut self, count: u32) -> Option<u32> {
        let value = self.bits.wrapping_shr(32_u32.wrapping_sub(count));
        self.bits = self.bits.wrapping_shl(count);
        self.taken = self.taken.wrapping_add(count);
        Some(value)
    }

    #[inline]
    fn take_code(&mut self, k: u32) -> Option<u32> {
        let number = self.take((2 * self.bits.leading_zeros() + 1).wrapping_add(k))?;
        Some(number.wrapping_sub(1_u32.wrapping_shl(k)))
    }
}

/// Takes bits from a buffer that goes on behind them, as a frame does by its checksum: there 4 bytes can be read anywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    /// How many bits are taken, and how many there are.
    taken: usize,
    end: usize,
}

impl<'a> BitReader<'a> {
    /// The bits from one byte to another, after the first ones. Four bytes follow; with fewer there may seem to be no bits.
    #[inline]
    pub(super) fn new(bytes: &'a [u8], string: Range<usize>, taken: usize) -> Self {
        let taken = string.start.wrapping_mul(8).wrapping_add(taken);
        Self { bytes, taken, end: string.end.wrapping_mul(8) }
    }

    pub(super) fn taken(&self) -> usize {
        self.taken
    }

    /// The next bits: at least 25, or all that are left. Zeros follow the last one.
    #[inline]
    pub(super) fn glance(&self) -> Glance {
        let at = self.taken / 8;
        let next = self.bytes.get(at..at.wrapping_add(4)).and_then(<[u8]>::first_chunk);
        let bits = next.map_or(0, |bytes| u32::from_be_bytes(*bytes)) << (self.taken % 8);
        let left = self.left() as u32;
        let behind = u32::MAX.unbounded_shr(left);
        Glance { bits: bits & !behind, taken: 0, count: left.min(25) }
    }

    /// Takes the bits that were taken from a glance; `None` if it had fewer.
    #[inline]
    pub(super) fn pass(&mut self, glance: Glance) -> Option<()> {
        (glance.taken <= glance.count).then(|| {
            self.taken = self.taken.wrapping_add(glance.taken as usize);
        })
    }

    #[inline]
    fn left(&self) -> usize {
        self.end.saturating_sub(self.taken)
    }

    /// Whether no [bits but padding](Glance::is_padding) are left.
    pub(super) fn is_padding(self) -> bool {
        self.glance().is_padding()
    }
}

impl TakeBits for BitReader<'_> {
    fn take(&mut self, count: u32) -> Option<u32> {
        let mut value = 0;
        for _ in 0..count {
            let mut glance = self.glance();
            value = value << 1 | glance.take(1)?;
            self.pass(glance)?;
        }
        Some(value)
    }

    fn take_code(&mut self, k: u32) -> Option<u32> {
        let mut zeros = 0;
        while self.take(1)? == 0 {
            zeros += 1;
            if zeros + k >= 32 {
                return None;
            }
        }
        let number = 1_u32.wrapping_shl(zeros) | self.take(zeros)?;
        Some(number.wrapping_sub(1).wrapping_shl(k) | self.take(k)?)
    }
}
