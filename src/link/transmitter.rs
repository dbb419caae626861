//! Events and keyframes to frames, in the order in which they hold.

use super::{Coding, FrameWriter, Framer, LinkError, Raw, Snapshot};
use crate::sink::Batch;
use crate::{Event, EventSource, tick};

/// Draws events from a source and turns them into frames for `N` channels of a step code, numbered
/// from address 0.
///
/// - **Keyframes** are put after the events that the queue held when the snapshot was taken, and before
///   all others. Where the source numbers no events, their ticks decide, which must not fall.
/// - **Losses** of the source are told to the receiver, in the first frame after them, and a keyframe
///   that may lie before a loss is dropped, as it would claim too much. So is one that comes after
///   later events were sent already, as it would take the decoder back.
/// - **Memory:** `8 N + 64` bytes in `f32`.
#[derive(Clone, Copy, Debug)]
pub struct Transmitter<S, const N: usize> {
    framer: Framer,
    held: Option<Event>,
    pending: Option<Pending<S, N>>,
    lost: u32,
    owes_loss: bool,
    sent: Sent,
    dropped_keyframes: u32,
}

/// Up to where all is sent.
#[derive(Clone, Copy, Debug)]
struct Sent {
    tick: Option<u32>,
    /// The number of the first event that is not, if the source numbers them.
    place: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Pending<S, const N: usize> {
    snapshot: Snapshot<S, N>,
    /// The channel whose keyframe is written next.
    next: usize,
}

impl<S: Raw, const N: usize> Transmitter<S, N> {
    /// A sender that has sent nothing.
    pub const fn new(coding: Coding) -> Self {
        const { assert!(N >= 1 && N <= 1 << 16, "addresses have 16 bits") };
        Self {
            framer: Framer::new(coding),
            held: None,
            pending: None,
            lost: 0,
            owes_loss: false,
            sent: Sent { tick: None, place: None },
            dropped_keyframes: 0,
        }
    }

    /// Sends what the encoders held, at the next chance; nothing where none has a value yet.
    pub fn keyframe(&mut self, snapshot: Snapshot<S, N>) {
        if snapshot.values.iter().all(Option::is_none) {
            return;
        }
        let is_late = snapshot.mark.lost < self.lost
            || match (snapshot.mark.place, self.sent.place) {
                (Some(place), Some(sent)) => tick::is_before(place, sent),
                _ => self.sent.tick.is_some_and(|sent| tick::is_before(snapshot.tick, sent)),
            };
        if is_late || self.pending.is_some() {
            self.dropped_keyframes = self.dropped_keyframes.saturating_add(1);
        }
        if is_late {
            return;
        }
        self.pending = Some(Pending { snapshot, next: 0 });
    }

    /// Writes the next frame, with as many events as fit and are there; `None` if there is nothing to
    /// send. Call it until then.
    ///
    /// # Errors
    /// [`LinkError::Full`]: the buffer has no room for a single event or keyframe. Nothing is lost;
    /// 64 bytes are always enough.
    pub fn next_frame<'a>(
        &mut self,
        mut events: impl EventSource,
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, LinkError> {
        self.write_frame(&mut events, buffer)
    }

    fn write_frame<'a>(
        &mut self,
        events: &mut impl EventSource,
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, LinkError> {
        self.held = self.held.take().or_else(|| events.next_event());
        self.note_loss(events.lost());

        let due = match (&self.pending, &self.held) {
            (Some(pending), Some(event)) => pending.is_before(*event, events),
            (pending, _) => pending.is_some(),
        };
        let keyframes = if due { self.pending.as_mut() } else { None };
        let start = match (&keyframes, &self.held) {
            (Some(pending), _) => pending.snapshot.tick,
            (None, Some(event)) => event.tick,
            (None, None) if self.owes_loss => 0,
            (None, None) => return Ok(None),
        };

        let mut frame = self.framer.start(start, buffer)?;
        if let Some(pending) = keyframes {
            self.sent.tick = Some(pending.snapshot.tick);
            if !pending.write(&mut frame)? {
                self.owes_loss = false;
                return Ok(Some(frame.finish()));
            }
            self.pending = None;
        }
        let mut next = self.held.take();
        while let Some(event) = next {
            if frame.event(event).is_err() {
                self.held = Some(event);
                break;
            }
            self.sent.tick = Some(event.tick);
            next = events.next_event();
            if let Some(event) = next
                && (events.lost() != self.lost
                    || self
                        .pending
                        .as_ref()
                        .is_some_and(|pending| pending.is_before(event, events)))
            {
                self.held = next;
                break;
            }
        }
        let held = u32::from(self.held.is_some());
        self.sent.place = events.place().map(|place| place.wrapping_sub(held));
        if frame.is_empty() && !self.owes_loss {
            return Err(LinkError::Full);
        }
        self.owes_loss = false;
        Ok(Some(frame.finish()))
    }

    /// Tells the receiver that the encoders changed without events, as by a
    /// [`Bank::reset`](crate::Bank::reset): what it has is not exact until the next keyframe.
    pub fn mark_break(&mut self) {
        self.framer.mark_loss();
        self.owes_loss = true;
    }

    /// How many keyframes were not sent: another came before its turn, a loss did, or it came late.
    pub const fn dropped_keyframes(&self) -> u32 {
        self.dropped_keyframes
    }

    fn note_loss(&mut self, lost: u32) {
        if lost == self.lost {
            return;
        }
        self.lost = lost;
        self.mark_break();
        if self.pending.take_if(|pending| pending.snapshot.mark.lost != lost).is_some() {
            self.dropped_keyframes = self.dropped_keyframes.saturating_add(1);
        }
    }
}

impl<S: Raw, const N: usize> Pending<S, N> {
    /// Whether an event just drawn from a source comes after the keyframes.
    fn is_before(&self, event: Event, events: &impl EventSource) -> bool {
        let Snapshot { tick, mark, .. } = self.snapshot;
        match (mark.place, events.place()) {
            (Some(place), Some(next)) => tick::is_before(place, next),
            _ => tick::is_before(tick, event.tick),
        }
    }

    /// Writes keyframes as far as they fit, and says whether that was all.
    fn write(&mut self, frame: &mut FrameWriter<'_, '_>) -> Result<bool, LinkError> {
        while let Some(value) = self.snapshot.values.get(self.next) {
            if let Some(value) = *value {
                match frame.keyframe(self.next as u16, value) {
                    Err(_) if !frame.is_empty() => return Ok(false),
                    result => result?,
                }
            }
            self.next += 1;
        }
        Ok(true)
    }
}

/// One frame a batch, for a sink. A buffer too short for any frame sends nothing.
impl<S: Raw, const N: usize> Batch for Transmitter<S, N> {
    const SHORTEST: usize = 64;

    fn fill(&mut self, events: &mut impl EventSource, bytes: &mut [u8]) -> usize {
        match self.write_frame(events, bytes) {
            Ok(Some(frame)) => frame.len(),
            _ => 0,
        }
    }
}
