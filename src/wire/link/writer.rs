//! Framer and frame writer: write frames into the caller's buffer.

use core::num::NonZeroU16;

use super::bits::{BitWriter, Word};
use super::delta::Place;
use super::frame::{
    CHECKSUM, FINGERPRINT, FLAGS_AT, HEADER, HEARTBEATS, LENGTH_AT, MAGIC, MAX_LENGTH, VERSION,
    checksum, flag, keyframe_size,
};
use super::time::Time;
use super::{LinkError, Session, session};
use crate::event::{Event, Keyframe, Tick};
use crate::wire::bytes::Cursor;
use crate::{Fingerprint, SampleKind};

/// How many bits the parts of an event take. Every choice can carry every event; a good one takes fewer bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coding {
    /// The time from sample to sample, in µs.
    pub period: NonZeroU16,
    /// About the binary logarithm of the distance between neighbouring addresses that fire. 0 to 15; larger values
    /// count as 15.
    pub address_bits: u8,
    /// About the binary logarithm of the jitter of ticks in µs, plus 1 for its sign. 0 to 15; larger values count as
    /// 15.
    pub jitter_bits: u8,
}

impl Coding {
    /// A coding for channels of one neuron each, sampled by a timer every `period` µs (0 counts as 1).
    pub const fn for_channels(channels: u16, period: u16) -> Self {
        let period = match NonZeroU16::new(period) {
            Some(period) => period,
            None => NonZeroU16::MIN,
        };
        // Best if few channels fire at a time; if many do, an event takes a bit or two more.
        let address_bits = (u16::BITS - (channels / 8).leading_zeros()) as u8;
        Self { period, address_bits, jitter_bits: 0 }
    }

    /// Sets the [bits for the jitter](Self::jitter_bits).
    #[must_use]
    pub const fn with_jitter_bits(self, jitter_bits: u8) -> Self {
        Self { jitter_bits, ..self }
    }

    const fn within_limits(self) -> Self {
        const fn nibble(bits: u8) -> u8 {
            if bits > 15 { 15 } else { bits }
        }
        Self {
            address_bits: nibble(self.address_bits),
            jitter_bits: nibble(self.jitter_bits),
            ..self
        }
    }

    pub(super) const fn byte(self) -> u8 {
        self.jitter_bits << 4 | self.address_bits
    }

    pub(super) const fn from_byte(period: NonZeroU16, byte: u8) -> Self {
        Self { period, address_bits: byte & 0xF, jitter_bits: byte >> 4 }
    }
}

/// Starts and numbers a sender's frames. A [`Transmitter`](super::Transmitter) does this for the items of a queue.
///
/// ```
/// use spikewire::{Event, Polarity, Tick, link::{Coding, FrameView, Framer, Session}};
///
/// let mut framer = Framer::new(Coding::for_channels(6, 1_000), Session::counted(1));
/// let tick = Tick::from_micros(2_000);
/// let mut buffer = [0; 64];
/// let mut frame = framer.start(tick, &mut buffer)?;
/// let event = Event { tick, address: 5, polarity: Polarity::Down };
/// frame.event(event)?;
/// let bytes = frame.finish();
///
/// let (view, length) = FrameView::new(bytes)?;
/// assert_eq!(length, bytes.len());
/// assert!(view.events().eq([event]));
/// # Ok::<(), spikewire::link::LinkError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Framer {
    coding: Coding,
    /// The number of the next frame.
    number: u64,
    /// The time of the last tick told; without meaning before the first frame.
    time: Time,
    /// The flags of the next frame.
    flags: u8,
    leaps: u32,
    fingerprint: Fingerprint,
    /// The tick of the last frame with the fingerprint, and how many frames came since.
    told_at: Tick,
    untold: u8,
}

/// The fingerprint goes into a frame that comes this many µs (0.52 s) after the last one that had it, or later.
const TELL_AFTER: u32 = 1 << 19;

/// The fingerprint goes into every fourth frame at most, if that has keyframes.
const TELL_EVERY: u8 = 4;

impl Framer {
    /// A framer before the first frame of this session.
    pub const fn new(coding: Coding, session: Session) -> Self {
        Self {
            coding: coding.within_limits(),
            number: session.first_number(),
            time: Time::from_micros(0),
            flags: flag::FIRST,
            leaps: 0,
            fingerprint: Fingerprint::from_bits(0),
            told_at: Tick::from_micros(0),
            untold: 0,
        }
    }

    /// Sends the fingerprint of the schemes: see
    /// [`Transmitter::with_fingerprint`](super::Transmitter::with_fingerprint).
    #[must_use]
    pub const fn with_fingerprint(self, fingerprint: Fingerprint) -> Self {
        Self { fingerprint, flags: self.flags | flag::DESCRIBED, ..self }
    }

