//! What the interrupts do, whatever calls them: push numbered events.

use core::{
    cell::RefCell,
    sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering::SeqCst},
};

use critical_section::Mutex;
use spikewire::{Event, EventQueue, Item, Overflow, Polarity, Refused, SpscProducer, Tick};

/// Items that a queue holds.
pub const ROOM: usize = 32;

pub static QUEUES: [(Overflow, EventQueue<ROOM>); 3] = [
    (Overflow::DropOldest, EventQueue::new(Overflow::DropOldest)),
    (Overflow::DropNewest, EventQueue::new(Overflow::DropNewest)),
    (Overflow::Refuse, EventQueue::new(Overflow::Refuse)),
];

/// Which of them is pushed to, or the lock-free one if it is none of them.
pub static CHOSEN: AtomicUsize = AtomicUsize::new(0);

/// The end of the lock-free queue; the upper interrupt takes it for as long as it strikes.
pub static PRODUCER: Mutex<RefCell<Option<SpscProducer<'static>>>> = Mutex::new(RefCell::new(None));

/// The upper interrupt, and the lower one, within which the upper one strikes.
pub static SOURCES: [Source; 2] = [const { Source::new() }; 2];

/// What one interrupt did. It alone writes this: a Cortex-M0 has no atomic addition.
pub struct Source {
    /// Events offered to the queue.
    pub offered: AtomicU32,
    /// Those that came back.
    pub refused: AtomicU32,
    /// Whether one came back as another.
    pub is_torn: AtomicBool,
    /// How often it struck within another's burst.
    pub nested: AtomicU32,
    is_busy: AtomicBool,
}

impl Source {
    const fn new() -> Self {
        Self {
            offered: AtomicU32::new(0),
            refused: AtomicU32::new(0),
            is_torn: AtomicBool::new(false),
            nested: AtomicU32::new(0),
            is_busy: AtomicBool::new(false),
        }
    }

    /// As before its first event.
    pub fn reset(&self) {
        self.offered.store(0, SeqCst);
        self.refused.store(0, SeqCst);
        self.is_torn.store(false, SeqCst);
        self.nested.store(0, SeqCst);
    }

    /// How many events did not come back: the next one's number.
    pub fn kept(&self) -> u32 {
        self.offered.load(SeqCst) - self.refused.load(SeqCst)
    }
}

fn increment(counter: &AtomicU32) {
    counter.store(counter.load(SeqCst) + 1, SeqCst);
}

/// Offers the source's next events to the chosen queue. One that comes back is offered again, as its next.
pub fn strike(index: usize, events: u32) {
    let source = &SOURCES[index];
    source.is_busy.store(true, SeqCst);
    if SOURCES[1 - index].is_busy.load(SeqCst) {
        increment(&source.nested);
    }
    match QUEUES.get(CHOSEN.load(SeqCst)) {
        Some((_, queue)) => (0..events).for_each(|_| push(index, queue)),
        None => push_lock_free(index, events),
    }
    source.is_busy.store(false, SeqCst);
}

fn push(index: usize, queue: &EventQueue<ROOM>) {
    let source = &SOURCES[index];
    let event = numbered(index, source.kept());
    if let Err(Refused(back)) = queue.push(event) {
        increment(&source.refused);
        if back != Item::Event(event) {
            source.is_torn.store(true, SeqCst);
        }
    }
    increment(&source.offered);
}

/// Pushes outside of every critical section.
fn push_lock_free(index: usize, events: u32) {
    let Some(mut producer) = critical_section::with(|cs| PRODUCER.borrow_ref_mut(cs).take()) else {
        return;
    };
    for _ in 0..events {
        producer.push(numbered(index, SOURCES[index].kept()));
        increment(&SOURCES[index].offered);
    }
    critical_section::with(|cs| PRODUCER.borrow_ref_mut(cs).replace(producer));
}

/// An event whose every part tells which it is: half of one and half of another would be seen.
pub fn numbered(source: usize, number: u32) -> Event {
    let micros = number << 1 | source as u32;
    let mixed = micros.wrapping_mul(0x9E37_79B1);
    let polarity = if mixed & 0x8000 == 0 { Polarity::Down } else { Polarity::Up };
    Event { tick: Tick::from(micros), address: (mixed >> 16) as u16, polarity }
}

/// The source and the number of an event, if it is whole.
pub fn read(event: Event) -> Option<(usize, u32)> {
    let micros = event.tick.micros();
    let (source, number) = (micros as usize & 1, micros >> 1);
    (numbered(source, number) == event).then_some((source, number))
}
