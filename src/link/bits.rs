//! A string of bits, high bit first, and its exponential Golomb codes.

use crate::bytes::Cursor;

/// Appends bits to a buffer.
#[derive(Debug)]
pub(super) struct BitWriter<'a> {
    bytes: Cursor<'a>,
    /// The low `pending` bits are not in the buffer yet, fewer than 8; those above are.
    bits: u32,
    pending: u32,
}

/// A place to go back to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    written: usize,
    bits: u32,
    pending: u32,
}

impl<'a> BitWriter<'a> {
    /// Goes on after what is written.
    pub(super) fn new(bytes: Cursor<'a>) -> Self {
        Self { bytes, bits: 0, pending: 0 }
    }

    pub(super) fn mark(&self) -> Mark {
        Mark { written: self.bytes.written(), bits: self.bits, pending: self.pending }
    }

    pub(super) fn back_to(&mut self, mark: Mark) {
        self.bytes.truncate(mark.written);
        (self.bits, self.pending) = (mark.bits, mark.pending);
    }

    /// Appends the low `count` bits, up to 32.
    #[inline]
    pub(super) fn put(&mut self, value: u32, count: u32) -> Option<()> {
        if count > 16 {
            self.put_few(value >> 16, count - 16)?;
            self.put_few(value, 16)
        } else {
            self.put_few(value, count)
        }
    }

    /// Appends the low `count` bits, up to 16.
    fn put_few(&mut self, value: u32, count: u32) -> Option<()> {
        self.bits = self.bits << count | value & ((1 << count) - 1);
        self.pending += count;
        while self.pending >= 8 {
            self.bytes.push((self.bits >> (self.pending - 8)) as u8)?;
            self.pending -= 8;
        }
        Some(())
    }

    /// `code(value, k)`, for values below 2³²-1 and `k` up to 15.
    pub(super) fn put_code(&mut self, value: u32, k: u32) -> Option<()> {
        let number = (value >> k).saturating_add(1);
        let bits = 32 - number.leading_zeros();
        if 2 * bits - 1 + k <= 16 {
            return self.put_few(number << k | value & ((1 << k) - 1), 2 * bits - 1 + k);
        }
        self.put(0, bits - 1)?;
        self.put(number, bits)?;
        self.put_few(value, k)
    }

    /// Appends whole bytes, before any bits; those that do not fit are left out.
    pub(super) fn put_bytes(&mut self, bytes: &[u8]) {
        let _ = self.bytes.put(bytes);
    }

    /// How many whole bytes there is room for.
    pub(super) fn room(&self) -> usize {
        self.bytes.room()
    }

    /// Whether there is room for the last byte too, if it is not full.
    pub(super) fn is_within_limit(&self) -> bool {
        self.pending == 0 || self.bytes.room() > 0
    }

    /// Fills up the last byte with 0.
    pub(super) fn finish(mut self) -> Cursor<'a> {
        let _ = self.put(0, (8 - self.pending) % 8);
        self.bytes
    }
}

/// Takes bits from a buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    /// The next bits, from the highest on, and then 0.
    window: u32,
    /// How many of them there are.
    available: u32,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, window: 0, available: 0 }
    }

    /// The next `count` bits, up to 32.
    #[inline]
    pub(super) fn take(&mut self, count: u32) -> Option<u32> {
        if count > 16 {
            let high = self.take_few(count - 16)?;
            Some(high << 16 | self.take_few(16)?)
        } else {
            self.take_few(count)
        }
    }

    /// The value of the next `code(value, k)`.
    pub(super) fn take_code(&mut self, k: u32) -> Option<u32> {
        self.fill();
        let zeros = self.window.leading_zeros();
        let number =
            if 2 * zeros < self.available { self.shift(2 * zeros + 1) } else { self.take_long()? };
        Some((number - 1).unbounded_shl(k) | self.take_few(k)?)
    }

    /// A number after as many 0 as it has bits after its first, longer than the window.
    fn take_long(&mut self) -> Option<u32> {
        let mut zeros = 0;
        while self.take_few(1)? == 0 {
            zeros += 1;
            if zeros == 32 {
                return None;
            }
        }
        Some(1_u32 << zeros | self.take(zeros)?)
    }

    /// Up to 16.
    fn take_few(&mut self, count: u32) -> Option<u32> {
        self.fill();
        (count <= self.available).then(|| self.shift(count))
    }

    /// At least 25 bits in the window, if there are.
    fn fill(&mut self) {
        while self.available <= 24 {
            let Some((&byte, rest)) = self.bytes.split_first() else { return };
            self.window |= u32::from(byte) << (24 - self.available);
            self.available += 8;
            self.bytes = rest;
        }
    }

    /// The first `count` bits of the window, which has so many.
    fn shift(&mut self, count: u32) -> u32 {
        let bits = self.window.unbounded_shr(32 - count);
        self.window = self.window.unbounded_shl(count);
        self.available -= count;
        bits
    }

    /// Whether all that is left are fewer than 8 bits of 0.
    pub(super) fn is_padding(self) -> bool {
        self.bytes.is_empty() && self.available < 8 && self.window == 0
    }
}

/// 0, -1, 1, -2 … to 0, 1, 2, 3 …
pub(super) fn zigzag(value: i32) -> u32 {
    (value << 1 ^ value >> 31) as u32
}

/// The inverse of [`zigzag`].
pub(super) fn unzigzag(code: u32) -> i32 {
    (code >> 1) as i32 ^ -((code & 1) as i32)
}
