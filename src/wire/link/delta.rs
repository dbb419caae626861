//! The bits of an event, which code its difference from the event before; the module's page specifies them.

use core::num::NonZeroU32;

use super::Coding;
use super::bits::{BitReader, PutBits, TakeBits};
use super::steps::Steps;
use crate::Polarity;
use crate::event::{Event, Tick};
use crate::num::LACKS_DIVISION;

/// The longest time from the frame's tick to an event, in µs: 8.9 minutes.
const MAX_SINCE_START: u32 = 1 << 29;

/// How many addresses there are.
const ADDRESSES: u32 = 1 << 16;

/// How many low bits a code has for the polarity, below those of the address.
const POLARITY: u32 = 1;

/// The tick and address from which the next event is coded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    coding: Coding,
    tick: Tick,
    /// The lowest address that the next event can have at this tick: one above the last event, up to 65 536.
    next_address: u32,
    /// The addresses of this frame whose step number is known, a bit each.
    numbered: u16,
}

/// An event, and the low bits of its address's step number after it, which the first event of an address has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbered {
    pub(super) event: Event,
    pub(super) number: Option<u8>,
}

impl Place {
    /// The beginning of a frame. The coding is within its limits.
    pub(super) fn new(coding: Coding, tick: Tick) -> Self {
        Self { coding, tick, next_address: 0, numbered: 0 }
    }

    /// Puts the bits of an event of the frame with this tick; `None` if it lies more than [`MAX_SINCE_START`] from there.
    #[inline]
    pub(super) fn put(&self, event: Event, start: Tick, bits: &mut impl PutBits) -> Option<()> {
        let Coding { period, address_bits, jitter_bits, .. } = self.coding;
        let address = u32::from(event.address);
        let up = u32::from(event.polarity == Polarity::Up);
        let address_bits = u32::from(address_bits) + POLARITY;
        let since = event.tick.since(self.tick);
        match address.checked_sub(self.next_address) {
            Some(distance) if since == 0 => {
                bits.put(0, 1);
                bits.put_code(distance << POLARITY | up, address_bits);
            }
            _ => {
                let since_start = event.tick.micros().wrapping_sub(start.micros());
                if since_start.wrapping_add(MAX_SINCE_START) > 2 * MAX_SINCE_START {
                    return None;
                }
                let (steps, jitter) = nearest_step(since, period);
                bits.put(1, 1);
                bits.put_code(zigzag(steps.wrapping_sub(1)), 0);
                put_jitter(jitter, jitter_bits, bits);
                bits.put_code(address << POLARITY | up, address_bits);
            }
        }
        Some(())
    }

    /// Whether events have step numbers.
    #[inline]
    pub(super) fn has_numbers(&self) -> bool {
        self.coding.step_bits > 0
    }

    /// Whether an event of this address has its step number.
    #[inline]
    pub(super) fn has_number(&self, address: u16) -> bool {
        self.has_numbers() && self.is_first_of(address)
    }

    #[inline(never)]
    fn is_first_of(&self, address: u16) -> bool {
        Steps::has(address) && self.numbered.unbounded_shr(address.into()) & 1 == 0
    }

    /// Takes the bits of an event; `None` if they code no event.
    #[inline]
    pub(super) fn take(&self, bits: &mut impl TakeBits) -> Option<Numbered> {
        let event = self.take_event(bits)?;
        let mut number = None;
        if self.has_number(event.address) {
            number = Some(bits.take(self.coding.step_bits.into())? as u8);
        }
        Some(Numbered { event, number })
    }

    #[inline]
    fn take_event(&self, bits: &mut impl TakeBits) -> Option<Event> {
        let Coding { period, address_bits, jitter_bits, .. } = self.coding;
        let (mut tick, mut next_address) = (self.tick, self.next_address);
        if bits.take(1)? == 1 {
            let steps = unzigzag(bits.take_code(0)?).wrapping_add(1);
            let jitter = unzigzag(bits.take_code(jitter_bits.into())?);
            let since = steps.wrapping_mul(period.get().cast_signed()).wrapping_add(jitter);
            tick = tick.shifted(since);
            next_address = 0;
        }
        let code = bits.take_code(u32::from(address_bits) + POLARITY)?;
        let polarity = if code & 1 == 1 { Polarity::Up } else { Polarity::Down };
        let distance = code >> POLARITY;
        (distance < ADDRESSES.wrapping_sub(next_address)).then(|| {
            let address = next_address.wrapping_add(distance) as u16;
            Event { tick, address, polarity }
        })
    }

    pub(super) fn coding(&self) -> Coding {
        self.coding
    }

    /// The tick of the last event, or of the frame.
    pub(super) fn tick(&self) -> Tick {
        self.tick
    }

    /// Codes the next event from this one.
    #[inline]
    pub(super) fn pass(&mut self, event: Event) {
        self.tick = event.tick;
        self.next_address = u32::from(event.address) + 1;
        if self.has_numbers() && Steps::has(event.address) {
            self.numbered |= 1_u16.wrapping_shl(event.address.into());
        }
    }
}

/// Puts a jitter.
#[inline]
pub(super) fn put_jitter(jitter: i32, jitter_bits: u8, bits: &mut impl PutBits) {
    let jitter_bits = u32::from(jitter_bits);
    if LACKS_DIVISION && jitter == 0 {
        // The code of 0, as a timer has no jitter. Other cores code any number as quickly.
        bits.put(1_u32.wrapping_shl(jitter_bits), jitter_bits + 1);
    } else {
        bits.put_code(zigzag(jitter), jitter_bits);
    }
}

/// The time of a short frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShortTime {
    /// The low bits of the number of its point on the grid.
    pub(super) count: u32,
    pub(super) jitter: i32,
}

impl ShortTime {
    /// Puts the bits of the time.
    #[inline]
    pub(super) fn put(self, grid_bits: u32, jitter_bits: u8, bits: &mut impl PutBits) {
        bits.put(self.count, grid_bits);
        put_jitter(self.jitter, jitter_bits, bits);
    }

    /// Takes the bits of a time; `None` if there are too few.
    #[inline]
    pub(super) fn take(grid_bits: u32, jitter_bits: u8, bits: &mut BitReader<'_>) -> Option<Self> {
        let mut glance = bits.glance();
        match Self::take_from(grid_bits, jitter_bits, &mut glance) {
            Some(time) if bits.pass(glance).is_some() => Some(time),
            _ => Self::take_from(grid_bits, jitter_bits, bits),
        }
    }

    #[inline]
    fn take_from(grid_bits: u32, jitter_bits: u8, bits: &mut impl TakeBits) -> Option<Self> {
        let count = if grid_bits > 0 { bits.take(grid_bits)? } else { 0 };
        let jitter = unzigzag(bits.take_code(jitter_bits.into())?);
        Some(Self { count, jitter })
    }
}

/// `since` as the nearest number of periods, and the rest: at most half a period.
pub(super) fn nearest_step(since: i32, period: NonZeroU32) -> (i32, i32) {
    let magnitude = since.unsigned_abs().wrapping_add(period.get() / 2) / period;
    let steps = if since < 0 { (magnitude as i32).wrapping_neg() } else { magnitude as i32 };
    (steps, since.wrapping_sub(steps.wrapping_mul(period.get() as i32)))
}

/// 0, -1, 1, -2 … to 0, 1, 2, 3 …
fn zigzag(value: i32) -> u32 {
    (value << 1 ^ value >> 31) as u32
}

/// The inverse of [`zigzag`].
fn unzigzag(code: u32) -> i32 {
    (code >> 1) as i32 ^ -((code & 1) as i32)
}
