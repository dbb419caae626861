//! Framer and frame writer: write frames into the caller's buffer.

use core::num::NonZeroU32;

use super::bits::{BitWriter, PutBits, Word};
use super::crc::Register;
use super::delta::{Place, ShortTime, nearest_step};
use super::frame::{
    CHECKSUM, FINGERPRINT, FLAGS_AT, HEADER, HEARTBEATS, LENGTH_AT, MAGIC, MAX_LENGTH, MIN_FRAME,
    VERSION, flag, keyframe_size, short,
};
use super::known::{Known, Next, Point};
use super::steps::{MOST_BITS, Steps};
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
    /// The time from sample to sample, in µs, up to 16 777 215 (16.8 s); larger values count as that.
    pub period: NonZeroU32,
    /// About the binary logarithm of the distance between neighbouring addresses that fire. 0 to 15; larger values
    /// count as 15.
    pub address_bits: u8,
    /// About the binary logarithm of the jitter of ticks in µs, plus 1 for its sign. 0 to 15; larger values count as
    /// 15.
    pub jitter_bits: u8,
    /// How many low bits of its address's step number the first event of an address in a frame has, so that a step code
    /// heals after a loss of fewer than half as many steps as they tell apart. 0 to 4; larger values count as 4. Addresses
    /// from 16 on have none.
    pub step_bits: u8,
}

impl Coding {
    /// The longest period in µs (16.8 s), which takes 3 bytes of a frame.
    pub const LONGEST_PERIOD: u32 = (1 << 24) - 1;

    /// A coding for channels of one neuron each, sampled by a timer every `period` µs (0 counts as 1).
    pub const fn for_channels(channels: u16, period: u32) -> Self {
        let period = match NonZeroU32::new(period) {
            Some(period) => period,
            None => NonZeroU32::MIN,
        };
        // Best if few channels fire at a time; if many do, an event takes a bit or two more.
        let address_bits = (u16::BITS - (channels / 8).leading_zeros()) as u8;
        Self { period, address_bits, jitter_bits: 0, step_bits: 0 }
    }

    /// Sets the [bits for the jitter](Self::jitter_bits).
    #[must_use]
    pub const fn with_jitter_bits(self, jitter_bits: u8) -> Self {
        Self { jitter_bits, ..self }
    }

    /// Sets the [bits for step numbers](Self::step_bits).
    #[must_use]
    pub const fn with_step_bits(self, step_bits: u8) -> Self {
        Self { step_bits, ..self }
    }

    const fn within_limits(self) -> Self {
        const fn at_most(most: u8, bits: u8) -> u8 {
            if bits > most { most } else { bits }
        }
        let period = match NonZeroU32::new(Self::LONGEST_PERIOD) {
            Some(longest) if self.period.get() > Self::LONGEST_PERIOD => longest,
            _ => self.period,
        };
        Self {
            period,
            address_bits: at_most(15, self.address_bits),
            jitter_bits: at_most(15, self.jitter_bits),
            step_bits: at_most(MOST_BITS, self.step_bits),
        }
    }

    pub(super) const fn byte(self) -> u8 {
        self.jitter_bits << 4 | self.address_bits
    }

    pub(super) fn from_bytes(period: NonZeroU32, byte: u8, step_bits: u8) -> Option<Self> {
        let coding = Self { period, address_bits: byte & 0xF, jitter_bits: byte >> 4, step_bits };
        (step_bits <= MOST_BITS).then_some(coding)
    }

    /// How many low bits of a sample's number on the grid tell between one and two seconds, 16 at most.
    #[inline]
    pub(super) const fn grid_bits(self) -> u32 {
        // 21 less the bits of the period.
        let bits = self.period.leading_zeros().saturating_sub(u32::BITS - 21);
        if bits > 16 { 16 } else { bits }
    }

    #[inline]
    pub(super) const fn grid_mask(self) -> u32 {
        1_u32.wrapping_shl(self.grid_bits()).wrapping_sub(1)
    }

