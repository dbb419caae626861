//! What main does under the storm, and what must hold after it.

use core::{
    fmt::{self, Write},
    hint::spin_loop,
    sync::atomic::Ordering::SeqCst,
};

use spikewire::{EventQueue, Overflow, Source as _, SpscConsumer, SpscQueue};

use crate::{
    account::Account,
    source::{CHOSEN, PRODUCER, QUEUES, ROOM, SOURCES, Source},
    weather,
};

/// Events of each source that main outlasts.
const STORM: u32 = 5_000;

/// One place more than it has room for.
static LOCK_FREE: SpscQueue<{ ROOM + 1 }> = SpscQueue::new();

pub fn run(out: &mut impl Write) -> fmt::Result {
    for (index, (overflow, queue)) in QUEUES.iter().enumerate() {
        CHOSEN.store(index, SeqCst);
        let name = name(*overflow);
        what_stays(*overflow, queue).or_else(|broken| fail(out, name, broken))?;
        let storm = outlast(*overflow, queue).or_else(|broken| fail(out, name, broken))?;
        writeln!(out, "{name}: {storm}")?;
    }
    let (producer, consumer) = LOCK_FREE.split().ok_or(fmt::Error)?;
    CHOSEN.store(QUEUES.len(), SeqCst);
    critical_section::with(|cs| PRODUCER.borrow_ref_mut(cs).replace(producer));
    let name = "lock-free";
    let storm = outlast_lock_free(consumer).or_else(|broken| fail(out, name, broken))?;
    writeln!(out, "{name}: {storm}")
}

fn name(overflow: Overflow) -> &'static str {
    match overflow {
        Overflow::DropOldest => "drop-oldest",
        Overflow::DropNewest => "drop-newest",
        Overflow::Refuse => "refuse",
    }
}

fn fail<T>(out: &mut impl Write, name: &str, broken: &str) -> Result<T, fmt::Error> {
    writeln!(out, "{name}: {broken}")?;
    Err(fmt::Error)
}

pub fn ensure(holds: bool, broken: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(broken) }
}

/// Main sleeps, one source strikes: the newest events stay, or the oldest, as the policy says.
fn what_stays(overflow: Overflow, queue: &EventQueue<ROOM>) -> Result<(), &'static str> {
    SOURCES.iter().for_each(Source::reset);
    let [source, _] = &SOURCES;
    weather::start(false);
    while source.offered.load(SeqCst) < 3 * ROOM as u32 {
        spin_loop();
    }
    weather::stop();

    let offered = source.offered.load(SeqCst);
    let over = offered - ROOM as u32;
    let (lost, refused) = if overflow == Overflow::Refuse { (0, over) } else { (over, 0) };
    ensure(
        (queue.lost(), queue.refused()) == (lost, refused),
        "what found no room is not counted",
    )?;
    ensure(source.refused.load(SeqCst) == refused, "what was refused did not come back")?;
    ensure(queue.len() == ROOM && queue.peak() == ROOM, "the queue was not full")?;

    let mut items = queue.consumer().ok_or("there is a consumer already")?;
    ensure(queue.consumer().is_none(), "there are two consumers")?;
    let mut account = Account::default();
    for place in 0..ROOM {
        let taken = items.take().ok_or("an event is missing")?;
        let is_first = place == 0 && overflow == Overflow::DropOldest;
        ensure(taken.lost == if is_first { lost } else { 0 }, "a loss is told in another place")?;
        account.take(taken)?;
    }
    if overflow == Overflow::DropNewest {
        account.take(items.take().ok_or("the loss behind the last event is not told")?)?;
    }
    ensure(items.take().is_none(), "an event stayed")?;
    account.close(lost)?;
    ensure(account.taken() == ROOM as u32, "other events stayed than the policy says")
}

/// What became of all events.
struct Outcome {
    offered: [u32; 2],
    nested: u32,
    taken: u32,
    lost: u32,
    refused: u32,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offered: [upper, lower], nested, taken, lost, refused } = self;
        write!(
            f,
            "{upper} + {lower} offered, {nested} times one within the other; \
             {taken} taken, {lost} lost, {refused} refused"
        )
    }
}

/// Both sources strike and main takes what it can.
fn outlast(overflow: Overflow, queue: &EventQueue<ROOM>) -> Result<Outcome, &'static str> {
    SOURCES.iter().for_each(Source::reset);
    let before = (queue.lost(), queue.refused());
    let dropped = || (queue.lost() - before.0, queue.refused() - before.1);
    let mut items = queue.consumer().ok_or("there is a consumer already")?;
    let mut account = Account::default();
    weather::start(true);
    while SOURCES.iter().any(|source| source.offered.load(SeqCst) < STORM) || dropped() == (0, 0) {
        items.take().map_or(Ok(()), |taken| account.take(taken))?;
        work();
    }
    weather::stop();
    while let Some(taken) = items.take() {
        account.take(taken)?;
    }

    let (lost, refused) = dropped();
    account.close(lost)?;
    let came_back: u32 = count(|source| source.refused.load(SeqCst)).iter().sum();
    ensure(refused == came_back, "what was refused did not come back")?;
    ensure(SOURCES.iter().all(|source| !source.is_torn.load(SeqCst)), "another event came back")?;
    let is_policy = if overflow == Overflow::Refuse { lost == 0 } else { refused == 0 };
    ensure(is_policy, "counted as what the policy is not")?;
    ensure(queue.peak() == ROOM && queue.is_empty(), "the queue holds more or less than it can")?;
    let nested = count(|source| source.nested.load(SeqCst)).iter().sum();
    ensure(nested > 0 || !weather::NESTS, "no interrupt struck within the other")?;
    let offered = count(|source| source.offered.load(SeqCst));
    Ok(Outcome { offered, nested, taken: account.taken(), lost, refused })
}

/// One source strikes, as the lock-free queue has one producer.
fn outlast_lock_free(mut items: SpscConsumer<'static>) -> Result<Outcome, &'static str> {
    SOURCES.iter().for_each(Source::reset);
    let [source, _] = &SOURCES;
    let mut account = Account::default();
    weather::start(false);
    while source.offered.load(SeqCst) < STORM || items.lost() == 0 {
        items.take().map_or(Ok(()), |taken| account.take(taken))?;
        (0..30).for_each(|_| work()); // slower than the source
    }
    weather::stop();
    while let Some(taken) = items.take() {
        account.take(taken)?;
    }
    account.close(items.lost())?;
    let (taken, lost) = (account.taken(), items.lost());
    Ok(Outcome { offered: [source.offered.load(SeqCst), 0], nested: 0, taken, lost, refused: 0 })
}

/// The rest of what main has to do.
fn work() {
    (0..30).for_each(|_| spin_loop());
}

fn count(counter: fn(&Source) -> u32) -> [u32; 2] {
    SOURCES.each_ref().map(counter)
}
