//! Faults in the field, one after the other and all together: what they do to a receiver while a sender flies on.
//!
//! A flight goes from samples through a bank, a queue, a serial port and a line to a receiver. It alternates between a
//! spell with a fault and a spell without. Beside the encoders stand decoders that lose nothing: whatever the receiver
//! calls exact must have their bits, every frame that it takes must be one that was sent, and every frame or item that is
//! missing must have been counted.

mod beside;

use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use beside::{Beside, CHANNELS, read, session_from, slot_ticks};
use catalogue::{Channel, Flight, Storable};
use host_tests::flight;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use spikewire::link::{Coding, MAX_FRAME, Reader, Received, Receiver, Session, Transmitter};
use spikewire::out::{Batch, SerialSink};
use spikewire::{
    Bank, ConfigError, EventQueue, Item, Overflow, Put, QueueView, Recovery, Sample, Scheme,
    Source, Taken, Tick,
};

/// The most events of a sample, over both channels.
const EVENTS: usize = 256;
/// Microseconds from sample to sample.
const PERIOD: u32 = 2_500;
/// Samples from one keyframe or heartbeat to the next.
const BEAT: u32 = 20;
/// Samples from one turn of main to the next.
const TURN: u32 = 4;
/// Samples until a receiver that joins late has the fingerprint: 2¹⁹ µs, and the next frame.
const FINGERPRINT: u32 = (1 << 19) / PERIOD + BEAT;
/// A reader takes an earlier session back after this many of its frames, each at least a keyframe.
const STRAYS: u32 = 16;
/// Samples in which the least talkative code brings the 277 bytes that a reader may wait for after a frame whose length is
/// wrong or whose end is missing.
const HELD_BACK: u32 = 10 * BEAT;
/// Frames and samples that are remembered.
const REMEMBERED: usize = 4_000;

/// What goes wrong in a spell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    Lost,
    Doubled,
    Late,
    FarLate,
    Cut,
    CutThenIdle,
    Spliced,
    Flipped1000,
    Flipped100,
    Short,
    BusError,
    Busy,
    QueueFull,
    SenderOut,
    SessionAgain,
    ReceiverOut,
    TickWrap,
    NumberWrap,
    Jitter,
    LateSamples,
    ClockBack,
    Drift,
    FarDrift,
    Stuck,
    Floating,
    NotFinite,
    Gap,
}

use Fault::*;

/// Each fault, what one of it is, and what the line of the table says of it.
const FAULTS: [(Fault, &str, &str); 27] = [
    (Lost, "frames", "a third of the frames lost"),
    (Doubled, "frames", "a third of the frames sent twice"),
    (Late, "frames", "a third of the frames overtaken by up to 20 later ones"),
    (FarLate, "frames", "a third of the frames overtaken by 300 later ones"),
    (Cut, "frames", "a third of the frames cut off"),
    (CutThenIdle, "frames", "the same, with a report when the line is idle"),
    (Spliced, "frames", "two senders on one line, halves of their frames joined"),
    (Flipped1000, "bits", "bits flipped, 1 in 1000"),
    (Flipped100, "bits", "bits flipped, 1 in 100"),
    (Short, "writes", "short writes, at every index of a frame"),
    (BusError, "writes", "bus errors, after every index of a frame"),
    (Busy, "writes", "the port takes nothing for 1 s"),
    (QueueFull, "samples", "main hangs, the queue overflows"),
    (SenderOut, "restarts", "brown-out of the sender, whose clock starts anywhere"),
    (SessionAgain, "restarts", "the same, and its start was not counted: the same session"),
    (ReceiverOut, "restarts", "brown-out of the receiver"),
    (TickWrap, "wraps", "ticks wrap at 2^32 us"),
    (NumberWrap, "wraps", "numbers of frames wrap at 2^16, 2^32 and 2^48"),
    (Jitter, "samples", "samples early or late by an eighth of a period or sub-timestep"),
    (
        LateSamples,
        "samples",
        "samples late by half a period to all of it (codes that count samples: to 5/8 of it)",
    ),
    (
        ClockBack,
        "steps",
        "the clock steps back by up to ten periods (codes that count samples: and a break tells)",
    ),
    (Drift, "samples", "a clock 100 ppm fast or slow"),
    (FarDrift, "samples", "a clock 50 to 10 000 ppm fast or slow"),
    (Stuck, "samples", "the sensor is stuck"),
    (Floating, "samples", "the sensor floats: noise of full scale"),
    (NotFinite, "samples", "bursts of NaN and infinities (f32)"),
    (Gap, "samples", "the sensor gives no samples"),
];

/// Counts by name.
type Counts = BTreeMap<&'static str, u64>;

/// What became of all spells of a fault.
#[derive(Debug, Default)]
struct Tally {
    spells: u64,
    samples: u64,
    injected: u64,
    noticed: Counts,
    /// Values that were called exact, and those among them that were not.
    exact: u64,
    wrong: u64,
    /// The most samples after a spell until all channels were exact, of codes with keyframes and of others.
    recovery: [u32; 2],
}