    /// The bits that a step number has on the wire.
    #[inline]
    pub(super) const fn step_mask(self) -> u8 {
        1_u8.wrapping_shl(self.step_bits as u32).wrapping_sub(1)
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
    fingerprint: Option<Fingerprint>,
    /// What a receiver of the last frame knows; without meaning before the first.
    known: Known,
    /// The tick of the last full frame.
    full_at: Tick,
    full_every: u32,
    /// How many further frames are full, as the first of a session may be lost.
    full_ahead: u8,
    steps: Steps,
}

/// A frame is full that comes this many µs (0.52 s) after the last full one, or later.
pub(super) const FULL_EVERY: u32 = 1 << 19;

/// So many frames are full at the beginning of a session.
const FULL_FIRST: u8 = 4;

impl Framer {
    /// A framer before the first frame of this session.
    pub const fn new(coding: Coding, session: Session) -> Self {
        let coding = coding.within_limits();
        Self {
            coding,
            number: session.first_number(),
            time: Time::from_micros(0),
            flags: flag::FIRST,
            leaps: 0,
            fingerprint: None,
            known: Known::nothing(coding),
            full_at: Tick::from_micros(0),
            full_every: FULL_EVERY,
            full_ahead: FULL_FIRST,
            steps: Steps::ZERO,
        }
    }

    /// Sends the fingerprint of the schemes: see
    /// [`Transmitter::with_fingerprint`](super::Transmitter::with_fingerprint).
    #[must_use]
    pub const fn with_fingerprint(self, fingerprint: Fingerprint) -> Self {
        Self { fingerprint: Some(fingerprint), ..self }
    }

    /// Sets how often frames are full: see [`Transmitter::with_full_every`](super::Transmitter::with_full_every).
    #[must_use]
    pub const fn with_full_every(self, micros: u32) -> Self {
        Self { full_every: micros, ..self }
    }

    /// Sets the [bits for step numbers](Coding::step_bits), before the first frame.
    #[must_use]
    pub const fn with_step_bits(self, step_bits: u8) -> Self {
        Self { coding: self.coding.with_step_bits(step_bits).within_limits(), ..self }
    }

