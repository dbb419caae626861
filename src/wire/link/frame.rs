//! The layout of frames, and a view that reads one.

use core::num::NonZeroU32;
use core::ops::Range;

use super::bits::BitReader;
use super::crc::Register;
use super::delta::{Numbered, Place, ShortTime};
use super::known::{Known, Point};
use super::time::Time;
use super::{Coding, LinkError};
use crate::event::{Event, Keyframe, Tick};
use crate::{Fingerprint, SampleKind};

/// The bytes of a full frame without fingerprint, keyframes and events.
pub const MIN_FRAME: usize = HEADER + CHECKSUM;
/// The bytes of the longest frame.
pub const MAX_FRAME: usize = MIN_FRAME + MAX_LENGTH;

pub(super) const HEADER: usize = 24;
pub(super) const CHECKSUM: usize = 4;
pub(super) const MAX_LENGTH: usize = u8::MAX as usize;
pub(super) const MAGIC: u8 = 0xA5;
pub(super) const VERSION: u8 = 4;
/// The indices of the byte with version and flags, of the period, and of the length.
pub(super) const FLAGS_AT: usize = 1;
const PERIOD_AT: usize = 14;
pub(super) const LENGTH_AT: usize = 23;
/// The sample type of keyframes that have no value: heartbeats.
pub(super) const HEARTBEATS: u8 = u8::MAX;
/// The bytes of a fingerprint, before keyframes and events.
pub(super) const FINGERPRINT: usize = 4;

pub(super) mod flag {
    pub(in crate::wire::link) const LOST: u8 = 1;
    pub(in crate::wire::link) const KEYFRAMES: u8 = 2;
    pub(in crate::wire::link) const FIRST: u8 = 4;
    pub(in crate::wire::link) const FINGERPRINT: u8 = 8;
}

/// The first byte of a short frame.
pub(super) mod short {
    /// The high bits, with [`KEYFRAMES`] or without.
    pub(in crate::wire::link) const MAGIC: u8 = 0x60;
    pub(in crate::wire::link) const KEYFRAMES: u8 = 0x10;
    /// The low bits, 1 less than the length, or that a byte with the length follows.
    pub(in crate::wire::link) const LENGTH: u8 = 0x0F;
    /// The bytes before the payload: the first and the number, between which a length may stand.
    pub(in crate::wire::link) const HEADER: usize = 2;

    /// Whether a short frame may begin with this byte.
    #[inline]
    pub(in crate::wire::link) const fn begins_with(byte: u8) -> bool {
        byte & !(KEYFRAMES | LENGTH) == MAGIC
    }
}

/// What a frame says before its keyframes and events, and where in its bytes those are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Head {
    is_short: bool,
    flags: u8,
    pub(super) number: u64,
    pub(super) point: Point,
    /// The register after what a short frame leaves out.
    pub(super) register: Register,
    pub(super) time: Time,
    pub(super) coding: Coding,
    pub(super) fingerprint: Option<Fingerprint>,
    /// The sample type of the keyframes; `None` if they are heartbeats.
    kind: Option<SampleKind>,
    keyframes_at: u16,
    /// Where keyframes end, and the bits of time and events begin.
    bits_at: u16,
    /// The bits of the time, before those of events.
    time_bits: u8,
    /// The length without the checksum.
    pub(super) end: u16,
    pub(super) checksum: u32,
}

impl Head {
    /// The frame that these bytes begin with, and its length with the checksum. A short one can be read by a reader that
    /// knows the frame before.
    #[inline]
    pub(super) fn read(bytes: &[u8], known: Option<&Known>) -> Result<Self, LinkError> {
        match (bytes.first(), known) {
            (Some(&first), Some(known)) if short::begins_with(first) => {
                Self::read_short(bytes, first, known)
            }
            _ => Self::read_full(bytes),
        }
    }

    /// An empty frame after a loss, in the place of one that cannot be read.
    #[cold]
    pub(super) fn unread(known: &Known) -> Self {
        Self {
            is_short: true,
            flags: flag::LOST,
            number: known.number,
            point: known.point,
            register: Register::START,
            time: known.point.time,
            coding: known.coding,
            fingerprint: known.fingerprint,
            kind: None,
            keyframes_at: 0,
            bits_at: 0,
            time_bits: 0,
            end: 0,
            checksum: 0,
        }
    }

    pub(super) fn length(&self) -> usize {
        usize::from(self.end).wrapping_add(CHECKSUM)
    }

    /// A frame goes on from this one.
    pub(super) fn known(&self) -> Known {
        Known::new(self.coding, self.fingerprint, self.number, self.point)
    }

