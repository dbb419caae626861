//! The queue without locks in every order in which two threads' loads and stores can take effect, as far as `loom` models
//! the memory of C11: the ring of `src/event/queue/spsc.rs` again, over loom's atomics.
//!
//! Of its six orderings other than relaxed, four are seen to be needed: with any of them relaxed an item arrives before its
//! words, or a loss before its tick. The other two keep the consumer's reads of an entry before the producer's next
//! writes to it. Without them a read might see a write that comes after it in the other thread (load buffering). Loom does not
//! execute a load after a later store of the same thread, so that it cannot show that; C11 and Arm's memory allow it.

use std::sync::atomic::{AtomicU64, Ordering as Count};

use loom::sync::Arc;
use loom::sync::atomic::Ordering::{self, Acquire, Relaxed, Release};
use loom::sync::atomic::{AtomicU32, AtomicUsize};

/// The accesses that are not relaxed, as the crate has them.
const ORDERED: [&str; 6] = [
    "ring.tail.store(next, Ordering::Release)",
    "ring.tail.load(Ordering::Acquire)",
    "ring.lost.store(lost.wrapping_add(1), Ordering::Release)",
    "self.ring.lost.load(Ordering::Acquire)",
    "ring.head.store(next, Ordering::Release)",
    "ring.head.load(Ordering::Acquire)",
];

/// Their orderings, in the order of `ORDERED`.
type Orderings = [Ordering; 6];

const AS_IN_THE_CRATE: Orderings = [Release, Acquire, Release, Acquire, Release, Acquire];

/// An entry has the words of an item, and the count of losses before it.
#[derive(Default)]
struct Entry {
    tick: AtomicU32,
    rest: AtomicU32,
    lost: AtomicU32,
}

struct Ring {
    orderings: Orderings,
    head: AtomicUsize,
    tail: AtomicUsize,
    lost: AtomicU32,
    lost_tick: AtomicU32,
    entries: Vec<Entry>,
}

impl Ring {
    fn new(places: usize, orderings: Orderings) -> Self {
        Self {
            orderings,
            head: AtomicUsize::new(places),
            tail: AtomicUsize::new(places),
            lost: AtomicU32::new(0),
            lost_tick: AtomicU32::new(0),
            entries: (0..places).map(|_| Entry::default()).collect(),
        }
    }

    /// The entry at a head or tail, the first also at the number of entries, and the head or tail after it.
    fn place(&self, at: usize) -> (&Entry, usize) {
        let at = at % self.entries.len();
        (&self.entries[at], at + 1)
    }

    /// Pushes the item of this number.
    fn push(&self, number: u32) {
        let [tail_store, _, lost_store, _, _, head_load] = self.orderings;
        let lost = self.lost.load(Relaxed);
        let tail = self.tail.load(Relaxed);
        let (entry, next) = self.place(tail);
        if next == self.head.load(head_load) {
            self.lost_tick.store(number, Relaxed);
            self.lost.store(lost + 1, lost_store);
        } else {
            entry.tick.store(number, Relaxed);
            entry.rest.store(number, Relaxed);
            entry.lost.store(lost, Relaxed);
            self.tail.store(next, tail_store);
        }
    }
}

/// The consumer, and the number of the item that was told of last, as an item or as lost.
struct Consumer {
    ring: Arc<Ring>,
    known: u32,
    last: u32,
}

impl Consumer {
    /// Takes an item or a break, and checks that it comes next.
    fn take(&mut self) {
        if self.take_slot() {
            return;
        }
        let count = self.ring.lost.load(self.ring.orderings[3]);
        if self.take_slot() {
            return;
        }
        let tick = self.ring.lost_tick.load(Relaxed);
        let lost = count - self.known;
        self.known = count;
        self.last += lost;
        assert!(lost == 0 || tick >= self.last, "a break comes before its tick");
    }

    fn take_slot(&mut self) -> bool {
        let ring = &self.ring;
        let [_, tail_load, _, _, head_store, _] = ring.orderings;
        let head = ring.head.load(Relaxed);
        if head == ring.tail.load(tail_load) {
            return false;
        }
        let (entry, next) = ring.place(head);
        let number = entry.tick.load(Relaxed);
        let rest = entry.rest.load(Relaxed);
        let count = entry.lost.load(Relaxed);
        ring.head.store(next, head_store);
        assert_eq!(number, rest, "an item comes before its words");
        let lost = count.wrapping_sub(self.known);
        self.known = count;
        assert_eq!(self.last.wrapping_add(lost).wrapping_add(1), number, "an item is out of order");
        self.last = number;
        true
    }
}

/// Runs every execution, and returns how many there are.
fn explore(places: usize, pushes: u32, takes: u32, orderings: Orderings) -> u64 {
    let executions = std::sync::Arc::new(AtomicU64::new(0));
    let counter = executions.clone();
    loom::model(move || {
        counter.fetch_add(1, Count::Relaxed);
        let ring = Arc::new(Ring::new(places, orderings));
        let mut consumer = Consumer { ring: ring.clone(), known: 0, last: 0 };
        let main = loom::thread::spawn(move || {
            (0..takes).for_each(|_| consumer.take());
            consumer
        });
        (1..=pushes).for_each(|number| ring.push(number));
        let mut consumer = main.join().unwrap();
        (0..=pushes).for_each(|_| consumer.take());
        assert_eq!(consumer.last, pushes, "all were taken, or told as lost");
    });
    executions.load(Count::Relaxed)
}

/// What this explores is what the crate does.
#[test]
fn the_orderings_are_those_of_the_crate() {
    let source = include_str!("../../src/event/queue/spsc.rs");
    for access in ORDERED {
        assert_eq!(source.matches(access).count(), 1, "{access}");
    }
    let [all, relaxed] =
        ["(Ordering::", "(Ordering::Relaxed)"].map(|text| source.matches(text).count());
    let stores = source.matches(", Ordering::Relaxed)").count();
    assert_eq!(source.matches("Ordering::").count() - relaxed - stores, ORDERED.len(), "{all}");
}

#[test]
fn every_execution_of_two_threads_is_right() {
    for (places, pushes, takes) in [(2, 2, 2), (2, 3, 2), (3, 3, 2)] {
        let executions = explore(places, pushes, takes, AS_IN_THE_CRATE);
        println!("{places} places, {pushes} pushes, {takes} takes: {executions} executions");
    }
}

#[test]
fn four_weaker_orderings_are_found() {
    for (weakened, access) in ORDERED.into_iter().enumerate() {
        let mut orderings = AS_IN_THE_CRATE;
        orderings[weakened] = Relaxed;
        let result = std::panic::catch_unwind(|| explore(2, 3, 2, orderings));
        println!("{access} relaxed: {}", if result.is_err() { "found" } else { "not seen" });
        assert_eq!(result.is_err(), weakened < 4, "{access}");
    }
}
