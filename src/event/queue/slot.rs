//! An item as a queue stores it: 12 bytes.

use crate::event::{Event, Item, Keyframe, Tick};
use crate::{Polarity, SampleKind};

/// An item and how many items were lost before it, in three words, which few stores write.
///
/// The last word is `lost << 24 | what << 22 | detail << 16 | address`. `lost` counts the items lost before this one,
/// 255 for as many or more; `what` is an event, a keyframe, a break or a heartbeat; `detail` is an event's polarity or a
/// keyframe's sample type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    tick: Tick,
    /// The value of a keyframe, else anything.
    bits: u32,
    rest: u32,
}

const LOST_AT: u32 = 24;
const WHAT_AT: u32 = 22;
const DETAIL_AT: u32 = 16;
/// The detail of an event with polarity up.
const UP: u32 = 1 << DETAIL_AT;
const EVENT: u32 = 0;
const KEYFRAME: u32 = 1;
const BREAK: u32 = 2;
const HEARTBEAT: u32 = 3;

impl Slot {
    /// All zeros, so that a queue that drops the oldest item, whose policy is 0, lies in `.bss` and takes no flash.
    pub(super) const EMPTY: Self = Self { tick: Tick::from_micros(0), bits: 0, rest: 0 };

    /// A break at this tick.
    const fn break_at(tick: Tick) -> Self {
        Self { tick, bits: 0, rest: BREAK << WHAT_AT }
    }

    pub(super) const fn with_lost(self, lost: u8) -> Self {
        let rest = self.rest & !(0xFF << LOST_AT) | (lost as u32) << LOST_AT;
        Self { rest, ..self }
    }

    /// How many items were lost before this one; 255 for as many or more.
    #[inline]
    pub(super) const fn lost(self) -> u8 {
        (self.rest >> LOST_AT) as u8
    }

    /// Its words, which stay in registers when passed to a function that is not inlined.
    #[inline]
    pub(super) const fn words(self) -> (Tick, u32, u32) {
        (self.tick, self.bits, self.rest)
    }

    /// The slot of these words.
    #[inline]
    pub(super) const fn from_words((tick, bits, rest): (Tick, u32, u32)) -> Self {
        Self { tick, bits, rest }
    }

    pub(super) const fn tick(self) -> Tick {
        self.tick
    }

    /// The event, if the item is an event and no item was lost before it, as usual.
    #[inline]
    pub(super) fn plain_event(self) -> Option<Event> {
        let Self { tick, rest, .. } = self;
        let polarity = if rest & UP == 0 { Polarity::Down } else { Polarity::Up };
        (rest < 2 * UP).then_some(Event { tick, address: rest as u16, polarity })
    }

    pub(super) fn item(self) -> Item {
        let Self { tick, bits, rest } = self;
        let address = rest as u16;
        let detail = (rest >> DETAIL_AT) as u8 & 0x3F;
        match rest >> WHAT_AT & 3 {
            EVENT => {
                let polarity = if rest & UP == 0 { Polarity::Down } else { Polarity::Up };
                Item::Event(Event { tick, address, polarity })
            }
            KEYFRAME => match SampleKind::from_byte(detail) {
                Some(kind) => Item::Keyframe(Keyframe { tick, address, kind, bits }),
                None => Item::Break(tick),
            },
            HEARTBEAT => Item::Heartbeat { tick, address },
            _ => Item::Break(tick),
        }
    }
}

impl From<Item> for Slot {
    #[inline]
    fn from(item: Item) -> Self {
        match item {
            Item::Event(Event { tick, address, polarity }) => {
                let up = if polarity == Polarity::Up { UP } else { 0 };
                // The tick is at hand, a 0 would have to be made.
                Self { tick, bits: tick.micros(), rest: up | u32::from(address) }
            }
            Item::Keyframe(Keyframe { tick, address, kind, bits }) => {
                let detail = u32::from(kind.to_byte()) << DETAIL_AT;
                Self { tick, bits, rest: KEYFRAME << WHAT_AT | detail | u32::from(address) }
            }
            Item::Heartbeat { tick, address } => {
                Self { tick, bits: 0, rest: HEARTBEAT << WHAT_AT | u32::from(address) }
            }
            Item::Break(tick) => Self::break_at(tick),
        }
    }
}