/// The port and the line behind it. Bytes that arrive wait for the receiver.
struct Line {
    fault: Option<Fault>,
    random: Pcg32,
    arrived: Vec<u8>,
    delayed: Vec<(usize, Vec<u8>)>,
    half: Option<Vec<u8>>,
    /// How many bytes the next frame that is cut short has, so that every index has its turn.
    index: usize,
    fails_next: bool,
    injected: u64,
    /// The frames that were sent last, by either sender.
    sent: VecDeque<Sent>,
}

impl Line {
    fn carry(&mut self, frame: &[u8]) {
        let mut frame = frame.to_vec();
        let hits = self.random.next_u32().is_multiple_of(3);
        self.injected += u64::from(
            hits && matches!(self.fault, Some(Lost | Doubled | Late | FarLate | Cut | CutThenIdle)),
        );
        match self.fault {
            Some(Lost) if hits => frame.clear(),
            Some(Doubled) if hits => frame.extend(frame.clone()),
            Some(late @ (Late | FarLate)) if hits => {
                let up_to_20 = 1 + self.random.next_u32() as usize % 20;
                let turns = if late == Late { up_to_20 } else { 300 };
                self.delayed.push((turns, std::mem::take(&mut frame)));
            }
            Some(Cut | CutThenIdle) if hits => {
                frame.truncate(self.random.next_u32() as usize % frame.len());
            }
            Some(Spliced) => {
                self.injected += 1;
                // The first half of one frame and the second of the next, mostly of the other sender's.
                let at = self.random.next_u32() as usize % frame.len();
                match self.half.take() {
                    _ if hits => {}
                    None => {
                        self.half = Some(frame.clone());
                        frame.truncate(at);
                    }
                    Some(_) => drop(frame.drain(..at)),
                }
            }
            Some(Flipped1000) => self.flip(&mut frame, 1_000),
            Some(Flipped100) => self.flip(&mut frame, 100),
            _ => {}
        }
        self.arrived.extend(frame);
        for waiting in &mut self.delayed {
            waiting.0 -= 1;
        }
        let arrived = &mut self.arrived;
        self.delayed.retain(|(turns, frame)| {
            if *turns == 0 {
                arrived.extend(frame);
            }
            *turns > 0
        });
    }

    fn flip(&mut self, frame: &mut [u8], one_in: u32) {
        for bit in 0..8 * frame.len() {
            if self.random.next_u32().is_multiple_of(one_in) {
                frame[bit / 8] ^= 1 << (bit % 8);
                self.injected += 1;
            }
        }
    }
}

/// A sender's side of the line.
#[derive(Clone)]
struct Port(Rc<RefCell<Line>>);

impl embedded_io::ErrorType for Port {
    type Error = embedded_io::ErrorKind;
}

impl embedded_io::Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, embedded_io::ErrorKind> {
        let line = &mut *self.0.borrow_mut();
        let fails = std::mem::take(&mut line.fails_next);
        match line.fault {
            Some(Busy) => {
                line.injected += 1;
                return Err(embedded_io::ErrorKind::TimedOut);
            }
            Some(BusError) if fails => {
                line.injected += 1;
                return Err(embedded_io::ErrorKind::Other);
            }
            Some(fault @ (Short | BusError)) => {
                line.index += 1;
                line.injected += u64::from(fault == Short);
                line.fails_next = fault == BusError;
                let taken = 1 + line.index % bytes.len();
                line.arrived.extend(&bytes[..taken]);
                return Ok(taken);
            }
            _ => line.carry(bytes),
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), embedded_io::ErrorKind> {
        Ok(())
    }
}

/// A frame that was sent, and by which start of a sender.
struct Sent {
    session: u32,
    number: u64,
    /// All that it says.
    frame: String,
}

/// A transmitter whose frames are remembered.
struct Recorded {
    transmitter: Transmitter,
    session: u32,
    line: Rc<RefCell<Line>>,
    /// How many items are in frames.
    framed: u64,
    last: Option<u64>,
    /// Reader of every frame that is sent.
    watch: Reader<MAX_FRAME>,
}

impl Batch for Recorded {
    const SHORTEST: usize = Transmitter::SHORTEST;

    fn fill(&mut self, items: &mut impl Source, bytes: &mut [u8]) -> usize {
        let length = self.transmitter.fill(items, bytes);
        if length > 0 {
            let mut bytes = &bytes[..length];
            let frame = self.watch.next_frame(&mut bytes).expect("a frame is whole").frame;
            let [keyframes, heartbeats] = [frame.keyframes().count(), frame.heartbeats().count()];
            self.framed += (frame.events().count() + keyframes + heartbeats) as u64;
            let number = frame.number();
            self.last = Some(number);
            let sent = &mut self.line.borrow_mut().sent;
            sent.push_back(Sent { session: self.session, number, frame: format!("{frame:?}") });
            if sent.len() > REMEMBERED {
                sent.pop_front();
            }
        }
        length
    }
}

