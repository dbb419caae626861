//! Time on the link: microseconds of the sender, modulo 2⁴⁸ (8.9 years).

use crate::event::Tick;

const BITS: u32 = 48;
const MASK: u64 = (1 << BITS) - 1;

/// The longest silence that a sender is certain of, in µs: 17.9 minutes. A tick further from the one before may as well
/// lie 2³² µs away.
const MAX_SILENCE: u32 = 1 << 30;

/// A time of the sender in µs, modulo 2⁴⁸.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Time(u64);

impl Time {
    pub(super) const fn from_micros(micros: u64) -> Self {
        Self(micros & MASK)
    }

    pub(super) const fn micros(self) -> u64 {
        self.0
    }

    #[inline]
    pub(super) const fn tick(self) -> Tick {
        Tick::from_micros(self.0)
    }

    /// The time with this tick that is nearest to this one.
    #[inline]
    pub(super) fn nearest(self, tick: Tick) -> Self {
        Self::from_micros(self.0.wrapping_add_signed(tick.since(self.tick()).into()))
    }

    /// Whether the time with this tick is certain, for a sender that was at this time before.
    #[inline]
    pub(super) fn is_certain(self, tick: Tick) -> bool {
        tick.since(self.tick()).unsigned_abs() <= MAX_SILENCE
    }

    /// The µs from `earlier` to this time; negative if this one is earlier.
    #[inline]
    pub(super) const fn since(self, earlier: Self) -> i64 {
        const UNUSED: u32 = u64::BITS - BITS;
        (self.0.wrapping_sub(earlier.0) << UNUSED).cast_signed() >> UNUSED
    }

    #[inline]
    pub(super) const fn after(self, micros: u64) -> Self {
        Self::from_micros(self.0.wrapping_add(micros))
    }

    #[inline]
    pub(super) const fn before(self, micros: u64) -> Self {
        Self::from_micros(self.0.wrapping_sub(micros))
    }
}
