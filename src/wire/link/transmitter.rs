//! Transmitter: turns items into frames, in their order.

use core::ops::RangeInclusive;

use super::writer::{self, Draft};
use super::{Coding, Framer, LinkError, Part, Session, join};
use crate::error::unwrap;
use crate::event::{Bank, Item, Schemes, Source, Taken, Tick};
use crate::wire::Batch;
use crate::{ConfigError, Fingerprint};

/// Takes items from a source and turns them into frames, in their order.
///
/// - **Keyframes and heartbeats** come first in a frame: a keyframe or heartbeat after an event starts the next frame.
/// - **Losses and breaks** also start a frame, with the flag *lost*: a temporal decoder is then wrong until its next
///   keyframe.
/// - **Time:** a tick wraps after 71.6 minutes, so that a longer silence cannot be told from a short one. If there may
///   be no item for 17.9 minutes, as with a rate code at rest without heartbeats, call [`observe`](Self::observe).
/// - **Fingerprint:** that of the bank goes into every full frame, one each half second: see
///   [`with_full_every`](Self::with_full_every). A [`Receiver`](super::Receiver) with other schemes then calls no value
///   exact.
/// - **Addresses:** items of addresses that are not its banks' are refused, and counted as [foreign](Self::foreign). Banks
///   that share a link are joined by [`for_banks`](Self::for_banks).
/// - **Memory:** about 160 bytes on a 32-bit part.
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
    gathering: Gathering,
    /// The first address of its banks, and how far the last one lies from it.
    first_address: u16,
    span: u16,
    foreign: u32,
}

impl Transmitter {
    /// Usual time in µs (0.52 s) from one full frame to the next, if [`with_full_every`](Self::with_full_every) sets no other.
    pub const FULL_EVERY: u32 = writer::FULL_EVERY;

    /// A transmitter for the items of this bank, sampled every `period` µs (0 counts as 1), before the first frame of
    /// this session. It sends the bank's [fingerprint](Bank::fingerprint). If another bank shares the link, use
    /// [`for_banks`](Self::for_banks).
    ///
    /// # Panics
    /// Panics if the bank's sub-timesteps do not fit into the period, or a filter is one for another rate.
    #[track_caller]
    pub fn for_bank<T: Schemes<N>, const N: usize>(
        bank: &Bank<T, N>,
        period: u32,
        session: Session,
    ) -> Self {
        unwrap(Self::try_for_bank(bank, period, session))
    }

    /// A transmitter as [`for_bank`](Self::for_bank) makes it.
    ///
    /// # Errors
    /// Returns an error if the bank's sub-timesteps do not fit into the period, or a filter is one for another rate.
    pub fn try_for_bank<T: Schemes<N>, const N: usize>(
        bank: &Bank<T, N>,
        period: u32,
        session: Session,
    ) -> Result<Self, ConfigError> {
        bank.check_period(period)?;
        let (first, count) = (bank.first_address(), bank.addresses().max(1));
        let last = first.saturating_add(count.saturating_sub(1) as u16);
        let coding = Coding::for_channels(u16::try_from(count).unwrap_or(u16::MAX), period);
        let transmitter = Self::new(coding, session).with_addresses(first..=last);
        Ok(transmitter.with_fingerprint(bank.fingerprint()))
    }

    /// A transmitter for the items of these banks, all sampled every `period` µs (0 counts as 1), before the first frame of
    /// this session. It [joins](join) them: each gets the addresses after those of the bank before, whatever its
    /// first address was. Call it before they encode.
    ///
    /// # Errors
    /// Returns an error if there is no bank, if they take more than 65 536 addresses, if a bank's sub-timesteps do not fit
    /// into the period, or if a filter is one for another rate.
    pub fn for_banks(
        banks: &mut [&mut dyn Part],
        period: u32,
        session: Session,
    ) -> Result<Self, ConfigError> {
        for bank in &*banks {
            bank.check_period(period)?;
        }
        let joint = join(banks)?;
        let last = joint.addresses().saturating_sub(1) as u16;
        let channels = u16::try_from(joint.addresses()).unwrap_or(u16::MAX);
        let transmitter = Self::new(Coding::for_channels(channels, period), session);
        Ok(transmitter.with_addresses(0..=last).with_fingerprint(joint.fingerprint()))
    }

    /// A transmitter before the first frame of this session, for any address and without a fingerprint: a receiver cannot
    /// tell whether it has the sender's schemes, except by keyframes that contradict it.
    pub const fn new(coding: Coding, session: Session) -> Self {
        let framer = Framer::new(coding, session);
        let gathering = Gathering { micros: 0, now: Tick::from_micros(0) };
        Self { framer, held: None, gathering, first_address: 0, span: u16::MAX, foreign: 0 }
    }

