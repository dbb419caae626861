//! What main does under the storm, and what must hold after it.

use crate::{
    source::{CHOSEN, QUEUES, ROOM, SOURCES, read},
    weather,
};
use core::{
    fmt::{self, Write},
    hint::spin_loop,
    sync::atomic::Ordering::SeqCst,
};
use spikewire::sink::{EventQueue, Overflow};

/// Events of each source that main outlasts.
const STORM: u32 = 5_000;

pub fn run(out: &mut impl Write) -> fmt::Result {
    for (index, (overflow, queue)) in QUEUES.iter().enumerate() {
        CHOSEN.store(index, SeqCst);
        SOURCES.iter().for_each(|source| source.reset());
        what_stays(*overflow, queue).or_else(|broken| fail(out, *overflow, broken))?;
        SOURCES.iter().for_each(|source| source.reset());
        let storm = outlast(*overflow, queue).or_else(|broken| fail(out, *overflow, broken))?;
        writeln!(out, "{overflow:?}: {storm}")?;
    }
    Ok(())
}

fn fail<T>(out: &mut impl Write, overflow: Overflow, broken: &str) -> Result<T, fmt::Error> {
    writeln!(out, "{overflow:?}: {broken}")?;
    Err(fmt::Error)
}

fn ensure(holds: bool, broken: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(broken) }
}

/// Main sleeps, one source strikes: the newest events stay, or the oldest, as the policy says.
fn what_stays(overflow: Overflow, queue: &EventQueue<ROOM>) -> Result<(), &'static str> {
    let [source, _] = &SOURCES;
    weather::start(false);
    while source.offered.load(SeqCst) < 3 * ROOM as u32 {
        spin_loop();
    }
    weather::stop();

    let offered = source.offered.load(SeqCst);
    let over = offered - ROOM as u32;
    let first = if overflow == Overflow::DropOldest { over } else { 0 };
    let (lost, refused) = if overflow == Overflow::Refuse { (0, over) } else { (over, 0) };
    ensure(
        (queue.lost(), queue.refused()) == (lost, refused),
        "what found no room is not counted",
    )?;
    ensure(source.refused.load(SeqCst) == refused, "what was refused did not come back")?;
    ensure(queue.len() == ROOM && queue.peak() == ROOM, "the queue was not full")?;
    let numbers = (first..).take(ROOM).map(|number| Some((0, number)));
    ensure(
        queue.drain().into_iter().map(read).eq(numbers),
        "other events stayed than the policy says",
    )?;
    ensure(queue.is_empty(), "an event stayed")
}

/// What became of all events.
struct Outcome {
    offered: [u32; 2],
    nested: u32,
    popped: u32,
    lost: u32,
    refused: u32,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offered: [upper, lower], nested, popped, lost, refused } = self;
        write!(
            f,
            "{upper} + {lower} offered, {nested} times one within the other; \
             {popped} popped, {lost} lost, {refused} refused"
        )
    }
}

/// Both sources strike and main takes what it can.
fn outlast(overflow: Overflow, queue: &EventQueue<ROOM>) -> Result<Outcome, &'static str> {
    let before = (queue.lost(), queue.refused());
    let dropped = || (queue.lost() - before.0, queue.refused() - before.1);
    let mut main = Main::default();
    weather::start(true);
    while SOURCES.iter().any(|source| source.offered.load(SeqCst) < STORM) || dropped() == (0, 0) {
        queue.pop().map_or(Ok(()), |event| main.take(read(event)))?;
        (0..30).for_each(|_| spin_loop()); // the rest of main's work
    }
    weather::stop();
    queue.drain().into_iter().try_for_each(|event| main.take(read(event)))?;

    let count = |counter: fn(&crate::source::Source) -> u32| SOURCES.each_ref().map(counter);
    let offered = count(|source| source.offered.load(SeqCst));
    let came_back: u32 = count(|source| source.refused.load(SeqCst)).iter().sum();
    let (lost, refused) = dropped();
    let popped = main.popped;
    ensure(SOURCES.iter().all(|source| !source.is_torn.load(SeqCst)), "another event came back")?;
    ensure(
        offered.iter().sum::<u32>() == popped + lost + refused,
        "an event is not accounted for",
    )?;
    ensure(refused == came_back, "what was refused did not come back")?;
    let is_policy = if overflow == Overflow::Refuse { lost == 0 } else { refused == 0 };
    ensure(is_policy, "counted as what the policy is not")?;
    ensure(queue.peak() == ROOM && queue.is_empty(), "the queue holds more or less than it can")?;
    let nested = count(|source| source.nested.load(SeqCst)).iter().sum();
    ensure(nested > 0 || !weather::NESTS, "no interrupt struck within the other")?;
    Ok(Outcome { offered, nested, popped, lost, refused })
}

/// What main has taken.
#[derive(Default)]
struct Main {
    popped: u32,
    /// The number that a source's next event has at least.
    next: [u32; 2],
}

impl Main {
    fn take(&mut self, event: Option<(usize, u32)>) -> Result<(), &'static str> {
        let (source, number) = event.ok_or("an event is torn")?;
        ensure(number >= self.next[source], "an event is out of order, or came twice")?;
        self.next[source] = number + 1;
        self.popped += 1;
        Ok(())
    }
}