/// What main takes out of the queue, and how many losses it is told of.
struct Told<'a, T>(T, &'a mut u64);

impl<T: Source> Source for Told<'_, T> {
    fn take(&mut self) -> Option<Taken> {
        let taken = self.0.take()?;
        *self.1 += u64::from(taken.lost);
        Some(taken)
    }
}

/// What an interrupt offers to the queue; breaks need no place in a frame.
#[derive(Default)]
struct Offers {
    items: u64,
    breaks: u64,
}

struct Offered<'a>(&'a QueueView, &'a mut Offers);

impl Put for Offered<'_> {
    fn put(&mut self, item: Item) {
        self.1.items += 1;
        self.1.breaks += u64::from(matches!(item, Item::Break(_)));
        self.0.put(item);
    }
}

/// A sample, and what a decoder beside the encoder makes of it.
struct Truth<S> {
    session: u32,
    time: u64,
    values: [S; CHANNELS],
}

/// One start of a sender.
struct Sender<'a, P: Scheme> {
    scheme: &'a P,
    start: &'a [u8],
    slot_ticks: u32,
    queue: &'a QueueView,
    bank: Bank<&'a P, CHANNELS>,
    sink: SerialSink<Port, Recorded, MAX_FRAME>,
    session: u32,
    first: Session,
    /// The time in nanoseconds: a period of a clock that drifts is not a whole number of ticks.
    now: u64,
    /// When the last sample was taken, in ticks.
    taken: u64,
    beside: Beside<'a, P>,
    truth: VecDeque<Truth<P::Sample>>,
    offered: Offers,
    /// Losses that the queue told of, and those before this start.
    reported: u64,
    lost_before: u32,
    not_finite: u32,
    errors: u64,
}

impl<'a, P: Storable> Sender<'a, P> {
    fn new(
        scheme: &'a P,
        start: &'a [u8],
        queue: &'a QueueView,
        line: &Rc<RefCell<Line>>,
        (session, first): (u32, Session),
        micros: u64,
    ) -> Self {
        let slot_ticks = slot_ticks(scheme, PERIOD);
        let addresses = (CHANNELS * scheme.neurons()) as u16;
        let coding = Coding::for_channels(addresses, PERIOD);

        let bank = Bank::with_states(scheme, [(); CHANNELS].map(|()| read(start)))
            .with_slot_ticks(slot_ticks);
        let transmitter = Transmitter::new(coding, first).with_fingerprint(bank.fingerprint());
        let recorded = Recorded {
            transmitter,
            session,
            line: line.clone(),
            framed: 0,
            last: None,
            watch: Reader::new(),
        };
        Self {
            scheme,
            start,
            slot_ticks,
            queue,
            bank,
            sink: SerialSink::new(Port(line.clone()), recorded),
            session,
            first,
            now: micros * 1_000,
            taken: micros,
            beside: Beside::new(scheme, start),
            truth: VecDeque::new(),
            offered: Offers::default(),
            reported: 0,
            lost_before: queue.lost(),
            not_finite: 0,
            errors: 0,
        }
    }

    /// A brown-out: nothing survives it but the count of starts. The truth is that of the test.
    fn restart(&mut self, micros: u64, session: Option<Session>) {
        let mut consumer = self.queue.consumer().unwrap();
        while consumer.take().is_some() {}
        drop(consumer);
        let line = self.sink.batch().line.clone();
        let number = self.session + 1;
        let session = session.unwrap_or(Session::counted(number));
        let fresh =
            Self::new(self.scheme, self.start, self.queue, &line, (number, session), micros);
        let old = std::mem::replace(self, fresh);
        (self.truth, self.errors) = (old.truth, old.errors);
    }

    /// Takes a sample, in the sender's interrupt.
    fn sample(&mut self, samples: [P::Sample; CHANNELS], period: u64, jitter: i64) {
        self.now += period;
        self.taken = (self.now / 1_000).wrapping_add_signed(jitter);
        let queue = Offered(self.queue, &mut self.offered);
        self.bank.encode_into(Tick::from_micros(self.taken), samples, queue);
        let last = self.truth.back().map(|last| last.values);
        let mut values = last.unwrap_or_default();
        let not_finite = samples.iter().filter(|sample| !sample.to_f64().is_finite());
        self.not_finite += not_finite.count() as u32;
        self.beside.sample(samples, &mut values);
        self.remember(values);
    }

    /// Has no sample where one is due, and tells so where a receiver counts samples.
    fn miss(&mut self, period: u64) {
        let is_first = self.now / 1_000 == self.taken;
        self.now += period;
        if is_first && P::RECOVERY != Recovery::Keyframe {
            Offered(self.queue, &mut self.offered).put(Item::Break(Tick::from_micros(self.taken)));
        }
    }

