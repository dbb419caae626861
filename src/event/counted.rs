//! The containers of `heapless` as ends of queues: items go in by way of a counter of losses, and come out as a source.

use heapless::LenType;
use heapless::deque::DequeInner;
use heapless::spsc;
use heapless::vec::{VecInner, VecStorage};

use super::{Event, Item, Put, Source, Taken};

/// An element that a container may hold of the stream: [`Taken`], [`Item`] or [`Event`].
pub trait Element: Into<Taken> {
    /// The element of an item, with the number of items lost before it; `None` if the element cannot hold the item.
    fn of(taken: Taken) -> Option<Self>;
}

/// Items with the losses before them: whoever takes one learns of the losses in their place.
impl Element for Taken {
    fn of(taken: Taken) -> Option<Self> {
        Some(taken)
    }
}

/// Items alone: only [`Counted`] knows of losses.
impl Element for Item {
    fn of(taken: Taken) -> Option<Self> {
        Some(taken.item)
    }
}

/// Events alone: keyframes, breaks and heartbeats are left out.
impl Element for Event {
    fn of(taken: Taken) -> Option<Self> {
        match taken.item {
            Item::Event(event) => Some(event),
            Item::Keyframe(_) | Item::Break(_) | Item::Heartbeat { .. } => None,
        }
    }
}

/// A container of fixed capacity, which may have no room for an item.
pub trait Container {
    /// The type of its elements.
    type Element: Element;

    /// Appends an element.
    ///
    /// # Errors
    /// Returns an error if the container is full; the element is returned.
    fn append(&mut self, element: Self::Element) -> Result<(), Self::Element>;
}

impl<C: Container + ?Sized> Container for &mut C {
    type Element = C::Element;

    fn append(&mut self, element: C::Element) -> Result<(), C::Element> {
        (**self).append(element)
    }
}

impl<T: Element, L: LenType, S: VecStorage<T> + ?Sized> Container for VecInner<T, L, S> {
    type Element = T;

    fn append(&mut self, element: T) -> Result<(), T> {
        self.push(element)
    }
}

impl<T: Element, S: VecStorage<T> + ?Sized> Container for DequeInner<T, S> {
    type Element = T;

    fn append(&mut self, element: T) -> Result<(), T> {
        self.push_back(element)
    }
}

impl<T: Element> Container for spsc::Producer<'_, T> {
    type Element = T;

    fn append(&mut self, element: T) -> Result<(), T> {
        self.enqueue(element)
    }
}

#[cfg(any(feature = "portable-atomic", target_has_atomic = "8"))]
impl<T: Element, S: heapless::storage::Storage> Container for &heapless::mpmc::QueueInner<T, S> {
    type Element = T;

    fn append(&mut self, element: T) -> Result<(), T> {
        self.enqueue(element)
    }
}

impl<T: Element, S: VecStorage<T> + ?Sized> Source for DequeInner<T, S> {
    fn take(&mut self) -> Option<Taken> {
        self.pop_front().map(Into::into)
    }
}

impl<T: Element> Source for spsc::Consumer<'_, T> {
    fn take(&mut self) -> Option<Taken> {
        self.dequeue().map(Into::into)
    }
}

#[cfg(any(feature = "portable-atomic", target_has_atomic = "8"))]
impl<T: Element, S: heapless::storage::Storage> Source for &heapless::mpmc::QueueInner<T, S> {
    fn take(&mut self) -> Option<Taken> {
        self.dequeue().map(Into::into)
    }
}

/// A container of `heapless` into which banks put their items, with a count of what found no room.
///
/// - **Containers:** `Vec`, `Deque`, the producer of `spsc`, `mpmc` by reference; of [`Taken`], [`Item`] or [`Event`].
/// - **Out:** `Deque`, the consumer of `spsc` and `mpmc` by reference are [`Source`]s; a `Vec` is one by way of
///   [`FromItems`](super::FromItems).
/// - **Losses:** a full container drops new items. With `Taken`, each element has the number of items lost since the
///   one before, so that decoders learn of the gap in its place; of losses after the last element they learn once
///   something is put again. With `Item` and `Event` they learn nothing, and temporal decoders drift.
/// - **`mpmc`:** each `Counted` counts its own; elements of other producers may come before the one with the count. If
///   an interrupt cuts into another operation, that queue may seem full or empty: an item that is put then is lost and
///   counted.
/// - **Cortex-M0:** all but `mpmc`, which needs compare-and-swap: the feature `portable-atomic` brings it, by critical
///   sections.
///
/// ```
/// use heapless::spsc::Queue;
/// use spikewire::{Bank, Counted, Source, Taken, Tick, temporal::TemporalContrast};
///
/// let mut queue = Queue::<Taken, 3>::new(); // for two elements
/// let (producer, mut consumer) = queue.split();
/// let mut events = Counted::new(producer);
/// let scheme = TemporalContrast::<i16>::new(9);
/// let mut bank = Bank::<_, 1>::new(&scheme);
/// for (micros, sample) in [0, 50, 100, 150, 200].into_iter().enumerate() {
///     bank.encode_into(Tick::from_micros(micros as u64), [sample], &mut events);
/// }
/// assert_eq!(events.lost(), 2);
/// assert_eq!([consumer.take(), consumer.take()].map(|taken| taken.map(|taken| taken.lost)), [Some(0); 2]);
/// bank.encode_into(Tick::from_micros(5), [0], &mut events);
/// assert_eq!(consumer.take().map(|taken| taken.lost), Some(2));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Counted<C> {
    container: C,
    /// Since the last element.
    pending: u32,
    lost: u32,
    left_out: u32,
}

impl<C: Container> Counted<C> {
    /// A container in which nothing was lost so far.
    pub const fn new(container: C) -> Self {
        Self { container, pending: 0, lost: 0, left_out: 0 }
    }

    /// How many items found no room; `u32::MAX` for that many or more.
    pub const fn lost(&self) -> u32 {
        self.lost
    }

    /// How many items the elements cannot hold: all but events, of [`Event`]s.
    pub const fn left_out(&self) -> u32 {
        self.left_out
    }

    /// The container, to take from it.
    pub const fn container(&mut self) -> &mut C {
        &mut self.container
    }
}

impl<C: Container> Put for Counted<C> {
    fn put(&mut self, item: Item) {
        let Some(element) = Element::of(Taken { lost: self.pending, item }) else {
            self.left_out = self.left_out.saturating_add(1);
            return;
        };
        if self.container.append(element).is_ok() {
            self.pending = 0;
        } else {
            self.pending = self.pending.saturating_add(1);
            self.lost = self.lost.saturating_add(1);
        }
    }
}

impl<C: Container> Put for &mut Counted<C> {
    fn put(&mut self, item: Item) {
        (**self).put(item);
    }
}
