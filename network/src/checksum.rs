//! A checksum over a network's parameters, which notices changed bits in flash.

/// A checksum over words of 32 bits.
///
/// For each word, the sum is rotated left by 5 bits, combined with the word by exclusive or, and multiplied by
/// 0x9E37_79B1. Each of the three is a one-to-one map of the sum, so that a change within one word always changes the
/// result. The rotation keeps changes of the same bit in two words from cancelling each other out.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Checksum(u32);

impl Checksum {
    /// Starts a checksum before the first word.
    pub(crate) const fn new() -> Self {
        Self(0)
    }

    /// Adds a word.
    #[inline]
    pub(crate) const fn add(&mut self, word: u32) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9E37_79B1);
    }

    /// Returns the checksum.
    pub(crate) const fn end(self) -> u32 {
        self.0
    }
}
