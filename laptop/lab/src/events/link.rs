//! Reads and writes frames of `spikewire`'s link: packets of events from a sender.

use super::{EventReader, EventWriter, EventsKind, Item, LinkTally, Tally};
use crate::Result;
use spikewire::link::{Coding, Framer, LinkError, MAX_FRAME, Reader, Received, Session, Withheld};
use spikewire::{Event, Keyframe, Tick};
use std::io::Write;

/// A decoder of link frames. It computes the values that the sender encoded.
pub trait Values {
    /// Decodes a frame, and appends the decoded values to `items`. A temporal code gives a value for each keyframe and
    /// each event. Any other code gives a value for each sample, once the time of the sample is over.
    fn apply(&mut self, received: &Received<'_>, items: &mut Vec<Item>);

    /// Appends the values of the last sample to `items`. Must be called after the last frame.
    fn finish(&mut self, items: &mut Vec<Item>);

    /// Sets the counts in `tally` that come from decoding, such as the number of keyframes of a wrong sample type.
    fn count(&self, tally: &mut LinkTally);

    /// Returns the reason that a channel's value is not exact, or `None` if the value is exact.
    fn withheld(&self, channel: u16) -> Option<Withheld>;
}

/// Reads link frames as events, or as decoded values.
pub struct LinkReader<'a> {
    reader: Reader<MAX_FRAME>,
    values: Option<Box<dyn Values + 'a>>,
    tally: LinkTally,
}

impl<'a> LinkReader<'a> {
    /// Makes a reader that decodes with `values`, or that reads events if `values` is `None`.
    pub fn new(values: Option<Box<dyn Values + 'a>>) -> Self {
        Self { reader: Reader::new(), values, tally: LinkTally::default() }
    }
}

impl EventReader for LinkReader<'_> {
    fn read(&mut self, mut bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        loop {
            let is_first = self.reader.frames() == 0;
            let Some(received) = self.reader.next_frame(&mut bytes) else { return Ok(()) };
            take(&received, is_first, &mut self.tally, self.values.as_deref_mut(), items);
        }
    }

    /// Reads the frames that wait behind one whose damaged length announces more bytes than there are.
    fn finish(&mut self, items: &mut Vec<Item>) -> Result<()> {
        loop {
            let is_first = self.reader.frames() == 0;
            let Some(received) = self.reader.next_after_silence() else { break };
            take(&received, is_first, &mut self.tally, self.values.as_deref_mut(), items);
        }
        if let Some(values) = &mut self.values {
            values.finish(items);
        }
        Ok(())
    }

    fn tally(&self) -> Tally {
        let reader = &self.reader;
        let mut link = LinkTally {
            frames: reader.frames().into(),
            lost: reader.lost_frames().into(),
            bad_checksums: reader.bad_checksums().into(),
            repeated: reader.repeated().into(),
            late: reader.late().into(),
            ..self.tally
        };
        if let Some(values) = &self.values {
            values.count(&mut link);
        }
        Tally { skipped: reader.skipped().into(), link: Some(link), ..Tally::default() }
    }
}

