//! Transmitter: turns items into frames, in their order.

use super::{Coding, FrameWriter, Framer, LinkError, Session};
use crate::Fingerprint;
use crate::event::{Bank, Item, Schemes, Source, Taken, Tick};
use crate::wire::Batch;

/// Takes items from a source and turns them into frames, in their order.
///
/// - **Keyframes and heartbeats** come first in a frame: a keyframe or heartbeat after an event starts the next frame.
/// - **Losses and breaks** also start a frame, with the flag *lost*: a temporal decoder is then wrong until its next
///   keyframe.
/// - **Time:** a tick wraps after 71.6 minutes, so that a longer silence cannot be told from a short one. If there may
///   be no item for 17.9 minutes, as with a rate code at rest without heartbeats, call [`observe`](Self::observe).
/// - **Fingerprint:** that of the bank goes into the first frame, into frames with keyframes, at most every fourth, and
///   into any frame 0.52 s or more after the last one that had it: a byte a frame on average at most, or 8 bytes a second
///   where there are fewer than 8 frames a second. A [`Receiver`](super::Receiver) with other schemes then calls no value
///   exact.
/// - **Memory:** 56 bytes on a 32-bit part.
///
/// ```
/// use spikewire::{Bank, Event, FromEvents, Polarity, Tick, temporal::StepForward};
/// use spikewire::link::{FrameView, MAX_FRAME, Session, Transmitter};
///
/// static GYRO: StepForward<i16> = StepForward::new(120);
/// let bank = Bank::<_, 6>::new(&GYRO);
/// let starts = 7; // as counted in flash
/// let mut link = Transmitter::for_bank(&bank, 1_000, Session::counted(starts)); // a sample every 1000 µs
///
/// let event = Event { tick: Tick::from_micros(5_000), address: 3, polarity: Polarity::Up };
/// let mut source = FromEvents([event].into_iter());
/// let mut buffer = [0; MAX_FRAME];
/// while let Some(bytes) = link.next_frame(&mut source, &mut buffer)? {
///     let (frame, _) = FrameView::new(bytes)?;
///     assert!(frame.events().eq([event]));
/// }
/// # Ok::<(), spikewire::link::LinkError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Transmitter {
    framer: Framer,
    /// An item that was taken from the source and is in no frame yet.
    held: Option<Taken>,
    /// For how many µs an event may wait for others.
    gathering: u32,
    /// The last time that it was told.
    now: Tick,
}

impl Transmitter {
    /// A transmitter for the items of this bank, sampled every `period` µs (0 counts as 1), before the first frame of
    /// this session. It sends the bank's [fingerprint](Bank::fingerprint).
    pub fn for_bank<T: Schemes<N>, const N: usize>(
        bank: &Bank<T, N>,
        period: u32,
        session: Session,
    ) -> Self {
        let coding = Coding::for_channels(bank.addresses(), period);
        Self::new(coding, session).with_fingerprint(bank.fingerprint())
    }

    /// A transmitter before the first frame of this session, without a fingerprint: a receiver cannot tell whether it has
    /// the sender's schemes, except by keyframes that contradict it.
    pub const fn new(coding: Coding, session: Session) -> Self {
        let now = Tick::from_micros(0);
        Self { framer: Framer::new(coding, session), held: None, gathering: 0, now }
    }

    /// Sends this fingerprint: that of the bank, or of several banks on one link, each [and](Fingerprint::and) the next.
    #[must_use]
    pub const fn with_fingerprint(self, fingerprint: Fingerprint) -> Self {
        Self { framer: self.framer.with_fingerprint(fingerprint), ..self }
    }

    /// Sets after how many µs a frame is full again, 2¹⁹ (0.52 s) by default: so long a receiver that joins, or that
    /// missed more than short frames can tell, has to wait. Where a frame begins with keyframes it is full after half of
    /// that. With 0 every frame is full.
    #[must_use]
    pub const fn with_full_every(self, micros: u32) -> Self {
        Self { framer: self.framer.with_full_every(micros), ..self }
    }

    /// Sends with the first event of an address in a frame the low bits of its step number: see
    /// [`Coding::step_bits`]. It is set before the first frame.
    #[must_use]
    pub const fn with_step_bits(self, step_bits: u8) -> Self {
        Self { framer: self.framer.with_step_bits(step_bits), ..self }
    }

