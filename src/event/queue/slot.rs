//! An item in a queue: 12 bytes.

use crate::event::{Event, Item, Keyframe, Tick};
use crate::{Polarity, SampleKind};

/// An item, and how many items were lost before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    tick: Tick,
    /// Of a keyframe.
    bits: u32,
    address: u16,
    /// What it is, in the high 2 bits; of an event the polarity, of a keyframe the sample's kind.
    flags: u8,
    /// How many were lost before it; 255 for as many or more.
    pub(super) lost: u8,
}

const WHAT: u8 = 0xC0;
const EVENT: u8 = 0x00;
const KEYFRAME: u8 = 0x40;
const BREAK: u8 = 0x80;
const UP: u8 = 1;

impl Slot {
    pub(super) const EMPTY: Self = Self::lost_at(Tick::from_micros(0));

    /// A break.
    pub(super) const fn lost_at(tick: Tick) -> Self {
        Self { tick, bits: 0, address: 0, flags: BREAK, lost: 0 }
    }

    pub(super) const fn with_lost(self, lost: u8) -> Self {
        Self { lost, ..self }
    }

    pub(super) const fn tick(self) -> Tick {
        self.tick
    }

    #[inline]
    pub(super) fn item(self) -> Item {
        let Self { tick, bits, address, flags, .. } = self;
        if flags & WHAT == EVENT {
            let polarity = if flags == EVENT { Polarity::Down } else { Polarity::Up };
            return Item::Event(Event { tick, address, polarity });
        }
        match SampleKind::from_byte(flags & !WHAT) {
            Some(kind) if flags & WHAT == KEYFRAME => {
                Item::Keyframe(Keyframe { tick, address, kind, bits })
            }
            _ => Item::Break(tick),
        }
    }
}

impl From<Item> for Slot {
    #[inline]
    fn from(item: Item) -> Self {
        match item {
            Item::Event(Event { tick, address, polarity }) => {
                let flags = if polarity == Polarity::Up { EVENT | UP } else { EVENT };
                Self { tick, bits: 0, address, flags, lost: 0 }
            }
            Item::Keyframe(Keyframe { tick, address, kind, bits }) => {
                Self { tick, bits, address, flags: KEYFRAME | kind.to_byte(), lost: 0 }
            }
            Item::Break(tick) => Self::lost_at(tick),
        }
    }
}
