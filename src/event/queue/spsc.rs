//! The queue without critical sections, for a single interrupt; when full, it drops new items.

use core::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

use super::ring_place;
use super::slot::Slot;
use crate::event::{Event, Item, Put, Source, Taken, Tick};

/// A queue of `N - 1` items from one interrupt to main, without locks.
///
/// Interrupts are never held off; an item that finds no room is lost and counted.
/// [`EventQueue`](super::EventQueue) has other policies, takes any number of interrupts, and can wake a task. The
/// algorithm is that of `heapless::spsc`. That crate divides by the capacity, and a linker cannot rule out the panic
/// of a division by 0.
///
/// - **Ends:** [`split`](Self::split) makes an [`SpscProducer`] for the interrupt and an [`SpscConsumer`]
///   for main.
/// - **Memory:** `16 N + 20` bytes on a 32-bit part.
/// - **Losses:** as with [`EventQueue`](super::EventQueue); the number lost between two items taken wraps at 2³².
///
/// ```
/// use spikewire::{Event, Polarity, Source, SpscQueue, Tick};
///
/// static EVENTS: SpscQueue<3> = SpscQueue::new();
///
/// let (mut interrupt, mut main) = EVENTS.split().expect("the first call");
/// for micros in [1, 2, 3] {
///     let tick = Tick::from_micros(micros);
///     interrupt.push(Event { tick, address: 0, polarity: Polarity::Up });
/// }
/// assert_eq!(main.take().map(|taken| taken.item.tick().micros()), Some(1));
/// assert_eq!(main.take().map(|taken| taken.item.tick().micros()), Some(2));
/// assert_eq!(main.take().map(|taken| taken.lost), Some(1)); // a break: one was lost
/// ```
#[derive(Debug)]
pub struct SpscQueue<const N: usize>(Ring<[Entry; N]>);

/// The ring that both ends share. Each field is written by one end only, so that atomic loads and stores suffice: a
/// Cortex-M0 has no other atomics.
#[derive(Debug)]
struct Ring<C: ?Sized> {
    /// The index of the oldest item, or `N` for the first entry; written by the consumer.
    head: AtomicUsize,
    /// The index of the next item, or `N` for the first entry; written by the producer. The entry before the head
    /// stays empty.
    tail: AtomicUsize,
    /// How many items were lost; wraps. Written by the producer.
    lost: AtomicU32,
    /// The tick of the item lost last; written by the producer.
    lost_tick: AtomicU32,
    /// 1 after [`SpscQueue::split`].
    is_split: AtomicU32,
    entries: C,
}

/// An item, and the count of losses when it was pushed.
#[derive(Debug)]
struct Entry {
    tick: AtomicU32,
    bits: AtomicU32,
    rest: AtomicU32,
    lost: AtomicU32,
}

impl Entry {
    const fn empty() -> Self {
        let [tick, bits, rest, lost] = [const { AtomicU32::new(0) }; 4];
        Self { tick, bits, rest, lost }
    }
}

impl<const N: usize> SpscQueue<N> {
    /// An empty queue, for a `static`.
    pub const fn new() -> Self {
        const { assert!(N >= 2, "a queue has room for at least one item") };
        Self(Ring {
            head: AtomicUsize::new(N),
            tail: AtomicUsize::new(N),
            lost: AtomicU32::new(0),
            lost_tick: AtomicU32::new(0),
            is_split: AtomicU32::new(0),
            entries: [const { Entry::empty() }; N],
        })
    }

    /// The two ends at the first call; `None` at any later one.
    pub fn split(&self) -> Option<(SpscProducer<'_>, SpscConsumer<'_>)> {
        let ring = &self.0;
        let was_split = critical_section::with(|_| {
            let was_split = ring.is_split.load(Ordering::Relaxed);
            ring.is_split.store(1, Ordering::Relaxed);
            was_split
        });
        (was_split == 0).then_some((SpscProducer { ring }, SpscConsumer { ring, known: 0 }))
    }
}

impl<const N: usize> Default for SpscQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's end of an [`SpscQueue`].
#[derive(Debug)]
pub struct SpscProducer<'a> {
    ring: &'a Ring<[Entry]>,
}

