//! The link: events to frames, and frames to events and to values.

use core::{
    fmt::{self, Write},
    iter::Copied,
    slice::Iter,
};

use board::stopwatch::{instructions, keep};
use fixed::{FixedI32, types::extra::U16};
use spikewire::{
    Decoder, Event, Polarity, Sample, Scheme,
    link::{Coding, FrameView, MAX_FRAME, Raw, Reader, Receiver, Transmitter},
    temporal::StepDecoder,
};

use super::{
    ensure,
    flight::{self, CHANNELS, Digest, PERIOD},
    meter::{Cost, take},
};

/// More events than a frame holds.
const FULL: usize = 512;

pub fn measure(out: &mut impl Write) -> fmt::Result {
    let mut full = Link::new().ok_or(fmt::Error)?;
    let mut waiting = [Event { tick: 0, address: 0, polarity: Polarity::Up }; FULL];
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
    full.print(out, "link-full")?;

    let mut slow = Link::new().ok_or(fmt::Error)?;
    flight::batches::<FULL>(100_000, |events| slow.all_sent &= slow.send(events) == events.len());
    slow.print(out, "link-100ms")
}

/// Both ends of a link.
struct Link {
    transmitter: Transmitter<f32, CHANNELS>,
    reader: Reader<MAX_FRAME>,
    floats: Values<f32>,
    fixed: Values<FixedI32<U16>>,
    written: Cost,
    read: Cost,
    sent: Digest,
    received: Digest,
    all_sent: bool,
}

/// Events to values at the far end, and without a link.
struct Values<S> {
    receiver: Receiver<S, CHANNELS>,
    decoders: [StepDecoder<S>; CHANNELS],
    cost: Cost,
}

impl Link {
    fn new() -> Option<Self> {
        Some(Self {
            transmitter: Transmitter::new(Coding::for_channels(CHANNELS as u16, PERIOD)),
            reader: Reader::new(),
            floats: Values::new()?,
            fixed: Values::new()?,
            written: Cost::default(),
            read: Cost::default(),
            sent: Digest::new(),
            received: Digest::new(),
            all_sent: true,
        })
    }

    /// Sends and receives a frame, and returns how many events were taken for it.
    fn send(&mut self, events: &[Event]) -> usize {
        let mut source = events.iter().copied();
        let mut buffer = [0; MAX_FRAME];
        let mut length = 0;
        let call = instructions(|| take(&mut self.transmitter, &source, &buffer));
        let writing =
            instructions(|| length = write(&mut self.transmitter, &mut source, &mut buffer));
        let taken = events.len() - source.len();
        events[..taken].iter().for_each(|&event| self.sent.add(event));

        let bytes = &buffer[..length];
        let Ok((frame, _)) = FrameView::new(bytes) else { return taken };
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

    fn print(&mut self, out: &mut impl Write, name: &str) -> fmt::Result {
        let agrees = self.all_sent
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
    transmitter: &mut Transmitter<f32, CHANNELS>,
    source: &mut Copied<Iter<'_, Event>>,
    buffer: &mut [u8],
) -> usize {
    transmitter.next_frame(source, buffer).ok().flatten().map_or(0, <[u8]>::len)
}

impl<S: Raw + Sample> Values<S> {
    fn new() -> Option<Self> {
        let schemes = flight::schemes()?;
        let decoders = schemes.map(Scheme::decoder);
        Some(Self { receiver: Receiver::from_schemes(schemes), decoders, cost: Cost::default() })
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
        (0..).zip(&self.decoders).all(|(at, decoder)| self.receiver.estimate(at) == decoder.value())
    }
}