    /// The fingerprint, if there is one.
    pub(super) const fn fingerprint(&self) -> Option<Fingerprint> {
        self.fingerprint
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
    /// Returns [`LinkError::Full`] if the buffer is shorter than [`MIN_FRAME`](super::MIN_FRAME), and a fingerprint if
    /// there is one.
    pub fn start<'f, 'a>(
        &'f mut self,
        tick: Tick,
        buffer: &'a mut [u8],
    ) -> Result<FrameWriter<'f, 'a>, LinkError> {
        if !self.has_room(buffer) {
            return Err(LinkError::Full);
        }
        let mut draft = Draft::new(self, tick, buffer);
        self.open(false, &mut draft);
        Ok(FrameWriter { framer: self, draft })
    }

    /// Whether any frame can begin in this buffer.
    #[inline]
    pub(super) fn has_room(&self, buffer: &[u8]) -> bool {
        let fingerprint = if self.fingerprint.is_some() { FINGERPRINT } else { 0 };
        buffer.len() >= MIN_FRAME + fingerprint
    }

    /// Begins a [new](Draft::new) frame, with keyframes or heartbeats first or without.
    #[inline(never)]
    pub(super) fn open(&mut self, has_keyframes: bool, draft: &mut Draft<'_>) {
        let tick = draft.tick;
        if self.flags & flag::FIRST != 0 {
            self.time = Time::from_micros(tick.micros().into());
            self.known.point = Point { time: self.time, count: 0 };
        }
        self.go_to(tick);
        // A silence is no longer than a leap, and a longer one begins a grid of its own.
        let since = i32::try_from(self.time.since(self.known.point.time)).unwrap_or(i32::MAX);
        let (steps, jitter) = nearest_step(since, self.coding.period);
        draft.next = self.known.later(steps);
        let every = if has_keyframes { self.full_every / 2 } else { self.full_every };
        let is_due = self.full_ahead > 0
            || self.flags & flag::LOST != 0
            || every == 0
            || i64::from(tick.since(self.full_at)) >= i64::from(every);
        if is_due || !self.known.can_tell(steps) {
            return self.open_full(jitter, draft);
        }
        let mut lead = Word::default();
        let time = ShortTime { count: draft.next.point.count, jitter };
        time.put(self.known.grid_bits, self.coding.jitter_bits, &mut lead);
        if !lead.is_whole() {
            return self.open_full(jitter, draft);
        }
        draft.bits.begin(short::HEADER, short::HEADER + MAX_LENGTH, Draft::KEPT_SHORT);
        if has_keyframes {
            draft.lead = Some(lead);
        } else {
            draft.bits.put_lead(lead);
        }
    }

    /// Makes a frame a full one.
    #[cold]
    #[inline(never)]
    fn open_full(&self, jitter: i32, draft: &mut Draft<'_>) {
        // A time far from its point begins the grid anew, as half of a long period may be.
        let is_near = self.time.since(draft.next.point.time) == i64::from(jitter);
        let jitter = i16::try_from(jitter).ok().filter(|_| is_near);
        if jitter.is_none() {
            draft.next.point.time = self.time;
        }
        let [n0, n1, n2, n3, n4, n5, _, _] = self.number.to_le_bytes();
        let [t0, t1, t2, t3, t4, t5, _, _] = self.time.micros().to_le_bytes();
        let [p0, p1, p2, _] = self.coding.period.get().to_le_bytes();
        let (code, step) = (self.coding.byte(), self.coding.step_bits);
        let [c0, c1, _, _] = draft.next.point.count.to_le_bytes();
        let [j0, j1] = jitter.unwrap_or(0).to_le_bytes();
        draft.is_short = false;
        draft.flags = self.flags;
        draft.bits.begin(0, HEADER + MAX_LENGTH, CHECKSUM);
        draft.bits.put_bytes(&[
            MAGIC, 0, n0, n1, n2, n3, n4, n5, t0, t1, t2, t3, t4, t5, p0, p1, p2, code, step, c0,
            c1, j0, j1, 0,
        ]);
        if let Some(fingerprint) = self.fingerprint {
            draft.flags |= flag::FINGERPRINT;
            draft.bits.put_bytes(&fingerprint.bits().to_le_bytes());
        }
    }
}

/// The bytes before the first keyframe or heartbeat: how many there are, and their sample type.
const RUN_HEADER: usize = 2;

/// The most bytes that the time of a short frame takes.
const LEAD: usize = 4;

/// A run of keyframes in this sample type, or of heartbeats, which have none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run(Option<SampleKind>);

/// A frame that is being written: keyframes or heartbeats, then events.
#[derive(Debug)]
pub struct FrameWriter<'f, 'a> {
    framer: &'f mut Framer,
    draft: Draft<'a>,
}

impl<'a> FrameWriter<'_, 'a> {
    /// Appends a keyframe, at the frame's tick.
    ///
    /// # Errors
    /// Returns an error if the frame is full, has another tick, or already has events or a keyframe of another sample
    /// type. It is unchanged.
    pub fn keyframe(&mut self, keyframe: Keyframe) -> Result<(), LinkError> {
        self.draft.keyframe(keyframe)
    }

    /// Appends a [heartbeat](crate::Item::Heartbeat), at the frame's tick.
    ///
    /// # Errors
    /// Returns an error if the frame is full, has another tick, or already has events or keyframes. It is unchanged.
    pub fn heartbeat(&mut self, tick: Tick, address: u16) -> Result<(), LinkError> {
        self.draft.heartbeat(tick, address)
    }