    fn remember(&mut self, values: [P::Sample; CHANNELS]) {
        self.truth.push_back(Truth { session: self.session, time: self.taken, values });
        if self.truth.len() > REMEMBERED {
            self.truth.pop_front();
        }
    }

    /// A keyframe of each channel that has one, or a heartbeat, after the last sample.
    fn beat(&mut self) {
        let queue = Offered(self.queue, &mut self.offered);
        self.bank.keyframe_into(Tick::from_micros(self.taken), queue);
        if let Some(last) = self.truth.back_mut() {
            self.beside.keyframe(&mut last.values);
        }
    }

    /// Main's turn: all that waits, as far as the port takes it.
    fn send(&mut self) {
        let consumer = self.queue.consumer().unwrap();
        let mut source = Told(consumer, &mut self.reported);
        loop {
            match self.sink.send(&mut source) {
                Ok(0) => break,
                Ok(_) => {}
                Err(_) => {
                    self.errors += 1;
                    break;
                }
            }
        }
    }

    /// Nothing is lost in silence on the way to the port.
    fn check_counts(&mut self) {
        assert!(self.queue.is_empty() && self.sink.waiting() == 0);
        let lost = u64::from(self.queue.lost() - self.lost_before);
        assert_eq!(lost, self.reported, "losses are told of in their place");
        let framed = self.sink.batch().framed;
        let due = self.offered.items - lost;
        assert!((framed..=framed + self.offered.breaks).contains(&due), "the others are in frames");
        assert_eq!(self.bank.rejected(), self.not_finite);
    }
}

/// The last frame that was delivered, and by which start of a sender it was sent.
type Delivered = Option<(u32, u64)>;

/// Two senders, a line, a receiver, and what is going wrong.
struct World<'a, P: Scheme> {
    scheme: &'a P,
    samples: &'a [P::Sample],
    at: usize,
    faults: &'a [Fault],
    /// The fault of the present or the last spell.
    fault: Fault,
    is_on: bool,
    random: Pcg32,
    line: Rc<RefCell<Line>>,
    senders: [Sender<'a, P>; 2],
    flown: u32,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<&'a P, CHANNELS, EVENTS>,
    delivered: Delivered,
    values: Vec<(u16, Tick, P::Sample)>,
    tally: Tally,
}

impl<'a, P: Storable> World<'a, P> {
    fn new(
        scheme: &'a P,
        start: &'a [u8],
        samples: &'a [P::Sample],
        queues: [&'a QueueView; 2],
        faults: &'a [Fault],
        seed: u64,
    ) -> Self {
        let line = Rc::new(RefCell::new(Line {
            fault: None,
            random: Pcg32::seed_from_u64(seed),
            arrived: Vec::new(),
            delayed: Vec::new(),
            half: None,
            index: 0,
            fails_next: false,
            injected: 0,
            sent: VecDeque::new(),
        }));
        let random = Pcg32::seed_from_u64(seed + 1);
        let senders = [0, 1].map(|one| {
            let number = 1 + (one << 30);
            let session = (number, Session::counted(number));
            Sender::new(scheme, start, queues[one as usize], &line, session, 1_000_000)
        });
        let slot_ticks = senders[0].slot_ticks;
        Self {
            scheme,
            samples,
            at: seed as usize * 97 % samples.len(),
            faults,
            fault: faults[0],
            is_on: false,
            random,
            line,
            senders,
            flown: 0,
            reader: Reader::new(),
            receiver: Receiver::new(scheme).with_slot_ticks(slot_ticks),
            delivered: None,
            values: Vec::new(),
            tally: Tally::default(),
        }
    }

    fn draw(&mut self, below: u64) -> u64 {
        self.random.next_u64() % below
    }

    /// The fault, while there is one.
    fn fault(&self) -> Option<Fault> {
        self.is_on.then_some(self.fault)
    }

    fn next_samples(&mut self) -> [P::Sample; CHANNELS] {
        if self.fault() != Some(Stuck) {
            self.at = (self.at + 1) % self.samples.len();
        }
        let fine = [self.samples[self.at], self.samples[self.samples.len() - 1 - self.at]];
        fine.map(|sample| match self.fault() {
            Some(Floating) => {
                let full = if P::Sample::KIND == f32::KIND { 35.0 } else { 32_768.0 };
                P::Sample::from_f64(full * (self.draw(1 << 16) as f64 / 32_768.0 - 1.0))
            }
            Some(NotFinite) if P::Sample::KIND == f32::KIND && self.draw(2) == 0 => {
                let bits = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][self.draw(3) as usize];
                P::Sample::from_bits32(bits.to_bits())
            }
            _ => sample,
        })
    }

