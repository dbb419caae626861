//! Items: the events, keyframes, heartbeats and breaks that go from the interrupt to the wire in one order.

use super::{Event, Keyframe, Tick};

/// One item of the stream: an event, a keyframe, a heartbeat or a break.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Item {
    /// A neuron fired.
    Event(Event),
    /// The value that the decoder of an address should hold at this point of the stream.
    Keyframe(Keyframe),
    /// The encoders changed without events, as by a reset: temporal decoders are wrong until their next keyframe.
    Break(Tick),
    /// A sample was taken at this tick, and all its events come before: the keyframe of a code without keyframes.
    Heartbeat {
        /// The tick of the sample.
        tick: Tick,
        /// The address of the bank's first neuron.
        address: u16,
    },
}

impl Item {
    /// The tick of the item.
    pub const fn tick(&self) -> Tick {
        match *self {
            Self::Event(Event { tick, .. })
            | Self::Keyframe(Keyframe { tick, .. })
            | Self::Heartbeat { tick, .. }
            | Self::Break(tick) => tick,
        }
    }
}

impl From<Event> for Item {
    fn from(event: Event) -> Self {
        Self::Event(event)
    }
}

impl From<Keyframe> for Item {
    fn from(keyframe: Keyframe) -> Self {
        Self::Keyframe(keyframe)
    }
}

/// An item taken from a source, with the number of items that were lost before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Taken {
    /// How many items were lost since the item taken before this one; `u32::MAX` for that many or more.
    pub lost: u32,
    /// The item.
    pub item: Item,
}

impl<T: Into<Item>> From<T> for Taken {
    fn from(item: T) -> Self {
        Self::whole(item.into())
    }
}

impl Taken {
    /// An item before which none was lost.
    pub const fn whole(item: Item) -> Self {
        Self { lost: 0, item }
    }

    /// Whether decoders are not exact at this item, because of a loss or a break.
    pub const fn is_after_break(&self) -> bool {
        self.lost > 0 || matches!(self.item, Item::Break(_))
    }
}