    pub(super) const fn is_short(&self) -> bool {
        self.is_short
    }

    pub(super) const fn is_first(&self) -> bool {
        self.flags & flag::FIRST != 0
    }

    fn read_full(bytes: &[u8]) -> Result<Self, LinkError> {
        let length = FrameView::length(bytes)?;
        let (body, checksum) = split_checksum(bytes, length)?;
        verify(Register::START.after(body), checksum)?;
        let (header, payload) = body.split_first_chunk::<HEADER>().ok_or(LinkError::Header)?;
        let &[
            _,
            flags,
            n0,
            n1,
            n2,
            n3,
            n4,
            n5,
            t0,
            t1,
            t2,
            t3,
            t4,
            t5,
            p0,
            p1,
            p2,
            code,
            step,
            c0,
            c1,
            j0,
            j1,
            _,
        ] = header;
        let period = NonZeroU32::new(u32::from_le_bytes([p0, p1, p2, 0]));
        let coding = Coding::from_bytes(period.ok_or(LinkError::Header)?, code, step)
            .ok_or(LinkError::Header)?;
        let count = u32::from(u16::from_le_bytes([c0, c1]));
        let jitter = i64::from(i16::from_le_bytes([j0, j1]));
        let time = Time::from_micros(u64::from_le_bytes([t0, t1, t2, t3, t4, t5, 0, 0]));
        let point =
            Point { time: time.before(jitter.cast_unsigned()), count: count & coding.grid_mask() };
        let (fingerprint, rest) = split_fingerprint(flags, payload).ok_or(LinkError::Header)?;
        let keyframes = Keyframes::read(flags & flag::KEYFRAMES != 0, coding, rest)?;
        let rest_at = body.len().wrapping_sub(rest.len());
        Ok(Self {
            is_short: false,
            flags,
            number: u64::from_le_bytes([n0, n1, n2, n3, n4, n5, 0, 0]),
            point,
            register: Register::START,
            time,
            coding,
            fingerprint,
            kind: keyframes.kind,
            keyframes_at: rest_at.wrapping_add(keyframes.from) as u16,
            bits_at: rest_at.wrapping_add(keyframes.to) as u16,
            time_bits: 0,
            end: body.len() as u16,
            checksum,
        })
    }

    fn read_short(bytes: &[u8], first: u8, known: &Known) -> Result<Self, LinkError> {
        let least = LinkError::Truncated { needed: short::HEADER + 1, found: bytes.len() };
        let &[_, second, third, ..] = bytes else { return Err(least) };
        let length = first & short::LENGTH;
        let (length, number, header) = if length < short::LENGTH {
            (usize::from(length) + 1, second, short::HEADER)
        } else if second > short::LENGTH {
            (usize::from(second), third, short::HEADER + 1)
        } else {
            return Err(LinkError::Header);
        };
        let coding = known.coding;
        let (body, checksum) = split_checksum(bytes, header + length + CHECKSUM)?;
        let payload = body.get(header..).unwrap_or_default();
        let has_keyframes = first & short::KEYFRAMES != 0;
        let keyframes = Keyframes::read(has_keyframes, coding, payload)?;
        let bits_at = header.wrapping_add(keyframes.to);
        let mut bits = BitReader::new(bytes, bits_at..body.len(), 0);
        let ShortTime { count, jitter } =
            ShortTime::take(known.grid_bits, coding.jitter_bits, &mut bits)
                .ok_or(LinkError::Header)?;
        let number = known.number_with(number);
        let next = known.point_with(count);
        let register = known.register_of(number, next);
        verify(register.after(body), checksum)?;
        let point = next.point;
        Ok(Self {
            is_short: true,
            flags: if has_keyframes { flag::KEYFRAMES } else { 0 },
            number,
            point,
            register,
            time: point.time.after(i64::from(jitter).cast_unsigned()),
            coding,
            fingerprint: known.fingerprint,
            kind: keyframes.kind,
            keyframes_at: header.wrapping_add(keyframes.from) as u16,
            bits_at: bits_at as u16,
            time_bits: bits.taken().wrapping_sub(bits_at.wrapping_mul(8)) as u8,
            end: body.len() as u16,
            checksum,
        })
    }
}

/// Splits a frame of this length from its checksum.
fn split_checksum(bytes: &[u8], length: usize) -> Result<(&[u8], u32), LinkError> {
    let truncated = LinkError::Truncated { needed: length, found: bytes.len() };
    let (body, rest) = bytes.split_at_checked(length.wrapping_sub(CHECKSUM)).ok_or(truncated)?;
    let checksum = u32::from_le_bytes(*rest.first_chunk().ok_or(truncated)?);
    Ok((body, checksum))
}

