//! The queue without critical sections, for one interrupt that drops the newest.

use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc;

use super::slot::Slot;
use crate::event::{Item, Put, Source, Taken, Tick};

/// A queue of `N - 1` items from one interrupt to main, without locks, over `heapless::spsc`.
///
/// Interrupts are never held off, and what finds no room is lost: [`EventQueue`](super::EventQueue) has
/// other policies and any number of interrupts.
///
/// - **Ends:** [`split`](Self::split) makes a [`SpscProducer`] for the interrupt and a [`SpscConsumer`]
///   for main.
/// - **Memory:** `16 N + 16` bytes on a 32-bit part.
/// - **Losses** are said as by [`EventQueue`](super::EventQueue).
///
/// ```
/// use spikewire::{Event, Polarity, Source, SpscQueue, Tick};
///
/// let mut queue = SpscQueue::<3>::new();
/// let (mut interrupt, mut main) = queue.split();
/// for micros in [1, 2, 3] {
///     let tick = Tick::from_micros(micros);
///     interrupt.push(Event { tick, address: 0, polarity: Polarity::Up });
/// }
/// assert_eq!(main.take().map(|taken| taken.item.tick().micros()), Some(1));
/// assert_eq!(main.take().map(|taken| taken.item.tick().micros()), Some(2));
/// assert_eq!(main.take().map(|taken| taken.lost), Some(1)); // a break: one was lost
/// ```
pub struct SpscQueue<const N: usize> {
    items: spsc::Queue<Entry, N>,
    loss: Loss,
    /// Of the producer: whether the last push was lost, for counts that wrapped all the way round.
    is_after_loss: bool,
    /// Of the consumer: the count of losses that were said.
    known: u32,
}

/// An item, and the count of losses when it was pushed.
#[derive(Clone, Copy)]
struct Entry {
    slot: Slot,
    lost: u32,
}

/// What was lost, written by the producer alone. Loads and stores suffice: a Cortex-M0 has no others.
struct Loss {
    /// Wraps.
    count: AtomicU32,
    /// The tick of the last one.
    tick: AtomicU32,
}

impl<const N: usize> SpscQueue<N> {
    /// An empty queue.
    pub const fn new() -> Self {
        const { assert!(N >= 2, "a queue has room for at least one item") };
        let loss = Loss { count: AtomicU32::new(0), tick: AtomicU32::new(0) };
        Self { items: spsc::Queue::new(), loss, is_after_loss: false, known: 0 }
    }

    /// The two ends. What the queue holds stays in it.
    pub fn split(&mut self) -> (SpscProducer<'_>, SpscConsumer<'_>) {
        let Self { items, loss, is_after_loss, known } = self;
        let (producer, consumer) = items.split();
        (
            SpscProducer { items: producer, loss, is_after_loss },
            SpscConsumer { items: consumer, loss, known },
        )
    }
}

impl<const N: usize> Default for SpscQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> fmt::Debug for SpscQueue<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpscQueue").field("len", &self.items.len()).finish_non_exhaustive()
    }
}

/// The interrupt's end of a [`SpscQueue`].
pub struct SpscProducer<'a> {
    items: spsc::Producer<'a, Entry>,
    loss: &'a Loss,
    is_after_loss: &'a mut bool,
}

impl SpscProducer<'_> {
    /// Puts an item, such as an event, at the end, or counts it as lost.
    #[inline]
    pub fn push(&mut self, item: impl Into<Item>) {
        let lost = self.loss.count.load(Ordering::Relaxed);
        let slot = Slot::from(item.into()).with_lost((*self.is_after_loss).into());
        *self.is_after_loss = false;
        if let Err(entry) = self.items.enqueue(Entry { slot, lost }) {
            *self.is_after_loss = true;
            self.loss.tick.store(entry.slot.tick().micros(), Ordering::Relaxed);
            self.loss.count.store(lost.wrapping_add(1), Ordering::Release);
        }
    }

    /// How many items were lost since the queue was made; wraps.
    pub fn lost(&self) -> u32 {
        self.loss.count.load(Ordering::Relaxed)
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

impl fmt::Debug for SpscProducer<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpscProducer").field("lost", &self.lost()).finish_non_exhaustive()
    }
}

/// Main's end of a [`SpscQueue`].
pub struct SpscConsumer<'a> {
    items: spsc::Consumer<'a, Entry>,
    loss: &'a Loss,
    known: &'a mut u32,
}

impl SpscConsumer<'_> {
    /// How many items wait.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether none waits.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many items were lost since the queue was made; wraps.
    pub fn lost(&self) -> u32 {
        self.loss.count.load(Ordering::Relaxed)
    }
}

impl Source for SpscConsumer<'_> {
    #[inline]
    fn take(&mut self) -> Option<Taken> {
        // Before the look into the queue: so all items before these losses are taken, if it is empty.
        let count = self.loss.count.load(Ordering::Acquire);
        let (slot, now) = match self.items.dequeue() {
            Some(Entry { slot, lost }) => (slot, lost),
            None if count == *self.known => return None,
            None => {
                let tick = self.loss.tick.load(Ordering::Relaxed);
                (Slot::lost_at(Tick::from_micros(tick.into())), count)
            }
        };
        let lost = now.wrapping_sub(*self.known).max(slot.lost.into());
        *self.known = now;
        Some(Taken { lost, item: slot.item() })
    }
}

impl fmt::Debug for SpscConsumer<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpscConsumer").field("len", &self.len()).finish_non_exhaustive()
    }
}
