//! Passes over the rows of a frame, within its budget.

use core::num::{NonZeroU8, NonZeroU32, NonZeroU64};

use super::PixelCode;
use crate::config::within;
use spikewire::{ConfigError, Polarity, Tick};

/// Which of a pixel's events are sent in one pass over a frame.
#[derive(Clone, Copy)]
pub(super) enum Pass {
    /// All of them.
    Whole,
    /// Those of a slot; the base moves in the last.
    Slot { slot: u32, is_last: bool },
}

/// A pass of a slot, and the tick of its events.
pub(super) struct Slot {
    pub(super) pass: Pass,
    pub(super) tick: Tick,
}

/// The slots of a frame, which divide the time since the frame before; all at its own tick if there is none.
pub(super) fn slots(count: NonZeroU8, before: Tick, now: Tick) -> impl Iterator<Item = Slot> {
    let passed = now.since(before).max(0) as u64;
    (1..=u32::from(count.get())).map(move |number| {
        let after = u64::from(number).wrapping_mul(passed) / NonZeroU64::from(count);
        let is_last = number == u32::from(count.get());
        Slot {
            pass: Pass::Slot { slot: number.wrapping_sub(1), is_last },
            tick: if passed > 0 { before + after as u32 } else { now },
        }
    })
}

/// How many events a frame may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    events: u32,
    /// Of this frame.
    left: u32,
    /// Over all frames.
    kept_back: u32,
}

impl Budget {
    pub(super) const NONE: Self = Self { events: u32::MAX, left: u32::MAX, kept_back: 0 };

    pub(super) const fn try_new(events: u32) -> Result<Self, ConfigError> {
        match within("event budget a frame", events as f64, 1.0, u32::MAX as f32) {
            Ok(()) => Ok(Self { events, left: events, kept_back: 0 }),
            Err(error) => Err(error),
        }
    }

    /// Begins a frame, or another pass over it: each allots the same events to the same pixels.
    pub(super) fn renew(&mut self) {
        self.left = self.events;
    }

    pub(super) const fn kept_back(&self) -> u32 {
        self.kept_back
    }

    /// Goes over a row once, and hands out each event's column and direction.
    #[inline]
    pub(super) fn encode<C: PixelCode>(
        &mut self,
        code: &C,
        pixels: &mut [C::Pixel],
        row: &[u8],
        pass: Pass,
        mut emit: impl FnMut(usize, Polarity),
    ) {
        let slots = NonZeroU32::from(code.most());
        code.row(pixels, row, |x, pixel, sample| {
            let due = code.steps(*pixel, sample);
            let wanted = u32::from(due.unsigned_abs());
            let granted = wanted.min(self.left);
            self.left = self.left.saturating_sub(granted);
            let polarity = if due > 0 { Polarity::Up } else { Polarity::Down };
            let (count, is_last) = match pass {
                Pass::Whole => (granted, true),
                Pass::Slot { slot, is_last } => (has_event(slot, granted, slots).into(), is_last),
            };
            for _ in 0..count {
                emit(x, polarity);
            }
            if is_last {
                let beyond = wanted.saturating_sub(granted);
                self.kept_back = self.kept_back.saturating_add(beyond);
                let steps = granted as i16;
                code.follow(pixel, if due > 0 { steps } else { steps.wrapping_neg() });
            }
        });
    }
}

/// Whether one of a pixel's `n` events falls into this slot: whether `⌊n * slot / slots⌋` is larger for the next slot.
#[inline]
fn has_event(slot: u32, n: u32, slots: NonZeroU32) -> bool {
    (slot.wrapping_mul(n) % slots).wrapping_add(n) >= slots.get()
}
