//! The whole way: six channels through SF in an interrupt, a queue, and frames in main.

use core::{
    fmt::{self, Write},
    hint::black_box,
};

use board::stopwatch::instructions;
use spikewire::{
    Encoder, Event,
    link::{Coding, MAX_FRAME, Raw, Reader, Receiver, Transmitter},
    sink::{EventQueue, Overflow},
};

use super::{
    ensure,
    flight::{self, CHANNELS, PERIOD, Six},
    meter::{Cost, take},
};
use crate::signal::Measured;

static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);

/// An event in and out again.
pub fn queue(out: &mut impl Write) -> fmt::Result {
    let (mut pushed, mut popped) = (Cost::default(), Cost::default());
    let mut agrees = true;
    flight::events(|event| {
        let mut result = Ok(());
        let mut push = |event: Event, _: &mut [u8]| EVENTS.push(event);
        let pushing = pushed.encoding(&mut push, event, &mut [], &mut result);
        pushed.add(1, 0, pushing);
        let mut back = None;
        let popping = popped.decoding(&mut |_| EVENTS.pop(), &[], &mut back);
        popped.add(1, 0, popping);
        agrees &= result.is_ok() && back == Some(event);
    });
    ensure(out, agrees, "queue")?;
    pushed.print_event(out, "queue", "push")?;
    popped.print_event(out, "queue", "pop")
}

/// Counts the whole way by sets of six samples, at the recording's own rate and at 8 kHz.
pub fn measure<S: Measured + Raw>(out: &mut impl Write, sample: &str) -> fmt::Result {
    Way::<S>::new(PERIOD).ok_or(fmt::Error)?.go(out, ("path-200hz", sample), flight::samples())?;
    let fast = flight::samples_every(SPACING.into()).take(10 * 8_000);
    Way::<S>::new(SPACING).ok_or(fmt::Error)?.go(out, ("path-8khz", sample), fast)
}

/// Of 8000 samples a second, in µs.
const SPACING: u16 = 125;
/// From one burst of frames to the next, and from one keyframe to the next, in µs.
const FRAMES: u32 = 100_000;
const KEYFRAMES: u32 = 1_000_000;

/// What an interrupt does.
#[inline(never)]
fn interrupt<S: Measured>(bank: &mut Six<S>, tick: &u32, set: &[S; CHANNELS]) {
    bank.encode_into(*tick, *set, &EVENTS);
}

/// What main does, and how many bytes it wrote.
#[inline(never)]
fn send<S: Raw>(transmitter: &mut Transmitter<S, CHANNELS>, buffer: &mut [u8]) -> usize {
    let mut used = 0;
    while let Ok(Some(frame)) = transmitter.next_frame(&EVENTS, &mut buffer[used..]) {
        used += frame.len();
    }
    used
}

/// From samples to frames, and to values at the other end.
struct Way<S> {
    bank: Six<S>,
    transmitter: Transmitter<S, CHANNELS>,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<S, CHANNELS>,
    interrupt: Cost,
    main: Cost,
    all: Cost,
}

impl<S: Measured + Raw> Way<S> {
    fn new(period: u16) -> Option<Self> {
        Some(Self {
            bank: flight::bank()?,
            transmitter: Transmitter::new(Coding::for_channels(CHANNELS as u16, period)),
            reader: Reader::new(),
            receiver: Receiver::from_schemes(flight::schemes()?),
            interrupt: Cost::default(),
            main: Cost::default(),
            all: Cost::default(),
        })
    }

    fn go(
        &mut self,
        out: &mut impl Write,
        (name, sample): (&str, &str),
        samples: impl Iterator<Item = (u32, [f32; CHANNELS])>,
    ) -> fmt::Result {
        let (mut sets, mut interrupts) = (0, 0);
        let (mut frames_at, mut keyframe_at) = (FRAMES, 0);
        let mut agrees = true;
        for (tick, set) in samples.map(flight::typed) {
            let (at, set) = (black_box(&tick), black_box(&set));
            let bank = &mut self.bank;
            let call =
                *self.interrupt.call.get_or_insert_with(|| instructions(|| take(bank, at, set)));
            let count = instructions(|| interrupt(bank, at, set)).saturating_sub(call);
            self.interrupt.add(1, 0, count);
            interrupts += count;
            sets += 1;

            if tick >= frames_at {
                let mut main = 0;
                if tick >= keyframe_at {
                    let bank = &self.bank;
                    let mark = EVENTS.mark();
                    main += instructions(|| self.transmitter.keyframe(bank.snapshot(tick, mark)));
                    keyframe_at = tick + KEYFRAMES;
                }
                let mut buffer = [0; 2 * MAX_FRAME];
                let mut length = 0;
                main += instructions(|| length = send(&mut self.transmitter, &mut buffer));
                self.main.add(sets, length, main);
                self.all.add(sets, length, interrupts + main);
                (sets, interrupts) = (0, 0);
                frames_at = tick + FRAMES;
                agrees &= self.arrives(&buffer[..length]);
            }
        }
        while EVENTS.pop().is_some() {} // after the last frame
        ensure(out, agrees && EVENTS.lost() == 0, name)?;
        self.interrupt.print(out, (name, "interrupt"), Some(sample), "sample set")?;
        self.main.print(out, (name, "main"), Some(sample), "sample set")?;
        self.all.print(out, (name, "all"), Some(sample), "sample set")
    }

    /// Whether the values at the other end are those that the encoders hold.
    fn arrives(&mut self, mut bytes: &[u8]) -> bool {
        while let Some(received) = self.reader.next_frame(&mut bytes) {
            self.receiver.apply(&received, |_, _, _| ());
        }
        let mut channels = (0..).zip(self.bank.channels());
        channels.all(|(at, encoder)| self.receiver.exact(at) == encoder.keyframe())
    }
}