fn verify(register: Register, found: u32) -> Result<(), LinkError> {
    let computed = register.checksum();
    if found == computed { Ok(()) } else { Err(LinkError::Checksum { found, computed }) }
}

/// A frame, read in place without a copy.
///
/// [`new`](Self::new) checks the frame; reading it cannot fail after that.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    head: Head,
    /// With the checksum.
    bytes: &'a [u8],
}

impl<'a> FrameView<'a> {
    /// The full frame that these bytes begin with, and how long it is. Short frames, which leave out what their reader
    /// knows, take a [`Reader`](super::Reader).
    ///
    /// # Errors
    /// Returns an error if the bytes begin no full frame, only part of one, or a damaged one: every error but
    /// [`Full`](LinkError::Full) and [`KeyframeOrder`](LinkError::KeyframeOrder).
    pub fn new(bytes: &'a [u8]) -> Result<(Self, usize), LinkError> {
        let head = Head::read_full(bytes)?;
        Ok((Self::with_head(head, bytes), head.length()))
    }

    /// A frame whose head was read from the beginning of these bytes.
    pub(super) fn with_head(head: Head, bytes: &'a [u8]) -> Self {
        Self { head, bytes: bytes.get(..head.length()).unwrap_or_default() }
    }

    /// The length of the full frame that these bytes begin with, from its header.
    ///
    /// # Errors
    /// Returns an error if the header is incomplete, or the bytes begin no full frame.
    pub fn length(bytes: &[u8]) -> Result<usize, LinkError> {
        let truncated = LinkError::Truncated { needed: MIN_FRAME, found: bytes.len() };
        match *bytes {
            [magic, ..] if magic != MAGIC => return Err(LinkError::NotAFrame { found: magic }),
            [_, flags, ..] if version(flags) != VERSION => {
                return Err(LinkError::Version { found: version(flags) });
            }
            _ => {}
        }
        if let Some([0, 0, 0]) = bytes.get(PERIOD_AT..PERIOD_AT + 3) {
            return Err(LinkError::Header);
        }
        let length = bytes.get(LENGTH_AT).ok_or(truncated)?;
        Ok(MIN_FRAME + usize::from(*length))
    }

    /// The frame's number: 1 more than that of the frame before, modulo 2⁴⁸, from that of the
    /// [session](super::Session) on.
    pub fn number(&self) -> u64 {
        self.head.number
    }

    /// Whether it is a short frame, which leaves out what its reader knows.
    pub fn is_short(&self) -> bool {
        self.head.is_short
    }

    /// Whether it is the first frame of its session.
    pub fn is_first(&self) -> bool {
        self.head.is_first()
    }

    /// The fingerprint of the sender's schemes, if it has one.
    pub fn fingerprint(&self) -> Option<Fingerprint> {
        self.head.fingerprint
    }

    /// The tick of the keyframes: at or before that of the first event, unless events are out of order.
    pub fn tick(&self) -> Tick {
        self.head.time.tick()
    }

    /// The time of [`tick`](Self::tick) in µs, modulo 2⁴⁸ (8.9 years), from any start of the sender's.
    pub fn micros(&self) -> u64 {
        self.head.time.micros()
    }

    #[inline]
    pub(super) fn time(&self) -> Time {
        self.head.time
    }

    /// Whether the sender lost items before this frame, or its encoders changed without events.
    pub fn is_after_loss(&self) -> bool {
        self.head.flags & flag::LOST != 0
    }

    /// The period of the sender's samples, in µs.
    pub fn period(&self) -> NonZeroU32 {
        self.head.coding.period
    }

    /// The bits of a step number.
    pub(super) fn step_mask(&self) -> u8 {
        self.head.coding.step_mask()
    }