    /// Appends an event.
    ///
    /// # Errors
    /// Returns [`LinkError::Full`] if the event does not fit, or lies more than 2²⁹ µs (8.9 minutes) from the frame's
    /// tick. The frame is unchanged.
    pub fn event(&mut self, event: Event) -> Result<(), LinkError> {
        self.draft.put(event).ok_or(LinkError::Full)
    }

    /// How many events it has.
    pub fn events(&self) -> u32 {
        self.draft.events
    }

    /// Whether it has neither keyframes nor events.
    pub fn is_empty(&self) -> bool {
        self.draft.events == 0 && self.draft.keyframes == 0
    }

    /// Closes the frame and returns its bytes, ready to send. The frame takes its number: if it is not sent, the reader
    /// sees a gap.
    pub fn finish(mut self) -> &'a [u8] {
        self.framer.close(&mut self.draft)
    }
}

/// What is written of a frame. Its [`Framer`] begins and closes it.
#[derive(Debug)]
pub(super) struct Draft<'a> {
    bits: BitWriter<'a>,
    flags: u8,
    is_short: bool,
    /// The kind of the frame's keyframes or heartbeats; `None` before the first.
    run: Option<Run>,
    keyframes: u8,
    events: u32,
    tick: Tick,
    next: Next,
    /// The bits of a short frame's time, if keyframes come before them.
    lead: Option<Word>,
    place: Place,
    steps: Steps,
}

impl<'a> Draft<'a> {
    /// A frame of this framer at this tick, which [opens](Framer::open) it next. It is filled where it stays, as a copy
    /// would cost as much as an event.
    #[inline]
    pub(super) fn new(framer: &Framer, tick: Tick, buffer: &'a mut [u8]) -> Self {
        Self {
            bits: BitWriter::new(Cursor::new(buffer)),
            flags: 0,
            is_short: true,
            run: None,
            keyframes: 0,
            events: 0,
            tick,
            next: Next::NONE,
            lead: None,
            place: Place::new(framer.coding, tick),
            steps: framer.steps,
        }
    }

    /// The bytes that are kept free behind a short frame: the checksum, and one for its length, which moves the others.
    const KEPT_SHORT: usize = CHECKSUM + 1;

    /// Where the keyframes begin.
    const fn run_at(&self) -> usize {
        if self.is_short {
            short::HEADER
        } else if self.flags & flag::FINGERPRINT != 0 {
            HEADER + FINGERPRINT
        } else {
            HEADER
        }
    }

    /// Appends a keyframe.
    pub(super) fn keyframe(&mut self, keyframe: Keyframe) -> Result<(), LinkError> {
        let Keyframe { tick, address, kind, bits } = keyframe;
        self.entry(tick, address, Some(kind), bits)
    }

    /// Appends a heartbeat.
    pub(super) fn heartbeat(&mut self, tick: Tick, address: u16) -> Result<(), LinkError> {
        self.entry(tick, address, None, 0)
    }