    /// Lets events wait for others up to so many µs, so that one frame has what several would have: each frame less saves
    /// 8 bytes or so, and values at the far end are up to so much later. By default events go at once.
    ///
    /// [`next_frame`](Self::next_frame) returns `None` while they wait, and they stay in their queue, which must have room
    /// for them. How long they have waited is known by [`observe`](Self::observe) alone, which must be called at each
    /// turn. A keyframe or a break does not wait, but for the events before it.
    #[must_use]
    pub const fn with_gathering(self, micros: u32) -> Self {
        Self { gathering: micros, ..self }
    }

    /// Whether this item, the next one, waits for others.
    #[inline]
    fn gathers(&self, first: Taken) -> bool {
        let Item::Event(event) = first.item else { return false };
        let waited = i64::from(self.now.since(event.tick));
        self.gathering > 0 && first.lost == 0 && waited < i64::from(self.gathering)
    }

    /// Adds what both ends must have in common beside the schemes, such as names and units of the channels, to the
    /// [fingerprint](Fingerprint::labelled). Without a fingerprint it does nothing.
    #[must_use]
    pub const fn with_label(self, label: &str) -> Self {
        match self.framer.fingerprint() {
            Some(fingerprint) => self.with_fingerprint(fingerprint.labelled(label)),
            None => self,
        }
    }

    /// Tells the transmitter the time while there are no items. An item or this call must come at least every 2³⁰ µs
    /// (17.9 minutes): call it at each turn of the main loop, for example. A [heartbeat](Item::Heartbeat) a second
    /// does as well.
    pub fn observe(&mut self, now: Tick) {
        self.now = now;
        self.framer.observe(now);
    }

    /// How often a tick lay more than 2³⁰ µs from the one before, so that the time between them is not known: the next
    /// frame then has the flag *lost*. A silence of about 2³² µs, or of a multiple, is not noticed.
    pub const fn leaps(&self) -> u32 {
        self.framer.leaps()
    }

    /// Writes the next frame, with as many items as there are and fit; `None` if there is none. Call it until it
    /// returns `None`.
    ///
    /// # Errors
    /// Returns [`LinkError::Full`] if the buffer has no room for a single item. No item is lost; 64 bytes are always
    /// enough.
    pub fn next_frame<'a>(
        &mut self,
        mut items: impl Source,
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, LinkError> {
        self.write_frame(&mut items, buffer)
    }

    fn write_frame<'a>(
        &mut self,
        items: &mut impl Source,
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, LinkError> {
        let Some(first) = self.held.take().or_else(|| items.take()) else { return Ok(None) };
        self.held = Some(first);
        if self.gathers(first) {
            return Ok(None);
        }
        if first.is_after_break() {
            self.framer.mark_loss();
        }
        let has_keyframes = matches!(first.item, Item::Keyframe(_) | Item::Heartbeat { .. });
        let mut frame = self.framer.begin(first.item.tick(), has_keyframes, buffer)?;
        append(&mut frame, first.item)?;
        self.held = loop {
            match items.take() {
                Some(next) if !next.is_after_break() && append(&mut frame, next.item).is_ok() => {}
                held => break held,
            }
        };
        Ok(Some(frame.finish()))
    }
}

/// Appends an item. A break needs no bytes, as the frame's flag stands for it.
#[inline]
fn append(frame: &mut FrameWriter<'_, '_>, item: Item) -> Result<(), LinkError> {
    match item {
        Item::Event(event) => frame.put(event).ok_or(LinkError::Full),
        Item::Keyframe(keyframe) => frame.keyframe(keyframe),
        Item::Heartbeat { tick, address } => frame.heartbeat(tick, address),
        Item::Break(_) => Ok(()),
    }
}

/// One frame a batch, for a sink. A buffer too short for any frame sends nothing.
impl Batch for Transmitter {
    const SHORTEST: usize = 64;

    fn fill(&mut self, items: &mut impl Source, bytes: &mut [u8]) -> usize {
        match self.write_frame(items, bytes) {
            Ok(Some(frame)) => frame.len(),
            _ => 0,
        }
    }
}
