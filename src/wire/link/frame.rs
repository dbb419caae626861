//! The layout of a frame, and a view that reads one.

use core::num::NonZeroU16;

use crc::{CRC_32_ISO_HDLC, Crc, Table};

use super::bits::BitReader;
use super::delta::Place;
use super::time::Time;
use super::{Coding, LinkError};
use crate::event::{Event, Keyframe, Tick};
use crate::{Fingerprint, SampleKind};

/// The bytes of a frame without keyframes and events.
pub const MIN_FRAME: usize = HEADER + CHECKSUM;
/// The bytes of the longest frame.
pub const MAX_FRAME: usize = MIN_FRAME + MAX_LENGTH;

pub(super) const HEADER: usize = 18;
pub(super) const CHECKSUM: usize = 4;
pub(super) const MAX_LENGTH: usize = u8::MAX as usize;
pub(super) const MAGIC: u8 = 0xA5;
pub(super) const VERSION: u8 = 3;
/// The indices of the byte with version and flags, of the period, and of the length.
pub(super) const FLAGS_AT: usize = 1;
const PERIOD_AT: usize = 14;
pub(super) const LENGTH_AT: usize = 17;
/// The sample type of keyframes that have no value: heartbeats.
pub(super) const HEARTBEATS: u8 = u8::MAX;
/// The bytes of a fingerprint, before keyframes and events.
pub(super) const FINGERPRINT: usize = 4;

pub(super) mod flag {
    pub(in crate::wire::link) const LOST: u8 = 1;
    pub(in crate::wire::link) const KEYFRAMES: u8 = 2;
    pub(in crate::wire::link) const FIRST: u8 = 4;
    pub(in crate::wire::link) const FINGERPRINT: u8 = 8;
    /// Above the version.
    pub(in crate::wire::link) const DESCRIBED: u8 = 0x80;
}

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

pub(super) fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// A frame, read in place without a copy.
///
/// [`new`](Self::new) checks the frame; reading it cannot fail after that.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    flags: u8,
    number: u64,
    time: Time,
    coding: Coding,
    fingerprint: Option<Fingerprint>,
    /// The sample type of the keyframes; `None` if they are heartbeats.
    kind: Option<SampleKind>,
    keyframes: &'a [u8],
    events: &'a [u8],
}

impl<'a> FrameView<'a> {
    /// The frame that these bytes begin with, and how long it is.
    ///
    /// # Errors
    /// Returns an error if the bytes begin no frame, only part of one, or a damaged one: every error but
    /// [`Full`](LinkError::Full) and [`KeyframeOrder`](LinkError::KeyframeOrder).
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

    /// Reads a frame without its checksum, which was checked before.
    pub(super) fn read(body: &'a [u8]) -> Option<Self> {
        let (header, payload) = body.split_first_chunk::<HEADER>()?;
        let &[_, flags, n0, n1, n2, n3, n4, n5, t0, t1, t2, t3, t4, t5, p0, p1, coding, _] = header;
        let (fingerprint, payload) = split_fingerprint(flags, payload)?;
        let (kind, keyframes, events) = split_keyframes(flags, payload)?;
        Some(Self {
            flags,
            number: u64::from_le_bytes([n0, n1, n2, n3, n4, n5, 0, 0]),
            time: Time::from_micros(u64::from_le_bytes([t0, t1, t2, t3, t4, t5, 0, 0])),
            coding: Coding::from_byte(NonZeroU16::new(u16::from_le_bytes([p0, p1]))?, coding),
            fingerprint,
            kind,
            keyframes,
            events,
        })
    }

    /// The length of the frame that these bytes begin with, from its header.
    ///
    /// # Errors
    /// Returns an error if the header is incomplete, or the bytes begin no frame.
    pub fn length(bytes: &[u8]) -> Result<usize, LinkError> {
        let truncated = LinkError::Truncated { needed: MIN_FRAME, found: bytes.len() };
        match *bytes {
            [magic, ..] if magic != MAGIC => return Err(LinkError::NotAFrame { found: magic }),
            [_, flags, ..] if version(flags) != VERSION => {
                return Err(LinkError::Version { found: version(flags) });
            }
            _ => {}
        }
        if let Some([0, 0]) = bytes.get(PERIOD_AT..PERIOD_AT + 2) {
            return Err(LinkError::Header);
        }
        let length = bytes.get(LENGTH_AT).ok_or(truncated)?;
        Ok(MIN_FRAME + usize::from(*length))
    }

    /// The frame's number: 1 more than that of the frame before, modulo 2⁴⁸, from that of the
    /// [session](super::Session) on.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether it is the first frame of its session.
    pub fn is_first(&self) -> bool {
        self.flags & flag::FIRST != 0
    }

    /// Whether the sender has a [fingerprint], which comes with this frame or another.
    ///
    /// [fingerprint]: Self::fingerprint
    pub fn is_described(&self) -> bool {
        self.flags & flag::DESCRIBED != 0
    }

    /// The fingerprint of the sender's schemes, in a frame that has it.
    pub fn fingerprint(&self) -> Option<Fingerprint> {
        self.fingerprint
    }