impl SpscProducer<'_> {
    /// Appends an item, such as an event; if the queue is full, the item is lost and counted.
    #[inline]
    pub fn push(&mut self, item: impl Into<Item>) {
        let ring = self.ring;
        let (tick, bits, rest) = Slot::from(item.into()).words();
        let lost = ring.lost.load(Ordering::Relaxed);
        let tail = ring.tail.load(Ordering::Relaxed);
        match ring_place(&ring.entries, tail) {
            Some((entry, next)) if next != ring.head.load(Ordering::Acquire) => {
                entry.tick.store(tick.micros(), Ordering::Relaxed);
                entry.bits.store(bits, Ordering::Relaxed);
                entry.rest.store(rest, Ordering::Relaxed);
                entry.lost.store(lost, Ordering::Relaxed);
                ring.tail.store(next, Ordering::Release);
            }
            _ => {
                ring.lost_tick.store(tick.micros(), Ordering::Relaxed);
                ring.lost.store(lost.wrapping_add(1), Ordering::Release);
            }
        }
    }

    /// How many items were lost since the queue was made; wraps.
    pub fn lost(&self) -> u32 {
        self.ring.lost.load(Ordering::Relaxed)
    }
}

impl Put for SpscProducer<'_> {
    #[inline]
    fn put(&mut self, item: Item) {
        self.push(item);
    }
}

impl Put for &mut SpscProducer<'_> {
    #[inline]
    fn put(&mut self, item: Item) {
        self.push(item);
    }
}

/// Main's end of an [`SpscQueue`].
#[derive(Debug)]
pub struct SpscConsumer<'a> {
    ring: &'a Ring<[Entry]>,
    /// The count of losses reported so far.
    known: u32,
}

impl SpscConsumer<'_> {
    /// Number of items in the queue.
    pub fn len(&self) -> usize {
        let [head, tail] = [&self.ring.head, &self.ring.tail].map(|at| at.load(Ordering::Relaxed));
        let turn = if tail >= head { 0 } else { self.ring.entries.len() };
        tail.wrapping_add(turn).wrapping_sub(head)
    }

    /// Whether the queue is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many items were lost since the queue was made; wraps.
    pub fn lost(&self) -> u32 {
        self.ring.lost.load(Ordering::Relaxed)
    }

    /// The slot of the oldest item, and how many were lost before it.
    #[inline]
    fn take_slot(&mut self) -> Option<(u32, Slot)> {
        let ring = self.ring;
        let head = ring.head.load(Ordering::Relaxed);
        let tail = ring.tail.load(Ordering::Acquire);
        if head == tail {
            return None;
        }
        let (entry, next) = ring_place(&ring.entries, head)?;
        let tick = Tick::from(entry.tick.load(Ordering::Relaxed));
        let words = (tick, entry.bits.load(Ordering::Relaxed), entry.rest.load(Ordering::Relaxed));
        let count = entry.lost.load(Ordering::Relaxed);
        ring.head.store(next, Ordering::Release);
        Some((self.newly(count), Slot::from_words(words)))
    }

    /// How many items were lost since the last call, from the count of all losses so far.
    #[inline]
    fn newly(&mut self, lost: u32) -> u32 {
        lost.wrapping_sub(core::mem::replace(&mut self.known, lost))
    }

    /// Takes from a queue that was empty: an item pushed meanwhile, or a break if items were lost after the last one.
    #[cold]
    #[inline(never)]
    fn take_where_empty(&mut self) -> Option<Taken> {
        // Read before the tail: if the queue is empty then, all items before these losses have been taken.
        let count = self.ring.lost.load(Ordering::Acquire);
        if let Some((lost, slot)) = self.take_slot() {
            return Some(Taken { lost, item: slot.item() });
        }
        let tick = self.ring.lost_tick.load(Ordering::Relaxed);
        let lost = self.newly(count);
        (lost > 0).then(|| Taken { lost, item: Item::Break(Tick::from(tick)) })
    }

    /// The next event, where the oldest item was no event or the queue was empty.
    #[cold]
    #[inline(never)]
    fn take_event_apart(&mut self) -> Option<Event> {
        loop {
            if let Item::Event(event) = self.take()?.item {
                return Some(event);
            }
        }
    }
}

impl Source for SpscConsumer<'_> {
    #[inline]
    fn take(&mut self) -> Option<Taken> {
        let Some((lost, slot)) = self.take_slot() else { return self.take_where_empty() };
        let item = slot.plain_event().map_or_else(|| slot.item(), Item::Event);
        Some(Taken { lost, item })
    }

    #[inline]
    fn take_event(&mut self) -> Option<Event> {
        let event = self.take_slot().and_then(|(_, slot)| slot.plain_event());
        if event.is_some() { event } else { self.take_event_apart() }
    }
}
