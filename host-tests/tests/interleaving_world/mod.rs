//! A sender, its line and a receiver, whose every step is chosen.

mod chooser;

use std::cell::{Cell, RefCell};

pub(crate) use chooser::Chooser;
use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Item, Keyframe, Overflow, Put, QueueView, Source, Taken, Tick};

const STEP: i16 = 10;
static SCHEME: StepForward<i16> = StepForward::new(STEP);

/// What may happen, and how often.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) overflow: Overflow,
    /// Samples and keyframes, in interrupts.
    pub(crate) interrupts: u32,
    /// How many of them may come within another's pushes.
    pub(crate) nested: u32,
    /// Frames lost, sent twice or overtaken.
    pub(crate) line_faults: u32,
    pub(crate) reboots: u32,
    /// Readers replaced.
    pub(crate) readers: u32,
    /// Encoders reset.
    pub(crate) resets: u32,
    /// How often main sends all there is.
    pub(crate) frames: u32,
    /// The bytes of a frame at most.
    pub(crate) room: usize,
    pub(crate) fault: Option<Fault>,
}

/// A fault of an earlier design, to be put back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The count of losses is read in a critical section of its own, after the item was taken.
    LossReadApart,
    /// A keyframe travels beside the queue, and is sent when a source of the items that were there at its
    /// start says that there is none left.
    KeyframesBeside,
    /// A reset is told at once, and a keyframe that waits in the queue is sent after it.
    KeyframeKeptOverReset,
    /// Every start of the sender has the same session.
    SessionsAlike,
}

/// One encoder behind an interrupt. The second one has the higher priority.
struct Channel {
    bank: RefCell<Bank<&'static StepForward<i16>, 1>>,
    resets: Cell<i16>,
    /// What a decoder of all its items would hold.
    held: Cell<Option<i16>>,
}

impl Channel {
    fn new(address: u16) -> Self {
        let bank = Bank::new(&SCHEME).with_first_address(address);
        Self { bank: RefCell::new(bank), resets: Cell::new(0), held: Cell::new(None) }
    }
}

pub(crate) struct World<'a> {
    case: Case,
    left: RefCell<Case>,
    chooser: RefCell<Chooser>,
    queues: [&'a QueueView; 3],
    boots: Cell<usize>,
    channels: [Channel; 2],
    now: Cell<Tick>,
    /// Of all items ever pushed, their ticks and what both decoders would hold behind them.
    history: RefCell<Vec<(Tick, [Option<i16>; 2])>>,
    /// Where keyframes wait that travel beside the queue.
    beside: RefCell<Vec<Keyframe>>,
    /// A break that overtakes the queue.
    reset_told: Cell<Option<Item>>,
}

/// The far end.
struct Far {
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<&'static StepForward<i16>, 2, 0>,
    /// How far in the history frames have been delivered.
    heard: Option<usize>,
    /// A frame that is overtaken.
    overtaken: Vec<Vec<u8>>,
    claims: u64,
}

/// Pushes, with interrupts between.
struct Pushing<'w, 'a> {
    world: &'w World<'a>,
    channel: usize,
}

impl Put for Pushing<'_, '_> {
    fn put(&mut self, item: Item) {
        let Self { world, channel } = *self;
        if channel == 0 {
            world.nested();
        }
        world.note(channel, item);
        match item {
            Item::Keyframe(keyframe) if world.case.fault == Some(Fault::KeyframesBeside) => {
                world.beside.borrow_mut().push(keyframe);
            }
            Item::Break(_) if world.case.fault == Some(Fault::KeyframeKeptOverReset) => {
                world.reset_told.set(Some(item));
            }
            _ => world.queue().put(item),
        }
    }
}

/// Takes, with interrupts between.
struct Taking<'w, 'a, S> {
    world: &'w World<'a>,
    source: S,
    /// With the fault of losses read apart: those known.
    lost: &'w Cell<u32>,
}

impl<S: Source> Source for Taking<'_, '_, S> {
    fn take(&mut self) -> Option<Taken> {
        self.world.interrupts();
        if let Some(item) = self.world.reset_told.take() {
            return Some(Taken::whole(item));
        }
        let taken = self.source.take();
        if self.world.case.fault == Some(Fault::LossReadApart) {
            // As if the item said nothing of losses, and the queue were asked later.
            self.world.interrupts();
            let now = self.world.queue().lost();
            let lost = now - self.lost.replace(now);
            return taken.map(|taken| Taken { lost, ..taken });
        }
        taken
    }
}