    /// One period of the sender's.
    fn sample(&mut self) {
        let period = u64::from(PERIOD) * 1_000;
        self.flown += 1;
        self.tally.samples += 1;
        if self.fault() == Some(Gap) {
            self.tally.injected += 1;
            self.senders[0].miss(period);
            return;
        }
        let samples = self.next_samples();
        let is_wrong = samples.iter().any(|sample| !sample.to_f64().is_finite());
        let is_odd =
            matches!(self.fault(), Some(Stuck | Floating | Jitter | Drift | FarDrift | QueueFull));
        self.tally.injected += u64::from(is_odd || is_wrong);
        let slot_ticks = self.senders[0].slot_ticks;
        let least = if slot_ticks > 0 { slot_ticks } else { PERIOD };
        let most = i64::from((least - 1) / 8);
        let jitter = match self.fault() {
            Some(Jitter) => self.draw(2 * most as u64 + 1).cast_signed() - most,
            // A sub-timestep later or earlier looks like any other: no receiver can tell.
            Some(LateSamples) if slot_ticks == 0 && self.draw(5) == 0 => {
                self.tally.injected += 1;
                let half = u64::from(PERIOD / 2);
                let most = if self.senders[0].beside.counts() {
                    5 * u64::from(PERIOD) / 8 - 1
                } else {
                    2 * half - 1
                };
                (half + 1 + self.draw(most - half)).cast_signed()
            }
            _ => 0,
        };
        if self.fault() == Some(ClockBack) && slot_ticks == 0 && self.draw(20) == 0 {
            self.tally.injected += 1;
            let back = 1_000 * (1 + self.draw(10 * u64::from(PERIOD)));
            let counts = self.senders[0].beside.counts();
            let sender = &mut self.senders[0];
            sender.now -= back.min(sender.now);
            if counts {
                // Back among silent samples, time looks like fewer of them.
                let tick = Tick::from_micros(sender.now / 1_000);
                Offered(sender.queue, &mut sender.offered).put(Item::Break(tick));
            }
        }
        let drift = match self.fault() {
            Some(FarDrift) => period * (50 + 9_950 * (self.tally.spells / 2 % 8) / 7) / 1_000_000,
            _ => period / 10_000,
        };
        let period = match self.fault() {
            Some(Drift | FarDrift) if self.tally.spells.is_multiple_of(2) => period + drift,
            Some(Drift | FarDrift) => period - drift,
            _ => period,
        };
        self.senders[0].sample(samples, period, jitter);
        if self.fault() == Some(Spliced) {
            self.senders[1].sample([samples[1], samples[0]], period, 0);
        }
        if self.flown.is_multiple_of(BEAT) {
            self.senders.iter_mut().for_each(Sender::beat);
        }
        if self.flown.is_multiple_of(TURN) && self.fault() != Some(QueueFull) {
            self.turn();
        }
    }

    /// Main's turn on both sides.
    fn turn(&mut self) {
        if self.fault() == Some(ReceiverOut) && self.draw(100) == 0 {
            self.restart_receiver();
        }
        if self.fault() == Some(SenderOut) && self.draw(100) == 0 {
            let micros = [0, self.draw(1 << 33)][self.draw(2) as usize];
            self.restart_sender(micros, None);
        }
        if self.fault() == Some(SessionAgain) && self.draw(100) == 0 {
            let micros = [0, self.draw(1 << 33)][self.draw(2) as usize];
            let first = self.senders[0].first;
            self.restart_sender(micros, Some(first));
        }
        self.senders[0].send();
        if self.fault() == Some(Spliced) {
            self.senders[1].send();
        }
        let arrived = std::mem::take(&mut self.line.borrow_mut().arrived);
        self.receive(&arrived);
    }

    fn restart_sender(&mut self, micros: u64, session: Option<Session>) {
        self.senders[0].restart(micros, session);
        self.tally.injected += 1;
    }

    fn restart_receiver(&mut self) {
        self.note_reader();
        self.reader = Reader::new();
        let slot_ticks = self.senders[0].slot_ticks;
        self.receiver = Receiver::new(self.scheme).with_slot_ticks(slot_ticks);
        self.delivered = None;
        self.tally.injected += 1;
    }

