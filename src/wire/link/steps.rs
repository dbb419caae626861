//! Step numbers: how often each of the first addresses went up, less how often it went down.

use crate::Polarity;
use crate::event::Event;

/// How many addresses have a step number, from 0 on.
const NUMBERED: u16 = 16;

/// The most low bits of a step number that an event has.
pub(super) const MOST_BITS: u8 = 4;

/// The low bits of each step number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps(u64);

impl Steps {
    pub(super) const ZERO: Self = Self(0);

    /// Whether this address has a step number.
    #[inline]
    pub(super) const fn has(address: u16) -> bool {
        address < NUMBERED
    }

    /// Where the bits of an address begin.
    #[inline]
    fn shift(address: u16) -> u32 {
        u32::from(address).wrapping_mul(MOST_BITS.into())
    }

    /// The low bits of an address's number, as many as the mask has; 0 for an address without.
    #[inline]
    pub(super) fn number(self, address: u16, mask: u8) -> u8 {
        if Self::has(address) { self.0.wrapping_shr(Self::shift(address)) as u8 & mask } else { 0 }
    }

    /// The numbers after this event.
    #[inline]
    pub(super) fn after(self, event: Event) -> Self {
        const MASK: u64 = (1 << MOST_BITS) - 1;
        if !Self::has(event.address) {
            return self;
        }
        let shift = Self::shift(event.address);
        let number = self.0.wrapping_shr(shift);
        let next = match event.polarity {
            Polarity::Up => number.wrapping_add(1),
            Polarity::Down => number.wrapping_sub(1),
        };
        Self(self.0 ^ ((number ^ next) & MASK).wrapping_shl(shift))
    }
}
