//! What the interrupts do, whatever calls them: push numbered events.

use core::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering::SeqCst};
use spikewire::{
    Event, Polarity,
    sink::{EventQueue, Overflow, Refused},
};

/// Events that a queue holds.
pub const ROOM: usize = 32;

pub static QUEUES: [(Overflow, EventQueue<ROOM>); 3] = [
    (Overflow::DropOldest, EventQueue::new(Overflow::DropOldest)),
    (Overflow::DropNewest, EventQueue::new(Overflow::DropNewest)),
    (Overflow::Refuse, EventQueue::new(Overflow::Refuse)),
];

/// Which of them is pushed to.
pub static CHOSEN: AtomicUsize = AtomicUsize::new(0);

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
}

fn increment(counter: &AtomicU32) {
    counter.store(counter.load(SeqCst) + 1, SeqCst);
}

/// Offers the source's next events to the chosen queue.
pub fn strike(index: usize, events: u32) {
    let (_, queue) = &QUEUES[CHOSEN.load(SeqCst)];
    let source = &SOURCES[index];
    source.is_busy.store(true, SeqCst);
    if SOURCES[1 - index].is_busy.load(SeqCst) {
        increment(&source.nested);
    }
    for _ in 0..events {
        let event = numbered(index, source.offered.load(SeqCst));
        if let Err(Refused(back)) = queue.push(event) {
            increment(&source.refused);
            if back != event {
                source.is_torn.store(true, SeqCst);
            }
        }
        increment(&source.offered);
    }
    source.is_busy.store(false, SeqCst);
}

/// An event whose every part tells which it is: half of one and half of another would be seen.
pub fn numbered(source: usize, number: u32) -> Event {
    let tick = number << 1 | source as u32;
    let mixed = tick.wrapping_mul(0x9E37_79B1);
    let polarity = if mixed & 0x8000 == 0 { Polarity::Down } else { Polarity::Up };
    Event { tick, address: (mixed >> 16) as u16, polarity }
}

/// The source and the number of an event, if it is whole.
pub fn read(event: Event) -> Option<(usize, u32)> {
    let (source, number) = (event.tick as usize & 1, event.tick >> 1);
    (numbered(source, number) == event).then_some((source, number))
}