    /// The fingerprint, if there is one.
    pub(super) const fn fingerprint(&self) -> Option<Fingerprint> {
        if self.flags & flag::DESCRIBED != 0 { Some(self.fingerprint) } else { None }
    }

    /// Whether a frame at this tick has the fingerprint, with or without keyframes.
    fn must_tell(&self, tick: Tick) -> bool {
        let since = tick.micros().wrapping_sub(self.told_at.micros());
        self.flags & flag::DESCRIBED != 0 && (self.flags & flag::FIRST != 0 || since >= TELL_AFTER)
    }

    /// Marks the next frame as one before which items were lost, or encoders changed without events.
    pub fn mark_loss(&mut self) {
        self.flags |= flag::LOST;
    }

    /// Tells the time; see [`Transmitter::observe`](super::Transmitter::observe).
    pub fn observe(&mut self, now: Tick) {
        if self.flags & flag::FIRST == 0 {
            self.go_to(now);
        }
    }

    /// How often the time could not be known; see [`Transmitter::leaps`](super::Transmitter::leaps).
    pub const fn leaps(&self) -> u32 {
        self.leaps
    }

    #[inline]
    fn go_to(&mut self, tick: Tick) {
        if !self.time.is_certain(tick) {
            self.leaps = self.leaps.saturating_add(1);
            self.mark_loss();
        }
        self.time = self.time.nearest(tick);
    }

    /// Starts a frame at this tick, best that of its first event. A frame that is not
    /// [finished](FrameWriter::finish) takes no number.
    ///
    /// # Errors
    /// Returns [`LinkError::Full`] if the buffer is shorter than [`MIN_FRAME`](super::MIN_FRAME).
    pub fn start<'f, 'a>(
        &'f mut self,
        tick: Tick,
        buffer: &'a mut [u8],
    ) -> Result<FrameWriter<'f, 'a>, LinkError> {
        let limit = buffer.len().checked_sub(CHECKSUM).ok_or(LinkError::Full)?;
        if self.flags & flag::FIRST != 0 {
            self.time = Time::from_micros(tick.micros().into());
        } else {
            self.go_to(tick);
        }
        let [n0, n1, n2, n3, n4, n5, _, _] = self.number.to_le_bytes();
        let [t0, t1, t2, t3, t4, t5, _, _] = self.time.micros().to_le_bytes();
        let coding = self.coding;
        let [p0, p1] = coding.period.get().to_le_bytes();
        let code = coding.byte();
        let header = [MAGIC, 0, n0, n1, n2, n3, n4, n5, t0, t1, t2, t3, t4, t5, p0, p1, code, 0];

        let mut bytes = Cursor::new(buffer);
        bytes.set_limit(limit.min(HEADER + MAX_LENGTH));
        bytes.put(&header).ok_or(LinkError::Full)?;
        let flags = self.flags;
        let must_tell = self.must_tell(tick);
        let bits = BitWriter::new(bytes);
        let mut frame = FrameWriter {
            framer: self,
            bits,
            flags,
            tick,
            run: None,
            keyframes: 0,
            events: 0,
            place: Place::new(coding, tick),
        };
        if must_tell {
            frame.tell();
        }
        Ok(frame)
    }
}

/// The bytes before the first keyframe or heartbeat: how many there are, and their sample type.
const RUN_HEADER: usize = 2;

/// A run of keyframes in this sample type, or of heartbeats, which have none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run(Option<SampleKind>);

/// A frame that is being written: keyframes or heartbeats, then events.
#[derive(Debug)]
pub struct FrameWriter<'f, 'a> {
    framer: &'f mut Framer,
    bits: BitWriter<'a>,
    flags: u8,
    tick: Tick,
    /// The kind of the frame's keyframes or heartbeats; `None` before the first.
    run: Option<Run>,
    keyframes: u8,
    events: u32,
    place: Place,
}