impl<'a> World<'a> {
    pub(crate) fn new(case: Case, queues: [&'a QueueView; 3], chooser: Chooser) -> Self {
        Self {
            case,
            left: RefCell::new(case),
            chooser: RefCell::new(chooser),
            queues,
            boots: Cell::new(0),
            channels: [Channel::new(0), Channel::new(1)],
            now: Cell::new(Tick::from(u32::MAX - 6_000)), // it wraps on the way
            history: RefCell::default(),
            beside: RefCell::default(),
            reset_told: Cell::default(),
        }
    }

    pub(crate) fn into_chooser(self) -> Chooser {
        self.chooser.into_inner()
    }

    fn queue(&self) -> &'a QueueView {
        self.queues[self.boots.get()]
    }

    fn choose(&self, options: u8) -> u8 {
        self.chooser.borrow_mut().choose(options)
    }

    /// Spends one of a budget, if there is one left and it is chosen.
    fn spends(&self, budget: fn(&mut Case) -> &mut u32) -> bool {
        let has_left = *budget(&mut self.left.borrow_mut()) > 0;
        let spends = has_left && self.choose(2) == 1;
        if spends {
            *budget(&mut self.left.borrow_mut()) -= 1;
        }
        spends
    }

    fn tick(&self) -> Tick {
        self.now.set(self.now.get() + 1_000);
        self.now.get()
    }

    /// What a decoder that loses nothing holds behind an item.
    fn note(&self, channel: usize, item: Item) {
        let held = &self.channels[channel].held;
        match item {
            Item::Event(_) => held.set(held.get().map(|held| held + STEP)),
            Item::Keyframe(keyframe) => {
                let value = keyframe.value();
                assert!(held.get().is_none() || held.get() == value);
                held.set(value);
            }
            Item::Break(_) => held.set(None),
            Item::Heartbeat { .. } => {}
        }
        let held = self.channels.each_ref().map(|channel| channel.held.get());
        self.history.borrow_mut().push((item.tick(), held));
    }

    /// A sample that spikes, but for the first, which is the baseline.
    fn sample(&self, channel: usize) {
        let Channel { bank, resets, .. } = &self.channels[channel];
        let base = bank.borrow().keyframe(0);
        let sample = base.map_or(1_000 * (resets.get() + 1), |base| base + STEP + 1);
        let pushing = Pushing { world: self, channel };
        bank.borrow_mut().encode_into(self.tick(), [sample], pushing);
    }

    fn keyframe(&self, channel: usize) {
        let pushing = Pushing { world: self, channel };
        self.channels[channel].bank.borrow().keyframe_into(self.tick(), pushing);
    }

    fn reset(&self, channel: usize) {
        let Channel { bank, resets, .. } = &self.channels[channel];
        resets.set(resets.get() + 1);
        bank.borrow_mut().reset_into(self.tick(), Pushing { world: self, channel });
    }

    /// Any interrupts that are left, in any order.
    fn interrupts(&self) {
        loop {
            if self.spends(|left| &mut left.resets) {
                self.reset(0);
                continue;
            }
            if self.left.borrow().interrupts == 0 {
                return;
            }
            let chosen = self.choose(5);
            if chosen == 0 {
                return;
            }
            self.left.borrow_mut().interrupts -= 1;
            match chosen {
                1 => self.sample(0),
                2 => self.keyframe(0),
                3 => self.sample(1),
                _ => self.keyframe(1),
            }
        }
    }

    /// The interrupt of higher priority, within the other.
    fn nested(&self) {
        while self.spends(|left| &mut left.nested) {
            if self.choose(2) == 0 { self.sample(1) } else { self.keyframe(1) }
        }
    }

    /// Runs to the end, and says how often a value was called exact.
    pub(crate) fn run(&self) -> Result<u64, String> {
        let mut far = Far::new();
        let mut transmitter = self.transmitter();
        // Both are exact at first.
        (0..2).for_each(|channel| self.sample(channel));
        (0..2).for_each(|channel| self.keyframe(channel));
        let quiet =
            self.left.replace(Case { interrupts: 0, nested: 0, line_faults: 0, ..self.case });
        self.left.borrow_mut().resets = 0;
        self.send(&mut transmitter, &mut far)?;
        self.left.replace(quiet);

        for _ in 0..self.case.frames {
            self.interrupts();
            if self.spends(|left| &mut left.reboots) {
                self.reboot();
                transmitter = self.transmitter();
            }
            if self.spends(|left| &mut left.readers) {
                // One that cannot know what came late: its line begins empty.
                (far.reader, far.overtaken) = (Reader::new(), Vec::new());
            }
            self.send(&mut transmitter, &mut far)?;
        }

        // Quiet from here on: everything arrives, and keyframes make all exact. The first frame of a session that came
        // after the next session's is told from another start by 16 frames at most.
        let most_rounds = if self.case.reboots > 1 { 16 / 2 } else { 0 };
        *self.left.borrow_mut() =
            Case { interrupts: 0, nested: 0, line_faults: 0, resets: 0, ..self.case };
        self.send(&mut transmitter, &mut far)?;
        for round in 0.. {
            for channel in 0..2 {
                self.sample(channel);
                self.keyframe(channel);
                self.send(&mut transmitter, &mut far)?;
            }
            let held = self.channels.each_ref().map(|sender| sender.bank.borrow().keyframe(0));
            let exact = [0, 1].map(|channel| far.receiver.exact(channel));
            if held == exact {
                break;
            }
            if round == most_rounds {
                return Err(self.report(&format!("at the end {exact:?} instead of {held:?}")));
            }
        }
        Ok(far.claims)
    }

