//! Sessions: what tells one start of a sender from all others.

const BITS: u32 = 48;
const MASK: u64 = (1 << BITS) - 1;

/// One start of a sender, different from every other: the number of its first frame.
///
/// The numbers of a session's frames follow each other from there, modulo 2⁴⁸, so that a frame's number says whose frame
/// it is as well as how many are missing before it.
///
/// - **[`counted`](Self::counted)** for a board that counts its starts in flash. Any two of 65 536 starts in a row
///   lie at least 1.9 thousand million frames apart.
/// - **[`random`](Self::random)** for a board with a generator. A session continues the one before by chance in one of
///   2⁴⁸ restarts, and one in 2²⁴ looks like that one after lost frames, which is as safe as a start.
///
/// A constant, or a bit that changes at each start, is no session: a receiver that misses the starts between would go on
/// from values of an earlier one, and call them exact.
///
/// ```
/// use spikewire::link::Session;
///
/// let starts = 7; // read from flash, and written back as 8
/// assert_ne!(Session::counted(starts), Session::counted(starts + 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Session(u64);

impl Session {
    /// The session of a sender that started `starts` times before, a count that is kept over every reset and never goes
    /// back.
    pub const fn counted(starts: u32) -> Self {
        Self::spread(starts as u64)
    }

    /// The session of 64 bits from a generator of random numbers that differ at each start.
    pub const fn random(bits: u64) -> Self {
        Self::spread(bits)
    }

    /// Multiples of the golden ratio lie far apart, whichever of them are taken.
    const fn spread(number: u64) -> Self {
        Self(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (u64::BITS - BITS))
    }

    pub(super) const fn first_number(self) -> u64 {
        self.0
    }
}

/// The number of the frame after this one.
pub(super) const fn next(number: u64) -> u64 {
    masked(number.wrapping_add(1))
}

/// A number modulo 2⁴⁸.
pub(super) const fn masked(number: u64) -> u64 {
    number & MASK
}

/// How many frames `number` comes after `next`; negative if it comes before.
pub(super) const fn ahead(number: u64, next: u64) -> i64 {
    const UNUSED: u32 = u64::BITS - BITS;
    (number.wrapping_sub(next) << UNUSED).cast_signed() >> UNUSED
}
