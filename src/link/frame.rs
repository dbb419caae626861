//! The layout of a frame, and a checked view of one.

use core::num::NonZeroU16;

use crc::{CRC_32_ISO_HDLC, Crc, Table};

use super::bits::BitReader;
use super::delta::Place;
use super::{Coding, LinkError};
use crate::Event;

/// The bytes of a frame without keyframes and events.
pub const MIN_FRAME: usize = HEADER + CHECKSUM;
/// The bytes of the longest frame.
pub const MAX_FRAME: usize = MIN_FRAME + MAX_LENGTH;

pub(super) const HEADER: usize = 12;
pub(super) const CHECKSUM: usize = 4;
pub(super) const MAX_LENGTH: usize = u8::MAX as usize;
pub(super) const MAGIC: u8 = 0xA5;
pub(super) const VERSION: u8 = 1;
/// Where the version and flags are, and the length.
pub(super) const FLAGS_AT: usize = 1;
pub(super) const LENGTH_AT: usize = 11;

pub(super) mod flag {
    pub(in crate::link) const LOST: u8 = 1;
    pub(in crate::link) const RESTART: u8 = 2;
    pub(in crate::link) const KEYFRAMES: u8 = 4;
    pub(in crate::link) const WIDE: u8 = 8;
}

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

pub(super) fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// What the decoder of an address holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Keyframe {
    /// The address of the channel's first neuron.
    pub address: u16,
    /// The sample's bits; see [`Raw`](super::Raw).
    pub raw: u32,
}

/// A frame, read in place: nothing is copied.
///
/// Checked once, by [`new`](Self::new); reading cannot fail then.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    flags: u8,
    sequence: u16,
    tick: u32,
    coding: Coding,
    keyframes: &'a [u8],
    events: &'a [u8],
}

impl<'a> FrameView<'a> {
    /// The frame that these bytes begin with, and how long it is.
    ///
    /// # Errors
    /// Every error but [`Full`](LinkError::Full) and [`KeyframeOrder`](LinkError::KeyframeOrder),
    /// in the order of the bytes that tell it.
    pub fn new(bytes: &'a [u8]) -> Result<(Self, usize), LinkError> {
        let length = Self::length(bytes)?;
        let truncated = LinkError::Truncated { needed: length, found: bytes.len() };
        let (body, rest) = bytes.split_at_checked(length - CHECKSUM).ok_or(truncated)?;
        let found = u32::from_le_bytes(*rest.first_chunk().ok_or(truncated)?);
        let computed = checksum(body);
        if found != computed {
            return Err(LinkError::Checksum { found, computed });
        }
        Ok((Self::read(body).ok_or(LinkError::Header)?, length))
    }

    /// A frame without its checksum, which was checked.
    pub(super) fn read(body: &'a [u8]) -> Option<Self> {
        let (header, payload) = body.split_first_chunk::<HEADER>()?;
        let &[_, flags, s0, s1, t0, t1, t2, t3, p0, p1, coding, _] = header;
        let (keyframes, events) = split_keyframes(flags, payload)?;
        Some(Self {
            flags,
            sequence: u16::from_le_bytes([s0, s1]),
            tick: u32::from_le_bytes([t0, t1, t2, t3]),
            coding: Coding::from_byte(NonZeroU16::new(u16::from_le_bytes([p0, p1]))?, coding),
            keyframes,
            events,
        })
    }

    /// How long the frame is that these bytes begin with, as soon as they tell.
    ///
    /// # Errors
    /// They do not tell yet, or begin no frame.
    pub fn length(bytes: &[u8]) -> Result<usize, LinkError> {
        let truncated = LinkError::Truncated { needed: MIN_FRAME, found: bytes.len() };
        match *bytes {
            [] => return Err(truncated),
            [magic, ..] if magic != MAGIC => return Err(LinkError::NotAFrame { found: magic }),
            [_, version, ..] if version >> 4 != VERSION => {
                return Err(LinkError::Version { found: version >> 4 });
            }
            [_, _, _, _, _, _, _, _, 0, 0, ..] => return Err(LinkError::Header),
            _ => {}
        }
        let length = bytes.get(LENGTH_AT).ok_or(truncated)?;
        Ok(MIN_FRAME + usize::from(*length))
    }

    /// The frame's number, which wraps after 65 535.
    pub fn sequence(&self) -> u16 {
        self.sequence
    }

    /// The tick of the keyframes, at or before that of the first event unless events are out of
    /// order.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// Whether the sender lost events before this frame.
    pub fn is_after_loss(&self) -> bool {
        self.flags & flag::LOST != 0
    }

    /// Whether it is the sender's first.
    pub fn is_restart(&self) -> bool {
        self.flags & flag::RESTART != 0
    }

    /// Whether the keyframes have 32 bits, not 16.
    pub fn is_wide(&self) -> bool {
        self.flags & flag::WIDE != 0
    }

    /// What decoders hold before the events of this frame.
    pub fn keyframes(&self) -> impl Iterator<Item = Keyframe> + use<'a> {
        self.keyframes.chunks_exact(keyframe_size(self.flags)).filter_map(|entry| match *entry {
            [a0, a1, r0, r1] => Some(Keyframe {
                address: u16::from_le_bytes([a0, a1]),
                raw: u16::from_le_bytes([r0, r1]).into(),
            }),
            [a0, a1, r0, r1, r2, r3] => Some(Keyframe {
                address: u16::from_le_bytes([a0, a1]),
                raw: u32::from_le_bytes([r0, r1, r2, r3]),
            }),
            _ => None,
        })
    }

    /// The events, in the order they were written.
    pub fn events(&self) -> Events<'a> {
        Events { bits: BitReader::new(self.events), place: Place::new(self.coding, self.tick) }
    }
}

pub(super) fn keyframe_size(flags: u8) -> usize {
    if flags & flag::WIDE != 0 { 6 } else { 4 }
}

fn split_keyframes(flags: u8, payload: &[u8]) -> Option<(&[u8], &[u8])> {
    if flags & flag::KEYFRAMES == 0 {
        return Some((&[], payload));
    }
    let (&count, rest) = payload.split_first()?;
    rest.split_at_checked(usize::from(count) * keyframe_size(flags))
}

/// The events of a frame; see [`FrameView::events`].
#[derive(Clone, Debug)]
pub struct Events<'a> {
    bits: BitReader<'a>,
    place: Place,
}

impl Events<'_> {
    /// After the last event: whether all bits were read. Not so if a sender writes what no event
    /// can be.
    pub fn is_complete(&self) -> bool {
        self.bits.is_padding()
    }

    /// An event that a glance does not show: longer, or none.
    #[cold]
    #[inline(never)]
    fn take_long(&mut self) -> Option<Event> {
        if self.is_complete() {
            return None;
        }
        let mut bits = self.bits;
        let event = self.place.take(&mut bits)?;
        self.bits = bits;
        Some(event)
    }
}

impl Iterator for Events<'_> {
    type Item = Event;

    fn next(&mut self) -> Option<Event> {
        let mut glance = self.bits.glance();
        let event = match self.place.take(&mut glance) {
            Some(event) if self.bits.pass(glance).is_some() => event,
            _ => self.take_long()?,
        };
        self.place.pass(event);
        Some(event)
    }
}