    #[inline(never)]
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
        let coding = self.place.coding();
        let run = if self.run.is_none() { RUN_HEADER } else { 0 };
        let lead = if self.is_short { LEAD } else { 0 };
        let size = keyframe_size(kind, coding);
        if self.keyframes == u8::MAX || run + size + lead > self.bits.room() {
            return Err(LinkError::Full);
        }
        if self.run.is_none() {
            if self.is_short && self.lead.is_none() {
                // The time was written, as no keyframes were to be expected.
                self.lead = Some(self.bits.take_lead());
            }
            self.run = Some(entry);
            self.flags |= flag::KEYFRAMES;
            self.bits.put_bytes(&[0, kind.map_or(HEARTBEATS, SampleKind::to_byte)]);
        }
        let [a0, a1] = address.to_le_bytes();
        let [b0, b1, b2, b3] = bits.to_le_bytes();
        let step = self.steps.number(address, coding.step_mask());
        let is_wide = kind.is_some_and(|kind| kind.size() > 2);
        let entry =
            if is_wide { [a0, a1, b0, b1, b2, b3, step] } else { [a0, a1, b0, b1, step, 0, 0] };
        self.bits.put_bytes(entry.get(..size).unwrap_or_default());
        self.keyframes = self.keyframes.saturating_add(1);
        Ok(())
    }

    /// Appends an event; `None` if it does not fit.
    #[inline(never)]
    pub(super) fn put(&mut self, event: Event) -> Option<()> {
        self.put_lead();
        let mut word = Word::default();
        self.place.put(event, self.tick, &mut word)?;
        let steps = if self.place.has_numbers() { self.steps.after(event) } else { self.steps };
        if let Some(number) = self.number(event, steps) {
            word.put(number.into(), self.place.coding().step_bits.into());
        }
        if self.bits.put_word(word).is_none() {
            self.put_long(event, steps)?;
        }
        self.place.pass(event);
        self.steps = steps;
        self.events = self.events.wrapping_add(1);
        Some(())
    }

    /// The low bits of its address's step number that go with an event, after which these are the step numbers.
    #[inline]
    fn number(&self, event: Event, steps: Steps) -> Option<u8> {
        let has_number = self.place.has_number(event.address);
        has_number.then(|| steps.number(event.address, self.place.coding().step_mask()))
    }

    /// Appends an event that is too long for a word; `None` if it does not fit.
    #[cold]
    #[inline(never)]
    fn put_long(&mut self, event: Event, steps: Steps) -> Option<()> {
        let mark = self.bits.mark();
        self.place.put(event, self.tick, &mut self.bits)?;
        if let Some(number) = self.number(event, steps) {
            self.bits.put(number.into(), self.place.coding().step_bits.into());
        }
        if !self.bits.is_within_limit() {
            self.bits.back_to(mark);
            return None;
        }
        Some(())
    }

    /// Appends the time of a short frame that begins with keyframes. There is room for it.
    #[inline]
    fn put_lead(&mut self) {
        if let Some(lead) = self.lead.take() {
            self.bits.put_lead(lead);
        }
    }
}

impl Framer {
    /// Writes what is known at the end alone, and returns the bytes. The frame takes its number.
    #[inline(never)]
    pub(super) fn close<'a>(&mut self, draft: &mut Draft<'a>) -> &'a [u8] {
        draft.put_lead();
        let run_at = draft.run_at();
        let Draft { bits, keyframes, next, .. } = draft;
        let bytes = bits.finish();
        if *keyframes > 0 {
            bytes.replace(run_at, *keyframes);
        }
        let register = if draft.is_short {
            close_short(self.number, *keyframes > 0, bytes);
            self.known.go_to(self.number, *next)
        } else {
            bytes.replace(FLAGS_AT, VERSION << 4 | draft.flags);
            bytes.replace(LENGTH_AT, bytes.written().saturating_sub(HEADER) as u8);
            self.full_at = draft.tick;
            self.full_ahead = self.full_ahead.saturating_sub(1);
            self.known = Known::new(self.coding, self.fingerprint, self.number, next.point);
            Register::START
        };
        let checksum = register.after(bytes.as_slice()).checksum();
        bytes.put_some(checksum.to_le_bytes(), CHECKSUM);
        self.number = session::next(self.number);
        self.time = self.time.nearest(draft.place.tick());
        self.flags = 0;
        self.steps = draft.steps;
        bytes.take()
    }
}

/// Writes what comes before the payload of a short frame.
#[inline]
fn close_short(number: u64, has_keyframes: bool, bytes: &mut Cursor<'_>) {
    let length = bytes.written().wrapping_sub(short::HEADER) as u8;
    let first = if has_keyframes { short::MAGIC | short::KEYFRAMES } else { short::MAGIC };
    bytes.replace(1, number as u8);
    if length > short::LENGTH {
        bytes.replace(0, first | short::LENGTH);
        bytes.insert(1, length);
    } else {
        bytes.replace(0, first | length.wrapping_sub(1) & short::LENGTH);
    }
}