    fn receive(&mut self, mut bytes: &[u8]) {
        // The reader lends its buffer, which is taken out of this for that time.
        let mut reader = std::mem::take(&mut self.reader);
        let tells_idle = self.fault == CutThenIdle;
        loop {
            let is_idle = tells_idle && bytes.is_empty();
            let next =
                if is_idle { reader.next_after_silence() } else { reader.next_frame(&mut bytes) };
            let Some(received) = next else {
                if is_idle || !tells_idle {
                    break;
                }
                continue;
            };
            if received.is_unread {
                self.receiver.apply(&received, |_, _, _| ());
                continue;
            }
            let session = self.check_frame(&received);
            let exact = |receiver: &Receiver<_, CHANNELS, EVENTS>| {
                [0, 1].map(|channel| receiver.exact(channel))
            };
            let before =
                if received.is_after_break() { [None; CHANNELS] } else { exact(&self.receiver) };
            let values = &mut self.values;
            values.clear();
            let on_value = |channel, tick, value| values.push((channel, tick, value));
            self.receiver.apply(&received, on_value);
            if P::RECOVERY != Recovery::Keyframe {
                self.check_samples(session, before, exact(&self.receiver));
            }
        }
        self.reader = reader;
        let sender = &mut self.senders[0];
        let last = sender.sink.batch().last.map(|number| (sender.session, number));
        let is_all_here = self.delivered == last && sender.sink.waiting() == 0;
        if is_all_here && sender.queue.is_empty() && P::RECOVERY == Recovery::Keyframe {
            let Some(truth) = sender.truth.back() else { return };
            for (channel, truth) in (0..).zip(truth.values) {
                if let Some(value) = self.receiver.exact(channel) {
                    self.tally.claim(value, Some(truth));
                }
            }
        }
    }

    /// A frame is one that was sent, and the frames missing before it are counted.
    fn check_frame(&mut self, received: &Received<'_>) -> u32 {
        let frame = &received.frame;
        let line = self.line.borrow();
        let same = |sent: &&Sent| sent.number == frame.number();
        let sent = line.sent.iter().rev().find(same).expect("no frame is invented");
        assert_eq!(sent.frame, format!("{frame:?}"), "no event is invented");
        let gap = received.gap.map_or(0, |gap| u64::from(gap.lost_frames));
        match self.delivered {
            Some((session, last)) if !received.is_start => {
                assert_eq!(session, sent.session);
                assert_eq!((last + 1 + gap) & ((1 << 48) - 1), frame.number(), "frames missing");
            }
            delivered => {
                assert!(received.is_start && gap == 0);
                let may_begin_again =
                    self.faults.iter().any(|fault| matches!(fault, Late | FarLate));
                let is_other = delivered.map(|last| last.0) != Some(sent.session);
                assert!(is_other || may_begin_again, "{:?}", self.faults);
                self.tally.notice("starts", u64::from(self.tally.spells > 0));
            }
        }
        self.tally.notice("frames after a loss", u64::from(frame.is_after_loss()));
        self.delivered = Some((sent.session, frame.number()));
        sent.session
    }

    /// Compares the values of samples that the last frame brought: the last of a channel, and all of them where the
    /// channel was exact throughout.
    fn check_samples(
        &mut self,
        session: u32,
        before: [Option<P::Sample>; CHANNELS],
        after: [Option<P::Sample>; CHANNELS],
    ) {
        let are_all_told = matches!(P::RECOVERY, Recovery::Samples(_) | Recovery::Spike);
        let slot_ticks = self.senders[0].slot_ticks;
        // A sample without events may be late, too, but its value is told where it was due.
        let near = if slot_ticks > 0 { slot_ticks } else { 5 * PERIOD / 8 };
        let truth = self.senders.each_ref().map(|sender| &sender.truth);
        for channel in 0..CHANNELS {
            let Some(value) = after[channel] else { continue };
            let heard = self.values.iter().filter(|claimed| usize::from(claimed.0) == channel);
            let heard: Vec<_> = heard.collect();
            let is_throughout = before[channel].is_some() && are_all_told;
            let first = if is_throughout { 0 } else { heard.len().saturating_sub(1) };
            if let Some(last) = heard.last() {
                assert_eq!(last.2.to_bits32(), value.to_bits32());
            }
            for &&(_, tick, claimed) in &heard[first..] {
                let away =
                    |truth: &Truth<_>| tick.since(Tick::from_micros(truth.time)).unsigned_abs();
                let all = truth.iter().flat_map(|truth| truth.iter().rev());
                let same = all.filter(|truth| truth.session == session && away(truth) <= near);
                // Between two samples, where one that was late was the first to be heard, it may be either.
                let is_told = |truth: &Truth<P::Sample>| {
                    truth.values[channel].to_bits32() == claimed.to_bits32()
                };
                let nearest = same.min_by_key(|truth| (!is_told(truth), away(truth)));
                self.tally.claim(claimed, nearest.map(|truth| truth.values[channel]));
            }
        }
    }

    fn is_exact(&self, channel: usize) -> bool {
        self.receiver.exact(channel as u16).is_some()
    }

    fn is_due(&self, channel: usize) -> bool {
        self.senders[0].beside.is_due(channel, BEAT)
    }