    /// The tick of the keyframes: at or before that of the first event, unless events are out of order.
    pub fn tick(&self) -> Tick {
        self.time.tick()
    }

    /// The time of [`tick`](Self::tick) in µs, modulo 2⁴⁸ (8.9 years), from any start of the sender's.
    pub fn micros(&self) -> u64 {
        self.time.micros()
    }

    pub(super) fn time(&self) -> Time {
        self.time
    }

    /// Whether the sender lost items before this frame, or its encoders changed without events.
    pub fn is_after_loss(&self) -> bool {
        self.flags & flag::LOST != 0
    }

    /// The period of the sender's samples, in µs.
    pub fn period(&self) -> NonZeroU16 {
        self.coding.period
    }

    /// The values that decoders should hold before the events of this frame.
    pub fn keyframes(&self) -> impl Iterator<Item = Keyframe> + use<'a> {
        let Self { time, kind, .. } = *self;
        self.entries().filter_map(move |(address, bits)| {
            let bits = match *bits {
                [b0, b1] => u16::from_le_bytes([b0, b1]).into(),
                [b0, b1, b2, b3] => u32::from_le_bytes([b0, b1, b2, b3]),
                _ => return None,
            };
            Some(Keyframe { tick: time.tick(), address, kind: kind?, bits })
        })
    }

    /// The addresses of its [heartbeats](crate::Item::Heartbeat), at the frame's tick.
    pub fn heartbeats(&self) -> impl Iterator<Item = u16> + use<'a> {
        let is_heartbeat = self.kind.is_none();
        self.entries().filter_map(move |(address, _)| is_heartbeat.then_some(address))
    }

    /// Each keyframe or heartbeat: its address, and the bytes of its value.
    fn entries(&self) -> impl Iterator<Item = (u16, &'a [u8])> + use<'a> {
        self.keyframes.chunks_exact(keyframe_size(self.kind)).filter_map(|entry| {
            let (&address, bits) = entry.split_first_chunk()?;
            Some((u16::from_le_bytes(address), bits))
        })
    }

    /// This frame with its keyframes read as another sample type of the same width; `None` if the width differs. For
    /// programs that handle all fixed point of one width as one type.
    pub fn with_kind(self, kind: SampleKind) -> Option<Self> {
        let is_as_wide = self.kind.is_some_and(|sent| sent.size() == kind.size());
        is_as_wide.then_some(Self { kind: Some(kind), ..self })
    }

    /// The events, in the order they were written.
    pub fn events(&self) -> Events<'a> {
        Events { bits: BitReader::new(self.events), place: Place::new(self.coding, self.tick()) }
    }
}

/// The bytes of a keyframe, its address and its sample; or of a heartbeat, which has no sample.
pub(super) const fn keyframe_size(kind: Option<SampleKind>) -> usize {
    match kind {
        Some(kind) => 2 + kind.size(),
        None => 2,
    }
}

/// The version of the link, between the flags of a byte.
const fn version(flags: u8) -> u8 {
    flags >> 4 & 7
}

/// The fingerprint, and what follows it.
fn split_fingerprint(flags: u8, payload: &[u8]) -> Option<(Option<Fingerprint>, &[u8])> {
    if flags & flag::FINGERPRINT == 0 {
        return Some((None, payload));
    }
    let (bits, rest) = payload.split_first_chunk::<FINGERPRINT>()?;
    Some((Some(Fingerprint::from_bits(u32::from_le_bytes(*bits))), rest))
}

/// The keyframes with their sample type, and the events.
fn split_keyframes(flags: u8, payload: &[u8]) -> Option<(Option<SampleKind>, &[u8], &[u8])> {
    if flags & flag::KEYFRAMES == 0 {
        return Some((None, &[], payload));
    }
    let (&[count, kind], rest) = payload.split_first_chunk()?;
    let kind = if kind == HEARTBEATS { None } else { Some(SampleKind::from_byte(kind)?) };
    let (keyframes, events) = rest.split_at_checked(usize::from(count) * keyframe_size(kind))?;
    Some((kind, keyframes, events))
}

/// The events of a frame; see [`FrameView::events`].
#[derive(Clone, Debug)]
pub struct Events<'a> {
    bits: BitReader<'a>,
    place: Place,
}

impl Events<'_> {
    /// After the last event, whether all bits were read. False if bits are left that code no event.
    pub fn is_complete(&self) -> bool {
        self.bits.is_padding()
    }

    /// The next event, if it is longer than a glance; `None` if the next bits code no event.
    #[cold]
    #[inline(never)]
    fn take_long(&mut self) -> Option<Event> {
        if self.is_complete() {
            return None;
        }
        let mut bits = self.bits;
        let event = self.place.take(&mut bits)?;
        self.bits = bits;
        self.place.pass(event);
        Some(event)
    }
}

impl Iterator for Events<'_> {
    type Item = Event;

    #[allow(clippy::inline_always)] // a fifth of its cost would be the call
    #[inline(always)]
    fn next(&mut self) -> Option<Event> {
        let mut glance = self.bits.glance();
        if let Some(event) = self.place.take(&mut glance)
            && self.bits.pass(glance).is_some()
        {
            self.place.pass(event);
            return Some(event);
        }
        self.take_long()
    }
}
