//! The whole way: six channels through SF in an interrupt, a queue, and frames in main.

use core::{
    fmt::{self, Write},
    hint::black_box,
};

use board::stopwatch::{Count, counted};
use spikewire::{
    Bank, ConfigError, Consumer, Event, EventQueue, Overflow, Source as _, SpscQueue, Start, Tick,
    link::{MAX_FRAME, Reader, Receiver, Session, Transmitter},
    temporal::{SendOnDelta, StepForward},
};

use super::{
    ensure,
    flight::{self, CHANNELS, PERIOD, Schemes, Six},
    meter::{Cost, take},
};
use crate::signal::Measured;

static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

/// An event in and out again, through either queue.
#[inline(never)] // leaves the stack before the next one comes
pub fn queues(out: &mut impl Write) -> fmt::Result {
    let mut consumer = EVENTS.consumer().ok_or(fmt::Error)?;
    queue(out, "queue", |event| EVENTS.push(event).is_ok(), || consumer.take_event())?;
    let lock_free = SpscQueue::<64>::new();
    let (mut producer, mut consumer) = lock_free.split().ok_or(fmt::Error)?;
    let push = |event| {
        producer.push(event);
        true
    };
    queue(out, "queue-lock-free", push, || consumer.take_event())
}

fn queue(
    out: &mut impl Write,
    name: &str,
    mut push: impl FnMut(Event) -> bool,
    mut pop: impl FnMut() -> Option<Event>,
) -> fmt::Result {
    let (mut pushed, mut popped) = (Cost::default(), Cost::default());
    let mut agrees = true;
    flight::events(|event| {
        let mut is_in = false;
        let pushing = pushed.encoding(&mut |event, _| push(event), event, &mut [], &mut is_in);
        pushed.add(1, 0, pushing);
        let mut back = None;
        let popping = popped.decoding(&mut |_| pop(), &[], &mut back);
        popped.add(1, 0, popping);
        agrees &= is_in && back == Some(event);
    });
    ensure(out, agrees, name)?;
    pushed.print_event(out, name, "push")?;
    popped.print_event(out, name, "pop")
}

/// Counts the whole way by sets of six samples, at the recording's own rate and at 8 kHz.
#[inline(never)] // leaves the stack before the next one comes
pub fn measure<S: Measured>(out: &mut impl Write, sample: &str) -> fmt::Result {
    let schemes = Schemes::new(StepForward::<S>::try_new).ok_or(fmt::Error)?;
    Way::new(&schemes, PERIOD).go(out, ("path-200hz", sample), flight::samples())?;
    fast(out, "path-8khz", sample, StepForward::<S>::try_new)?;
    fast(out, "path-send-on-delta-8khz", sample, SendOnDelta::<S, 4>::try_new)
}

/// The samples of 10 s at 8 kHz.
#[inline(never)] // leaves the stack before the next one comes
fn fast<P: Start<Sample: Measured>>(
    out: &mut impl Write,
    path: &str,
    sample: &str,
    scheme: impl Fn(P::Sample) -> Result<P, ConfigError>,
) -> fmt::Result {
    let schemes = Schemes::new(scheme).ok_or(fmt::Error)?;
    let samples = flight::samples_every(SPACING.into()).take(10 * 8_000);
    Way::new(&schemes, SPACING).go(out, (path, sample), samples)
}

/// Of 8000 samples a second, in µs.
const SPACING: u16 = 125;
/// From one burst of frames to the next, and from one keyframe to the next, in µs.
const FRAMES: u32 = 100_000;
const KEYFRAMES: u32 = 1_000_000;

/// What an interrupt does.
#[inline(never)]
fn interrupt<P: Start>(
    bank: &mut Bank<Six<'_, P>, CHANNELS>,
    tick: &Tick,
    set: &[P::Sample; CHANNELS],
) {
    bank.encode_into(*tick, *set, &EVENTS);
}