    /// Sets the addresses of its banks: items of others are refused, and counted as [foreign](Self::foreign).
    #[must_use]
    pub const fn with_addresses(self, addresses: RangeInclusive<u16>) -> Self {
        let first_address = *addresses.start();
        let span = addresses.end().saturating_sub(first_address);
        Self { first_address, span, ..self }
    }

    /// Sends this fingerprint: that of the bank, of several [joined](join) banks, or of a whole flight.
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
    /// turn, and `next_frame` after it: an event that is taken 2³⁰ µs after its tick gets the time of another. A keyframe
    /// or a break does not wait, but for the events before it.
    #[must_use]
    pub const fn with_gathering(self, micros: u32) -> Self {
        Self { gathering: Gathering { micros, ..self.gathering }, ..self }
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
        self.gathering.now = now;
        self.framer.observe(now);
    }

    /// How often a tick lay more than 2³⁰ µs from the one before, so that the time between them is not known: the next
    /// frame then has the flag *lost*. A silence of about 2³² µs, or of a multiple, is not noticed.
    pub const fn leaps(&self) -> u32 {
        self.framer.leaps()
    }

    /// How many items had an address that is not its banks': another bank puts into the same queue that is not
    /// [joined](Self::for_banks). They were refused. Two banks with the same addresses cannot be told apart here; a receiver
    /// notices by their keyframes.
    pub const fn foreign(&self) -> u32 {
        self.foreign
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

    #[inline]
    fn write_frame<'a>(
        &mut self,
        items: &mut impl Source,
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, LinkError> {
        let first = match self.held.take() {
            Some(held) => held,
            None => match self.take(items) {
                Some(first) => first,
                None => return Ok(None),
            },
        };
        if self.gathering.delays(first) {
            self.held = Some(first);
            return Ok(None);
        }
        self.write_items(first, items, buffer)
    }

    /// Writes a frame that begins with this item.
    fn write_items<'a>(
        &mut self,
        first: Taken,
        items: &mut impl Source,
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, LinkError> {
        if first.is_after_break() {
            self.framer.mark_loss();
        }
        if !self.framer.has_room(buffer) {
            self.held = Some(first);
            return Err(LinkError::Full);
        }
        let has_keyframes = matches!(first.item, Item::Keyframe(_) | Item::Heartbeat { .. });
        let mut draft = Draft::new(&self.framer, first.item.tick(), buffer);
        self.framer.open(has_keyframes, &mut draft);
        if let Err(error) = append(&mut draft, first.item) {
            self.held = Some(first);
            return Err(error);
        }
        while let Some(taken) = self.take(items) {
            if taken.is_after_break() || append(&mut draft, taken.item).is_err() {
                self.held = Some(taken);
                break;
            }
        }
        Ok(Some(self.framer.close(&mut draft)))
    }

    /// Takes the next item of its banks; a break for one of others before which items were lost, as those may be its banks'.
    #[allow(clippy::inline_always)] // the item would go through memory
    #[inline(always)]
    fn take(&mut self, items: &mut impl Source) -> Option<Taken> {
        loop {
            let taken = items.take()?;
            let address = match taken.item {
                Item::Event(event) => event.address,
                Item::Keyframe(keyframe) => keyframe.address,
                Item::Heartbeat { address, .. } => address,
                Item::Break(_) => return Some(taken),
            };
            if address.wrapping_sub(self.first_address) <= self.span {
                return Some(taken);
            }
            self.foreign = self.foreign.saturating_add(1);
            if taken.lost > 0 {
                return Some(Taken { item: Item::Break(taken.item.tick()), ..taken });
            }
        }
    }
}

/// For how many µs an event may wait for others, and the last time that is known.
#[derive(Clone, Copy, Debug)]
struct Gathering {
    micros: u32,
    now: Tick,
}

impl Gathering {
    /// Whether this item, the next one, waits for others. Not if it is far ahead of the time that is known, as after a clock
    /// that stepped back, or where nobody tells the time.
    #[inline]
    fn delays(self, first: Taken) -> bool {
        let Item::Event(event) = first.item else { return false };
        let waited = self.now.since(event.tick).unsigned_abs();
        first.lost == 0 && waited < self.micros
    }
}

/// Appends an item. A break needs no bytes, as the frame's flag stands for it.
#[inline]
fn append(frame: &mut Draft<'_>, item: Item) -> Result<(), LinkError> {
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