impl<'a> FrameWriter<'_, 'a> {
    /// Appends a keyframe, at the frame's tick.
    ///
    /// # Errors
    /// Returns an error if the frame is full, has another tick, or already has events or a keyframe of another sample
    /// type. It is unchanged.
    pub fn keyframe(&mut self, keyframe: Keyframe) -> Result<(), LinkError> {
        let Keyframe { tick, address, kind, bits } = keyframe;
        self.entry(tick, address, Some(kind), bits)
    }

    /// Appends a [heartbeat](crate::Item::Heartbeat), at the frame's tick.
    ///
    /// # Errors
    /// Returns an error if the frame is full, has another tick, or already has events or keyframes. It is unchanged.
    pub fn heartbeat(&mut self, tick: Tick, address: u16) -> Result<(), LinkError> {
        self.entry(tick, address, None, 0)
    }

    /// Appends the fingerprint if there is room.
    #[cold]
    #[inline(never)]
    fn tell(&mut self) {
        if self.bits.room() >= FINGERPRINT {
            self.bits.put_bytes(&self.framer.fingerprint.bits().to_le_bytes());
            self.flags |= flag::FINGERPRINT;
        }
    }

    /// Where the keyframes begin.
    const fn run_at(&self) -> usize {
        if self.flags & flag::FINGERPRINT != 0 { HEADER + FINGERPRINT } else { HEADER }
    }

    fn entry(
        &mut self,
        tick: Tick,
        address: u16,
        kind: Option<SampleKind>,
        bits: u32,
    ) -> Result<(), LinkError> {
        let entry = Run(kind);
        if self.events > 0 || tick != self.tick || self.run.is_some_and(|first| first != entry) {
            return Err(LinkError::KeyframeOrder);
        }
        let run = if self.run.is_none() { RUN_HEADER } else { 0 };
        if self.keyframes == u8::MAX || run + keyframe_size(kind) > self.bits.room() {
            return Err(LinkError::Full);
        }
        if self.run.is_none() {
            let is_due = self.flags & (flag::DESCRIBED | flag::FINGERPRINT) == flag::DESCRIBED
                && self.framer.untold >= TELL_EVERY - 1;
            if is_due && run + keyframe_size(kind) + FINGERPRINT <= self.bits.room() {
                self.tell();
            }
            self.run = Some(entry);
            self.flags |= flag::KEYFRAMES;
            self.bits.put_bytes(&[0, kind.map_or(HEARTBEATS, SampleKind::to_byte)]);
        }
        let [a0, a1] = address.to_le_bytes();
        let [b0, b1, b2, b3] = bits.to_le_bytes();
        let bytes = [a0, a1, b0, b1, b2, b3];
        self.bits.put_bytes(bytes.get(..keyframe_size(kind)).unwrap_or_default());
        self.keyframes = self.keyframes.saturating_add(1);
        Ok(())
    }

    /// Appends an event.
    ///
    /// # Errors
    /// Returns [`LinkError::Full`] if the event does not fit, or lies more than 2²⁹ µs (8.9 minutes) from the frame's
    /// tick. The frame is unchanged.
    pub fn event(&mut self, event: Event) -> Result<(), LinkError> {
        self.put(event).ok_or(LinkError::Full)
    }

    /// Appends an event; `None` if it does not fit.
    #[inline(never)]
    pub(super) fn put(&mut self, event: Event) -> Option<()> {
        let mut word = Word::default();
        self.place.put(event, self.tick, &mut word)?;
        if self.bits.put_word(word).is_none() {
            self.put_long(event)?;
        }
        self.place.pass(event);
        self.events = self.events.wrapping_add(1);
        Some(())
    }

    /// Appends an event that is too long for a word; `None` if it does not fit.
    #[cold]
    #[inline(never)]
    fn put_long(&mut self, event: Event) -> Option<()> {
        let mark = self.bits.mark();
        self.place.put(event, self.tick, &mut self.bits)?;
        if !self.bits.is_within_limit() {
            self.bits.back_to(mark);
            return None;
        }
        Some(())
    }

    /// How many events it has.
    pub fn events(&self) -> u32 {
        self.events
    }

    /// Whether it has neither keyframes nor events.
    pub fn is_empty(&self) -> bool {
        self.events == 0 && self.keyframes == 0
    }

    /// Closes the frame and returns its bytes, ready to send. The frame takes its number: if it is not sent, the reader
    /// sees a gap.
    pub fn finish(self) -> &'a [u8] {
        let run_at = self.run_at();
        let mut bytes = self.bits.finish();
        let length = bytes.written().saturating_sub(HEADER) as u8;
        bytes.replace(FLAGS_AT, VERSION << 4 | self.flags);
        bytes.replace(LENGTH_AT, length);
        if self.keyframes > 0 {
            bytes.replace(run_at, self.keyframes);
        }
        bytes.set_limit(usize::MAX);
        let checksum = checksum(bytes.as_slice());
        // There is room, which the limit kept free.
        let _ = bytes.put(&checksum.to_le_bytes());
        self.framer.number = session::next(self.framer.number);
        self.framer.time = self.framer.time.nearest(self.place.tick());
        self.framer.flags = self.flags & flag::DESCRIBED;
        if self.flags & flag::FINGERPRINT == 0 {
            self.framer.untold = self.framer.untold.saturating_add(1);
        } else {
            (self.framer.untold, self.framer.told_at) = (0, self.tick);
        }
        bytes.into_slice()
    }
}