    /// A spell without the fault, after which all is known, and how long that took.
    fn calm(&mut self) {
        let needed = self.senders[0].beside.recovery();
        let is_damaged = matches!(self.fault, Cut | Spliced | Flipped1000 | Flipped100);
        let held_back = if is_damaged { HELD_BACK } else { 0 };
        let strays = if self.fault == Spliced { STRAYS * BEAT } else { 0 };
        let least = 10 * BEAT + needed;
        let mut recovered = None;
        for sample in 1..=least + BEAT + FINGERPRINT + strays + held_back {
            self.sample();
            if recovered.is_none() && (0..CHANNELS).all(|channel| self.is_exact(channel)) {
                recovered = Some(sample);
            }
            let is_known = (0..CHANNELS).all(|one| self.is_exact(one) || !self.is_due(one));
            if sample >= least && self.flown.is_multiple_of(BEAT) && is_known {
                break;
            }
        }
        for channel in 0..CHANNELS {
            assert!(self.is_exact(channel) || !self.is_due(channel), "after {:?}", self.fault);
        }
        let recovered = recovered.unwrap_or(0);
        if P::RECOVERY == Recovery::Keyframe {
            // A queue that is full has room for the keyframe after main's turn.
            let most = BEAT + TURN + FINGERPRINT + strays + held_back;
            assert!(recovered <= most, "right again by the next keyframe");
        }
        let longest = &mut self.tally.recovery[usize::from(P::RECOVERY != Recovery::Keyframe)];
        *longest = (*longest).max(recovered);
        self.senders[0].check_counts();
    }

    /// A spell with the fault.
    fn spell(&mut self) {
        self.is_on = true;
        self.fault = self.faults[self.draw(self.faults.len() as u64) as usize];
        self.line.borrow_mut().fault = Some(self.fault);
        self.tally.spells += 1;
        match self.fault {
            TickWrap => {
                let micros = (1 << 32) - self.draw(1_000_000);
                self.restart_sender(micros, None);
            }
            NumberWrap => {
                // Sessions whose 21st frame at the latest has a number of which all lower 32 bits are 0, in the first
                // spell all 48: their bits times the golden ratio.
                let wrap = (1 << 48) + ((77 * (self.tally.spells - 1)) << 32);
                let first = wrap - 1 - self.draw(20);
                self.restart_sender(1_000_000, Some(session_from(first)));
            }
            _ => {}
        }
        let samples = if self.fault == Busy { 400 } else { 100 + self.draw(700) };
        for _ in 0..samples {
            self.sample();
        }
        self.is_on = false;
        let mut line = self.line.borrow_mut();
        line.fault = None;
        line.half = None;
        let late = line.delayed.split_off(0);
        line.arrived.extend(late.into_iter().flat_map(|(_, frame)| frame));
    }

    fn note_reader(&mut self) {
        let reader = &self.reader;
        for (what, count) in [
            ("frames lost", reader.lost_frames()),
            ("bad checksums", reader.bad_checksums()),
            ("repeated", reader.repeated()),
            ("late", reader.late()),
            ("bytes skipped", reader.skipped()),
            ("misfits", self.receiver.misfits()),
        ] {
            self.tally.notice(what, count.into());
        }
    }

    fn fly(mut self, spells: u32) -> Tally {
        self.calm();
        for _ in 0..spells {
            self.spell();
            self.calm();
        }
        self.note_reader();
        let sender = &self.senders[0];
        self.tally.notice("write errors", sender.errors);
        self.tally.notice("items lost", sender.queue.lost().into());
        self.tally.notice("samples rejected", sender.bank.rejected().into());
        self.tally.injected += self.line.borrow().injected;
        self.tally
    }
}

impl Tally {
    fn notice(&mut self, what: &'static str, times: u64) {
        if times > 0 {
            *self.noticed.entry(what).or_default() += times;
        }
    }

    fn claim<S: Sample>(&mut self, claimed: S, truth: Option<S>) {
        self.exact += 1;
        let is_right = truth.is_some_and(|truth| truth.to_bits32() == claimed.to_bits32());
        self.wrong += u64::from(!is_right);
    }

    fn add(&mut self, other: &Self) {
        self.spells += other.spells;
        self.samples += other.samples;
        self.injected += other.injected;
        self.exact += other.exact;
        self.wrong += other.wrong;
        for (what, &times) in &other.noticed {
            self.notice(what, times);
        }
        for (longest, other) in self.recovery.iter_mut().zip(other.recovery) {
            *longest = (*longest).max(other);
        }
    }
}

/// Takes every scheme through faults.
struct Soak<'a, S> {
    samples: Vec<S>,
    faults: &'a [Fault],
    spells: u32,
    seed: u64,
    tally: Tally,
}

impl<S: Sample> Flight for Soak<'_, S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        self.seed += 1;
        let policies = [Overflow::DropOldest, Overflow::DropNewest, Overflow::Refuse];
        let queue = || EventQueue::<256>::new(policies[self.seed as usize % 3]);
        let (one, other) = (queue(), queue());
        let start = postcard::to_allocvec(&start).unwrap();
        let queues = [&*one, &*other];
        let world = World::new(scheme, &start, &self.samples, queues, self.faults, self.seed);
        let tally = world.fly(self.spells);
        assert_eq!(tally.wrong, 0, "{name} in {:?}, {:?}", S::KIND, self.faults);
        assert!(tally.exact > 0 || matches!(P::RECOVERY, Recovery::Fading(_)), "{name}");
        self.tally.add(&tally);
        Ok(())
    }
}

