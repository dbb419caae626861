//! The link: events to frames, and frames to events and to values.

use core::{
    fmt::{self, Write},
    iter::Copied,
    slice::Iter,
};

use board::stopwatch::{counted, keep};
use fixed::{FixedI32, types::extra::U16};
use spikewire::{
    Decoder, Event, FromEvents, Scheme,
    link::{Coding, MAX_FRAME, Reader, Receiver, Session, Transmitter},
    temporal::StepForward,
};

use super::{
    ensure,
    flight::{self, CHANNELS, Digest, NO_EVENT, PERIOD, Schemes, Six},
    meter::{Cost, take},
};
use crate::signal::Measured;

type Steps<S> = Schemes<StepForward<S>>;

/// More events than a frame holds.
const FULL: usize = 512;

#[inline(never)] // leaves the stack before the next one comes
pub fn measure(out: &mut impl Write) -> fmt::Result {
    let floats = Schemes::new(StepForward::try_new).ok_or(fmt::Error)?;
    let fixed = Schemes::new(StepForward::try_new).ok_or(fmt::Error)?;
    let mut full = Link::new(&floats, &fixed);
    let mut waiting = [NO_EVENT; FULL];
    let mut count = 0;
    flight::events(|event| {
        waiting[count] = event;
        count += 1;
        if count == FULL {
            let taken = full.send(&waiting);
            waiting.copy_within(taken.., 0);
            count -= taken;
        }
    });
    // What is left fills no frame, and would cost more an event.
    full.print(out, "link-full")
}

/// A frame every 100 ms.
#[inline(never)] // leaves the stack before the next one comes
pub fn measure_slow(out: &mut impl Write) -> fmt::Result {
    let floats = Schemes::new(StepForward::try_new).ok_or(fmt::Error)?;
    let fixed = Schemes::new(StepForward::try_new).ok_or(fmt::Error)?;
    let mut slow = Link::new(&floats, &fixed);
    flight::batches::<FULL>(100_000, |events| {
        slow.all_sent &= slow.send(events) == events.len() && slow.is_whole();
    });
    slow.print(out, "link-100ms")
}

/// Both ends of a link.
struct Link<'a> {
    transmitter: Transmitter,
    reader: Reader<MAX_FRAME>,
    floats: Values<'a, f32>,
    fixed: Values<'a, FixedI32<U16>>,
    written: Cost,
    read: Cost,
    /// What the transmitter took, but for the last event, which it may hold for its next frame.
    sent: Digest,
    last: Option<Event>,
    received: Digest,
    all_sent: bool,
}

/// Events to values at the far end, and without a link.
struct Values<'a, S: Measured> {
    receiver: Receiver<Six<'a, StepForward<S>>, CHANNELS, 0>,
    decoders: [Decoder<'a, StepForward<S>>; CHANNELS],
    cost: Cost,
}

impl<'a> Link<'a> {
    fn new(floats: &'a Steps<f32>, fixed: &'a Steps<FixedI32<U16>>) -> Self {
        Self {
            transmitter: Transmitter::new(
                Coding::for_channels(CHANNELS as u16, PERIOD.into()),
                Session::counted(1),
            ),
            reader: Reader::new(),
            floats: Values::new(floats),
            fixed: Values::new(fixed),
            written: Cost::default(),
            read: Cost::default(),
            sent: Digest::new(),
            last: None,
            received: Digest::new(),
            all_sent: true,
        }
    }

    /// Sends and receives a frame, and returns how many events were taken for it, or for the next.
    fn send(&mut self, events: &[Event]) -> usize {
        let mut source = FromEvents(events.iter().copied());
        let mut buffer = [0; MAX_FRAME];
        let mut length = 0;
        let call = counted(|| take(&mut self.transmitter, &source, &buffer));
        let writing = counted(|| length = write(&mut self.transmitter, &mut source, &mut buffer));
        let taken = events.len() - source.0.len();
        for &event in &events[..taken] {
            self.last.replace(event).into_iter().for_each(|event| self.sent.add(event));
        }

        let bytes = &buffer[..length];
        let (mut reader, mut sent) = (self.reader.clone(), bytes);
        let Some(received) = reader.next_frame(&mut sent) else { return taken };
        let frame = received.frame;
        let mut count = 0;
        for event in frame.events() {
            self.received.add(event);
            self.floats.decode(event);
            self.fixed.decode(event);
            count += 1;
        }
        self.written.add(count, length, writing.saturating_sub(call));

        self.floats.apply(self.reader.clone(), bytes, count);
        self.fixed.apply(self.reader.clone(), bytes, count);
        let mut found = false;
        let mut read = |mut bytes: &[u8]| {
            let Some(received) = self.reader.next_frame(&mut bytes) else { return false };
            received.frame.events().for_each(|event| keep(&event));
            true
        };
        let reading = self.read.decoding(&mut read, bytes, &mut found);
        self.read.add(count, length, reading);
        taken
    }

    /// Whether all events that were taken have arrived.
    fn is_whole(&self) -> bool {
        let mut sent = self.sent;
        self.last.into_iter().for_each(|event| sent.add(event));
        sent == self.received
    }

    fn print(&mut self, out: &mut impl Write, name: &str) -> fmt::Result {
        let agrees = self.all_sent
            && (self.is_whole() || self.sent == self.received)
            && self.reader.frames() > 0
            && self.reader.lost_frames() == 0
            && self.floats.agree()
            && self.fixed.agree();
        ensure(out, agrees, name)?;
        self.written.print_event(out, name, "encode")?;
        self.read.print_event(out, name, "decode")?;
        self.floats.cost.print(out, (name, "apply"), Some("f32"), "event")?;
        self.fixed.cost.print(out, (name, "apply"), Some("q16.16"), "event")
    }
}

#[inline(never)]
fn write(
    transmitter: &mut Transmitter,
    source: &mut FromEvents<Copied<Iter<'_, Event>>>,
    buffer: &mut [u8],
) -> usize {
    transmitter.next_frame(source, buffer).ok().flatten().map_or(0, <[u8]>::len)
}

impl<'a, S: Measured> Values<'a, S> {
    fn new(schemes: &'a Steps<S>) -> Self {
        let schemes = schemes.each();
        let decoders = schemes.map(Scheme::decoder);
        Self { receiver: Receiver::per_channel(schemes), decoders, cost: Cost::default() }
    }

    fn decode(&mut self, event: Event) {
        self.decoders[usize::from(event.address)].decode(event.polarity.into());
    }

    fn apply(&mut self, mut reader: Reader<MAX_FRAME>, bytes: &[u8], count: usize) {
        let mut apply = |mut bytes: &[u8]| {
            if let Some(received) = reader.next_frame(&mut bytes) {
                self.receiver
                    .apply(&received, |channel, tick, value| keep(&(channel, tick, value)));
            }
        };
        let applying = self.cost.decoding(&mut apply, bytes, &mut ());
        self.cost.add(count, bytes.len(), applying);
    }

    fn agree(&self) -> bool {
        (0..).zip(&self.decoders).all(|(at, decoder)| {
            decoder.held().is_some_and(|held| self.receiver.estimate(at) == held)
        })
    }
}