/// Appends the items of a frame, in the order in which they happened.
fn take(
    received: &Received<'_>,
    is_first: bool,
    tally: &mut LinkTally,
    values: Option<&mut (dyn Values + '_)>,
    items: &mut Vec<Item>,
) {
    let Received { gap, is_start, is_unread, frame } = received;
    if *is_unread {
        if let Some(values) = values {
            values.apply(received, items);
        }
        return;
    }
    if let Some(gap) = gap {
        tally.gaps += 1;
        items.push(Item::LostFrames(gap.lost_frames));
    }
    if frame.is_after_loss() {
        tally.after_loss += 1;
        items.push(Item::LostEvents);
    }
    // If the first frame received is from the middle of a session, the sender did not start there.
    if *is_start && (!is_first || frame.is_first()) {
        tally.restarts += 1;
        items.push(Item::Restart);
    }
    tally.keyframes += frame.keyframes().count() as u64;
    let mut events = frame.events();
    if let Some(values) = values {
        values.apply(received, items);
        events.by_ref().for_each(drop);
    } else {
        items.extend(frame.keyframes().map(Item::Keyframe));
        let tick = frame.tick();
        items.extend(frame.heartbeats().map(|address| Item::Heartbeat(tick, address)));
        items.extend(events.by_ref().map(Item::Event));
    }
    tally.impossible += u64::from(!events.is_complete());
}

/// A writer of link frames. It puts as many keyframes and events as fit into each frame.
pub(super) struct Writer {
    framer: Framer,
    coding: Coding,
    /// Keyframes that wait to be written, all of the same tick and sample type.
    keyframes: Vec<Keyframe>,
    /// Tick of the latest keyframe. An empty frame that reports a loss or a restart carries this tick.
    tick: Tick,
    /// Number of the current session, from 0. A restart of the sender begins a new session if the current one has
    /// frames.
    starts: u32,
    /// Whether the next frame is the first one after the latest start of the sender.
    is_fresh: bool,
    events: Vec<Event>,
    /// Whether the next frame is the first one after a loss or restart, and thus reports the loss or restart.
    owes_mark: bool,
}

/// Maximum number of events that wait to be written.
const BATCH: usize = 1024;

impl Writer {
    pub(super) fn new(coding: Coding) -> Self {
        let framer = Framer::new(coding, Session::counted(0));
        Self {
            framer,
            coding,
            keyframes: Vec::new(),
            tick: Tick::from_micros(0),
            starts: 0,
            is_fresh: true,
            events: Vec::new(),
            owes_mark: false,
        }
    }

    /// Writes all waiting items. If a loss or restart is still to be reported, writes an empty frame that reports it.
    fn all_frames(&mut self, output: &mut dyn Write) -> Result<()> {
        self.frames(true, output)?;
        if std::mem::take(&mut self.owes_mark) {
            self.is_fresh = false;
            output.write_all(self.framer.start(self.tick, &mut [0; MAX_FRAME])?.finish())?;
        }
        Ok(())
    }

    /// Writes the frames that are full. If `with_last`, also writes the last frame, which still has room for items.
    fn frames(&mut self, with_last: bool, output: &mut dyn Write) -> Result<()> {
        let Self { framer, keyframes, events, owes_mark, is_fresh, .. } = self;
        let mut buffer = [0; MAX_FRAME];
        loop {
            let start = match (keyframes.first(), events.first()) {
                (Some(keyframe), _) => keyframe.tick,
                (None, Some(event)) => event.tick,
                (None, None) => return Ok(()),
            };
            let mut frame = framer.start(start, &mut buffer)?;
            let keys = fitting(keyframes, |&keyframe| frame.keyframe(keyframe));
            let fired = if keys == keyframes.len() {
                fitting(events, |&event| frame.event(event))
            } else {
                0
            };
            let is_last = keys == keyframes.len() && fired == events.len();
            if is_last && !with_last {
                return Ok(());
            }
            output.write_all(frame.finish())?;
            (*owes_mark, *is_fresh) = (false, false);
            keyframes.drain(..keys);
            events.drain(..fired);
        }
    }
}

/// Fills a frame with items. The function `put` adds one item to the frame, and fails if the frame is full. Returns the
/// number of items added.
fn fitting<T>(items: &[T], put: impl FnMut(&T) -> Result<(), LinkError>) -> usize {
    items.iter().map(put).take_while(Result::is_ok).count()
}

impl EventWriter for Writer {
    fn write(&mut self, item: &Item, output: &mut dyn Write) -> Result<()> {
        match *item {
            Item::Event(event) => {
                self.events.push(event);
                if self.events.len() >= BATCH {
                    self.frames(false, output)?;
                }
            }
            Item::Keyframe(keyframe) => {
                let is_other = self
                    .keyframes
                    .last()
                    .is_some_and(|last| (last.tick, last.kind) != (keyframe.tick, keyframe.kind));
                if is_other || !self.events.is_empty() {
                    self.frames(true, output)?;
                }
                self.tick = keyframe.tick;
                self.keyframes.push(keyframe);
            }
            Item::Heartbeat(tick, address) => {
                self.all_frames(output)?;
                let mut buffer = [0; MAX_FRAME];
                let mut frame = self.framer.start(tick, &mut buffer)?;
                frame.heartbeat(tick, address)?;
                (self.owes_mark, self.is_fresh) = (false, false);
                output.write_all(frame.finish())?;
            }
            Item::LostFrames(_) | Item::LostEvents => {
                self.all_frames(output)?;
                self.framer.mark_loss();
                self.owes_mark = true;
            }
            Item::Restart => {
                self.all_frames(output)?;
                if !std::mem::replace(&mut self.is_fresh, true) {
                    self.starts = self.starts.wrapping_add(1);
                    self.framer = Framer::new(self.coding, Session::counted(self.starts));
                }
                self.owes_mark = true;
            }
            Item::Pixel(_) => return Err(EventsKind::NoPixels.into()),
            Item::Value { .. } => {}
        }
        Ok(())
    }

    fn finish(&mut self, output: &mut dyn Write) -> Result<()> {
        self.all_frames(output)
    }
}