    /// The values that decoders should hold before the events of this frame.
    pub fn keyframes(&self) -> impl Iterator<Item = Keyframe> + use<'a> {
        self.numbered_keyframes().map(|(keyframe, _)| keyframe)
    }

    /// The keyframes, each with the low bits of its address's step number.
    pub(super) fn numbered_keyframes(&self) -> impl Iterator<Item = (Keyframe, u8)> + use<'a> {
        let Head { time, kind, .. } = self.head;
        self.entries().filter_map(move |(address, bits)| {
            let (bits, step) = match *bits {
                [b0, b1] => (u16::from_le_bytes([b0, b1]).into(), 0),
                [b0, b1, step] => (u16::from_le_bytes([b0, b1]).into(), step),
                [b0, b1, b2, b3] => (u32::from_le_bytes([b0, b1, b2, b3]), 0),
                [b0, b1, b2, b3, step] => (u32::from_le_bytes([b0, b1, b2, b3]), step),
                _ => return None,
            };
            Some((Keyframe { tick: time.tick(), address, kind: kind?, bits }, step))
        })
    }

    /// The addresses of its [heartbeats](crate::Item::Heartbeat), at the frame's tick.
    pub fn heartbeats(&self) -> impl Iterator<Item = u16> + use<'a> {
        let is_heartbeat = self.head.kind.is_none();
        self.entries().filter_map(move |(address, _)| is_heartbeat.then_some(address))
    }

    /// Whether it has keyframes or heartbeats.
    #[inline]
    pub(super) fn has_entries(&self) -> bool {
        self.head.keyframes_at < self.head.bits_at
    }

    /// Each keyframe or heartbeat: its address, and the bytes of its value.
    fn entries(&self) -> impl Iterator<Item = (u16, &'a [u8])> + use<'a> {
        let Head { keyframes_at, bits_at, coding, kind, .. } = self.head;
        let entries = self.part(keyframes_at.into()..bits_at.into());
        entries.chunks_exact(keyframe_size(kind, coding)).filter_map(|entry| {
            let (&address, bits) = entry.split_first_chunk()?;
            Some((u16::from_le_bytes(address), bits))
        })
    }

    /// This frame with its keyframes read as another sample type of the same width; `None` if the width differs. For
    /// programs that handle all fixed point of one width as one type.
    pub fn with_kind(self, kind: SampleKind) -> Option<Self> {
        let is_as_wide = self.head.kind.is_some_and(|sent| sent.size() == kind.size());
        is_as_wide.then_some(Self { head: Head { kind: Some(kind), ..self.head }, ..self })
    }

    /// The events, in the order they were written.
    pub fn events(&self) -> Events<'a> {
        let Head { bits_at, end, time_bits, coding, .. } = self.head;
        let bits = BitReader::new(self.bytes, bits_at.into()..end.into(), time_bits.into());
        Events { bits, place: Place::new(coding, self.tick()) }
    }

    fn part(&self, range: Range<usize>) -> &'a [u8] {
        self.bytes.get(range).unwrap_or_default()
    }
}

/// The bytes of a keyframe, its address, its sample and its step number; or of a heartbeat, which has an address only.
pub(super) const fn keyframe_size(kind: Option<SampleKind>, coding: Coding) -> usize {
    match kind {
        Some(kind) => 2 + kind.size() + (coding.step_bits > 0) as usize,
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

/// Where in a payload the keyframes are, and their sample type.
struct Keyframes {
    kind: Option<SampleKind>,
    from: usize,
    to: usize,
}

impl Keyframes {
    #[inline]
    fn read(is_there: bool, coding: Coding, payload: &[u8]) -> Result<Self, LinkError> {
        const RUN_HEADER: usize = 2;
        if !is_there {
            return Ok(Self { kind: None, from: 0, to: 0 });
        }
        let &[count, kind, ..] = payload else { return Err(LinkError::Header) };
        let kind = match kind {
            HEARTBEATS => None,
            kind => Some(SampleKind::from_byte(kind).ok_or(LinkError::Header)?),
        };
        let to = RUN_HEADER + usize::from(count) * keyframe_size(kind, coding);
        if to > payload.len() {
            return Err(LinkError::Header);
        }
        Ok(Self { kind, from: RUN_HEADER, to })
    }
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
    fn take_long(&mut self) -> Option<Numbered> {
        if self.is_complete() {
            return None;
        }
        let mut bits = self.bits;
        let next = self.place.take(&mut bits)?;
        self.bits = bits;
        self.place.pass(next.event);
        Some(next)
    }

    /// The next event, with its step number.
    #[allow(clippy::inline_always)] // a fifth of its cost would be the call
    #[inline(always)]
    pub(super) fn next_numbered(&mut self) -> Option<Numbered> {
        let mut glance = self.bits.glance();
        if glance.is_padding() {
            return None;
        }
        if let Some(next) = self.place.take(&mut glance)
            && self.bits.pass(glance).is_some()
        {
            self.place.pass(next.event);
            return Some(next);
        }
        self.take_long()
    }
}

impl Iterator for Events<'_> {
    type Item = Event;

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn next(&mut self) -> Option<Event> {
        Some(self.next_numbered()?.event)
    }
}