    fn reboot(&self) {
        self.boots.set(self.boots.get() + 1);
        for Channel { bank, resets, held } in &self.channels {
            bank.borrow_mut().reset();
            resets.set(resets.get() + 5);
            held.set(None);
        }
        self.beside.borrow_mut().clear();
        self.reset_told.set(None);
    }

    fn transmitter(&self) -> Transmitter {
        let boots = self.boots.get() as u32;
        let session = if self.case.fault == Some(Fault::SessionsAlike) { 0 } else { boots };
        Transmitter::new(Coding::for_channels(2, 1_000), Session::counted(session))
            .with_full_every(0)
    }

    /// Main: sends all there is.
    fn send(&self, transmitter: &mut Transmitter, far: &mut Far) -> Result<(), String> {
        let mut consumer = self.queue().consumer().expect("the only one");
        let lost = Cell::new(self.queue().lost());
        let mut buffer = [0; MAX_FRAME];
        let buffer = &mut buffer[..self.case.room];
        if self.case.fault == Some(Fault::KeyframesBeside) {
            // What was in the queue at the start of main's turn, then the keyframes.
            let mut source = Taking { world: self, source: consumer.waiting(), lost: &lost };
            while let Some(frame) = transmitter.next_frame(&mut source, buffer).unwrap() {
                self.carry(frame, far)?;
            }
            let beside = std::mem::take(&mut *self.beside.borrow_mut());
            let items = beside.into_iter().map(Item::Keyframe);
            let mut items = spikewire::FromItems(items);
            while let Some(frame) = transmitter.next_frame(&mut items, buffer).unwrap() {
                self.carry(frame, far)?;
            }
            return Ok(());
        }
        let mut source = Taking { world: self, source: &mut consumer, lost: &lost };
        while let Some(frame) = transmitter.next_frame(&mut source, buffer).unwrap() {
            self.carry(frame, far)?;
        }
        Ok(())
    }

    /// The line.
    fn carry(&self, frame: &[u8], far: &mut Far) -> Result<(), String> {
        if self.spends(|left| &mut left.line_faults) {
            match self.choose(3) {
                0 => return Ok(()),
                1 => {
                    far.overtaken.push(frame.to_vec());
                    return Ok(());
                }
                _ => self.hear(frame, far)?,
            }
        }
        self.hear(frame, far)?;
        for frame in std::mem::take(&mut far.overtaken) {
            self.hear(&frame, far)?;
        }
        Ok(())
    }

    /// The far end takes a frame; all that it calls exact must be so.
    fn hear(&self, mut bytes: &[u8], far: &mut Far) -> Result<(), String> {
        while let Some(received) = far.reader.next_frame(&mut bytes) {
            let frame = &received.frame;
            let tick = frame.events().last().map_or(frame.tick(), |event| event.tick);
            let history = self.history.borrow();
            let heard = history.iter().rposition(|&(known, _)| known == tick);
            far.heard = far.heard.max(heard);
            far.receiver.apply(&received, |_, _, _| ());
            let truth = far.heard.map_or([None; 2], |heard| history[heard].1);
            for (channel, truth) in (0..).zip(truth) {
                let Some(exact) = far.receiver.exact(channel) else { continue };
                far.claims += 1;
                if Some(exact) != truth {
                    let wrong = format!("channel {channel} is {exact} instead of {truth:?}");
                    return Err(self.report(&wrong));
                }
            }
        }
        Ok(())
    }

    fn report(&self, wrong: &str) -> String {
        format!("{wrong}: {:?}, {:?}", self.case, self.chooser.borrow())
    }
}

impl Far {
    fn new() -> Self {
        let (reader, receiver) = (Reader::new(), Receiver::new(&SCHEME));
        Self { reader, receiver, heard: None, overtaken: Vec::new(), claims: 0 }
    }
}
