//! A string of bits, high bit first, and its exponential Golomb codes.

use crate::bytes::Cursor;

/// Appends bits to a buffer.
#[derive(Debug)]
pub(super) struct BitWriter<'a> {
    bytes: Cursor<'a>,
    /// The low `pending` bits are not in the buffer yet; fewer than 8.
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
    pub(super) fn put(&mut self, value: u32, count: u32) -> Option<()> {
        let mut left = count;
        while left > 0 {
            let take = left.min(8 - self.pending);
            left -= take;
            self.bits = self.bits << take | (value >> left) & ((1 << take) - 1);
            self.pending += take;
            if self.pending == 8 {
                self.bytes.put(&[self.bits as u8])?;
                (self.bits, self.pending) = (0, 0);
            }
        }
        Some(())
    }

    /// `code(value, k)`, for values below 2³²-1 and `k` up to 15.
    pub(super) fn put_code(&mut self, value: u32, k: u32) -> Option<()> {
        let number = (value >> k).saturating_add(1);
        let bits = 32 - number.leading_zeros();
        self.put(0, bits - 1)?;
        self.put(number, bits)?;
        self.put(value, k)
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
    /// The next byte's first `used` bits are taken; fewer than 8.
    used: u32,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, used: 0 }
    }

    /// The next `count` bits, up to 32.
    pub(super) fn take(&mut self, count: u32) -> Option<u32> {
        let mut value = 0_u32;
        let mut left = count;
        while left > 0 {
            let (&byte, rest) = self.bytes.split_first()?;
            let take = left.min(8 - self.used);
            left -= take;
            let bits = u32::from(byte) >> (8 - self.used - take) & ((1 << take) - 1);
            value = value.unbounded_shl(take) | bits;
            self.used += take;
            if self.used == 8 {
                (self.bytes, self.used) = (rest, 0);
            }
        }
        Some(value)
    }

    /// The value of the next `code(value, k)`.
    pub(super) fn take_code(&mut self, k: u32) -> Option<u32> {
        let mut zeros = 0;
        while self.take(1)? == 0 {
            zeros += 1;
            if zeros == 32 {
                return None;
            }
        }
        let number = 1_u32 << zeros | self.take(zeros)?;
        Some((number - 1).unbounded_shl(k) | self.take(k)?)
    }

    /// Whether all that is left are fewer than 8 bits of 0.
    pub(super) fn is_padding(mut self) -> bool {
        match self.bytes {
            [] => true,
            [_] if self.used > 0 => self.take(8 - self.used) == Some(0),
            _ => false,
        }
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
