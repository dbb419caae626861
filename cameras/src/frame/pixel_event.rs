//! An event of a pixel: where, when, and brighter or darker.

use spikewire::{Event, Polarity, Tick};

/// An event of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PixelEvent {
    /// When.
    pub tick: Tick,
    /// The column, from 0 at the left.
    pub x: u16,
    /// The row, from 0 at the top.
    pub y: u16,
    /// Up for brighter (ON), down for darker (OFF).
    pub polarity: Polarity,
}

impl PixelEvent {
    /// The event at its address, `first_address + y * width + x`; `None` if that has more than 16 bits.
    pub const fn to_event(self, width: u16, first_address: u16) -> Option<Event> {
        let address = first_address as u64 + self.y as u64 * width as u64 + self.x as u64;
        if address > u16::MAX as u64 {
            return None;
        }
        Some(Event { tick: self.tick, address: address as u16, polarity: self.polarity })
    }

    /// The event of an address `first_address + y * width + x`; `None` if the address is lower or the width 0.
    pub const fn from_event(event: Event, width: u16, first_address: u16) -> Option<Self> {
        let Event { tick, address, polarity } = event;
        let Some(place) = address.checked_sub(first_address) else { return None };
        let (Some(x), Some(y)) = (place.checked_rem(width), place.checked_div(width)) else {
            return None;
        };
        Some(Self { tick, x, y, polarity })
    }
}