/// What it does as well, once a second.
#[inline(never)]
fn keyframes<P: Start>(bank: &Bank<Six<'_, P>, CHANNELS>, tick: &Tick) {
    bank.keyframe_into(*tick, &EVENTS);
}

/// What main does, and how many bytes it wrote.
#[inline(never)]
fn send(transmitter: &mut Transmitter, events: &mut Consumer<'_>, buffer: &mut [u8]) -> usize {
    let mut used = 0;
    while let Ok(Some(frame)) = transmitter.next_frame(&mut *events, &mut buffer[used..]) {
        used += frame.len();
    }
    used
}

/// From samples to frames, and to values at the other end.
struct Way<'a, P: Start> {
    bank: Bank<Six<'a, P>, CHANNELS>,
    transmitter: Transmitter,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<Six<'a, P>, CHANNELS, 0>,
    interrupt: Cost,
    main: Cost,
    all: Cost,
}

impl<'a, P: Start<Sample: Measured>> Way<'a, P> {
    fn new(schemes: &'a Schemes<P>, period: u16) -> Self {
        let bank = schemes.bank();
        let transmitter = Transmitter::for_bank(&bank, period.into(), Session::counted(1));
        Self {
            bank,
            transmitter,
            reader: Reader::new(),
            receiver: Receiver::per_channel(schemes.each()),
            interrupt: Cost::default(),
            main: Cost::default(),
            all: Cost::default(),
        }
    }

    fn go(
        &mut self,
        out: &mut impl Write,
        (name, sample): (&str, &str),
        samples: impl Iterator<Item = (Tick, [f32; CHANNELS])>,
    ) -> fmt::Result {
        let mut events = EVENTS.consumer().ok_or(fmt::Error)?;
        let (mut sets, mut interrupts) = (0, Count::default());
        let (mut frames_at, mut keyframes_at) = (Tick::from(FRAMES), Tick::from(0));
        let mut agrees = true;
        for (tick, set) in samples.map(flight::typed) {
            let mut count = self.interrupt(&tick, &set);
            if !tick.is_before(keyframes_at) {
                count += counted(|| keyframes(&self.bank, black_box(&tick)));
                keyframes_at = tick + KEYFRAMES;
            }
            self.interrupt.add(1, 0, count);
            interrupts += count;
            sets += 1;

            if !tick.is_before(frames_at) {
                let mut buffer = [0; 3 * MAX_FRAME];
                let mut length = 0;
                let main = counted(|| {
                    length = send(&mut self.transmitter, &mut events, &mut buffer);
                });
                self.main.add(sets, length, main);
                interrupts += main;
                self.all.add(sets, length, interrupts);
                (sets, interrupts) = (0, Count::default());
                frames_at = tick + FRAMES;
                agrees &= self.arrives(&buffer[..length]);
            }
        }
        while events.take().is_some() {} // after the last frame
        ensure(out, agrees && EVENTS.lost() == 0, name)?;
        self.interrupt.print(out, (name, "interrupt"), Some(sample), "sample set")?;
        self.main.print(out, (name, "main"), Some(sample), "sample set")?;
        self.all.print(out, (name, "all"), Some(sample), "sample set")
    }

    /// The instructions of an interrupt, without its call.
    fn interrupt(&mut self, tick: &Tick, set: &[P::Sample; CHANNELS]) -> Count {
        let (tick, set, bank) = (black_box(tick), black_box(set), &mut self.bank);
        let call = *self.interrupt.call.get_or_insert_with(|| counted(|| take(bank, tick, set)));
        counted(|| interrupt(bank, tick, set)).saturating_sub(call)
    }

    /// Whether the values at the other end are those that the encoders hold.
    fn arrives(&mut self, mut bytes: &[u8]) -> bool {
        while let Some(received) = self.reader.next_frame(&mut bytes) {
            self.receiver.apply(&received, |_, _, _| ());
        }
        (0..CHANNELS).all(|at| self.receiver.exact(at as u16) == self.bank.keyframe(at))
    }
}