fn soak<S: Sample>(unit: f64, faults: &[Fault], spells: u32) -> Tally {
    let samples = flight::flown::<S>(0, unit);
    let channel = Channel::new(0, flight::calibrated(&samples));
    let mut visitor = Soak { samples, faults, spells, seed: 0, tally: Tally::default() };
    catalogue::fly(&channel, &mut visitor).unwrap();
    visitor.tally
}

/// Every fault alone, then all of them in one flight. A fault that does not show must be one that does no harm.
fn rows() -> Vec<(Vec<Fault>, &'static str, &'static str)> {
    let one = |&(fault, unit, what)| (vec![fault], unit, what);
    let all = FAULTS.map(|(fault, ..)| fault).to_vec();
    let last = (all, "in all", "all of these in one flight, in any order");
    FAULTS.iter().map(one).chain([last]).collect()
}

/// Counts that are known from what was injected.
fn check_noticed(faults: &[Fault], tally: &Tally) {
    let noticed = |what| tally.noticed.get(what).copied().unwrap_or(0);
    match faults {
        [Lost] => assert_eq!(noticed("frames lost"), tally.injected),
        [Doubled] => assert_eq!(noticed("repeated"), tally.injected),
        // A short frame that is late by more than an eighth of its counts is not known as one.
        [Late] => {
            let (late, lost) = (noticed("late"), noticed("frames lost"));
            assert!(late <= lost && late > lost - lost / 10, "{:?}", tally.noticed);
            assert!(late == lost || noticed("bad checksums") > 0);
        }
        [FarLate] => assert!(noticed("late") > 0),
        [SenderOut | SessionAgain | ReceiverOut | TickWrap | NumberWrap] => {
            assert!(noticed("starts") > 0);
        }
        [LateSamples] => assert!(noticed("misfits") > 0),
        [ClockBack] => assert!(noticed("frames after a loss") > 0),
        [Busy | BusError] => assert_eq!(noticed("write errors"), tally.injected),
        // A clock at the end of what the receiver is told may be noticed before its pace is measured.
        [FarDrift] => {
            assert!(tally.noticed.keys().all(|what| *what == "misfits"), "{:?}", tally.noticed);
        }
        [Short | Jitter | Drift | Stuck | Floating] => {
            assert!(tally.noticed.is_empty(), "{:?}", tally.noticed);
        }
        _ => assert!(!tally.noticed.is_empty() || tally.injected == 0),
    }
}

#[test]
fn whatever_goes_wrong_nothing_is_wrong_that_is_called_exact() {
    let mut silent = Vec::new();
    for (number, (faults, ..)) in rows().iter().enumerate() {
        let is_float = number.is_multiple_of(2) || faults[..] == [NotFinite];
        let tally =
            if is_float { soak::<f32>(1.0, faults, 1) } else { soak::<i16>(1000.0, faults, 1) };
        check_noticed(faults, &tally);
        // Of two senders on one line only full frames are read.
        let least = if faults[..] == [Spliced] { 5_000 } else { 10_000 };
        if tally.injected == 0 || tally.exact <= least {
            silent.push((faults.clone(), tally.injected, tally.exact));
        }
    }
    assert!(silent.is_empty(), "without a fault or with few exact values: {silent:?}");
}

/// Prints the table of SAFETY.md, from flights of hours; see `cargo xtask write faults`.
#[test]
#[ignore = "minutes"]
fn hours_of_flight() {
    let mut all = Tally::default();
    println!("| fault | injected | noticed | exact again within | values called exact |");
    println!("|---|---|---|---|---|");
    for (faults, unit, what) in rows() {
        let spells = if faults.len() > 1 { 100 } else { 20 };
        let mut tally = soak::<f32>(1.0, &faults, spells);
        check_noticed(&faults, &tally);
        if faults[..] != [NotFinite] {
            let counts = soak::<i16>(1000.0, &faults, spells);
            check_noticed(&faults, &counts);
            tally.add(&counts);
        }
        let noticed: Vec<_> =
            tally.noticed.iter().map(|(what, times)| format!("{times} {what}")).collect();
        let noticed = if noticed.is_empty() { "nothing".into() } else { noticed.join(", ") };
        let [keyframes, others] =
            tally.recovery.map(|samples| f64::from(samples * PERIOD) / 1_000_000.0);
        let Tally { injected, exact, .. } = tally;
        println!(
            "| {what} | {injected} {unit} | {noticed} | {keyframes:.2} s, {others:.2} s | {exact} |"
        );
        all.add(&tally);
    }
    let hours = all.samples as f64 * f64::from(PERIOD) / 3.6e9;
    println!(
        "| {} spells in {hours:.0} hours | | | | {}, {} wrong |",
        all.spells, all.exact, all.wrong
    );
}
