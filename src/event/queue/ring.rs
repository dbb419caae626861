//! The queue for any number of interrupts: a ring of items, guarded by critical sections.

use core::cell::Cell;
use core::fmt;
use core::ops::Deref;
#[cfg(feature = "async")]
use core::task::Waker;

use critical_section::{CriticalSection, Mutex};

use super::slot::Slot;
use super::{Consumer, Overflow, Refused, ring_place};
use crate::event::{Event, Item, Put, Taken, Tick};

/// A queue of `N` items, shared between interrupts and main: events, keyframes and breaks in one order.
///
/// - **Any number of interrupts** [push](QueueView::push), nested ones too; one
///   [consumer](QueueView::consumer) takes.
/// - **Never blocks.** Each call masks interrupts while it copies one item.
/// - **Memory:** `12 N + 44` bytes on a 32-bit part, 8 more with the feature `async`.
/// - **Losses:** each item taken comes with the number of items lost before it. If items were lost after the last
///   one, that number comes with a [break](Item::Break). See also [`lost`](QueueView::lost) and
///   [`refused`](QueueView::refused).
///
/// It dereferences to a [`QueueView`], which has the methods and no capacity in its type.
///
/// ```
/// use spikewire::{Event, EventQueue, Overflow, Polarity, Source, Tick};
///
/// static EVENTS: EventQueue<2> = EventQueue::new(Overflow::DropOldest);
///
/// // In the interrupt:
/// for micros in [1, 2, 3] {
///     let tick = Tick::from_micros(micros);
///     EVENTS.push(Event { tick, address: 0, polarity: Polarity::Up })?;
/// }
/// // In main:
/// let mut events = EVENTS.consumer().expect("the only consumer");
/// let first = events.take().expect("two are left");
/// assert_eq!((first.lost, first.item.tick().micros()), (1, 2));
/// # Ok::<(), spikewire::Refused>(())
/// ```
///
/// A queue without room does not compile:
///
/// ```compile_fail
/// # use spikewire::{EventQueue, Overflow};
/// static EVENTS: EventQueue<0> = EventQueue::new(Overflow::DropOldest);
/// ```
pub struct EventQueue<const N: usize>(Queue<[Place; N]>);

/// A queue of any capacity, behind a reference. [`EventQueue`] dereferences to it.
pub type QueueView = Queue<[Place]>;

/// The common implementation of [`EventQueue`] and [`QueueView`].
pub struct Queue<C: ?Sized> {
    overflow: Overflow,
    state: Mutex<State>,
    /// The waker of the consumer that waits.
    #[cfg(feature = "async")]
    waker: Mutex<Cell<Option<Waker>>>,
    places: C,
}

/// Room for an item.
pub struct Place(Mutex<Cell<Slot>>);

struct State {
    /// The place of the oldest item, or the number of places for the first.
    head: Cell<usize>,
    /// The place of the next item, or the number of places for the first.
    tail: Cell<usize>,
    /// How many items there are, plus [`CLOSED`] while items have been lost after the last one.
    len: Cell<usize>,
    /// The most items that there were when one was taken.
    peak: Cell<usize>,
    /// How many items were lost after the last one in the queue, and the tick of the one lost last.
    behind: Cell<u32>,
    behind_tick: Cell<Tick>,
    /// Losses beyond the 255 that a slot can count.
    excess: Cell<u32>,
    lost: Cell<u32>,
    refused: Cell<u32>,
    has_consumer: Cell<bool>,
}

/// Added to the length, it makes the queue look full, so that a push leaves the usual path.
const CLOSED: usize = 1 << (usize::BITS - 1);

impl State {
    #[inline]
    fn len(&self) -> usize {
        self.len.get() & !CLOSED
    }
}

impl<const N: usize> EventQueue<N> {
    /// An empty queue, for a `static`.
    pub const fn new(overflow: Overflow) -> Self {
        const { assert!(N >= 1, "a queue has room for at least one item") };
        let state = State {
            head: Cell::new(0),
            tail: Cell::new(0),
            len: Cell::new(0),
            peak: Cell::new(0),
            behind: Cell::new(0),
            behind_tick: Cell::new(Tick::from_micros(0)),
            excess: Cell::new(0),
            lost: Cell::new(0),
            refused: Cell::new(0),
            has_consumer: Cell::new(false),
        };
        Self(Queue {
            overflow,
            state: Mutex::new(state),
            #[cfg(feature = "async")]
            waker: Mutex::new(Cell::new(None)),
            places: [const { Place(Mutex::new(Cell::new(Slot::EMPTY))) }; N],
        })
    }
}

impl<const N: usize> Deref for EventQueue<N> {
    type Target = QueueView;

    #[inline]
    fn deref(&self) -> &QueueView {
        &self.0
    }
}

impl<const N: usize> fmt::Debug for EventQueue<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&**self, f)
    }
}

impl fmt::Debug for QueueView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EventQueue")
            .field("overflow", &self.overflow)
            .field("capacity", &self.capacity())
            .field("len", &self.len())
            .field("lost", &self.lost())
            .finish_non_exhaustive()
    }
}

/// What became of the oldest item.
enum Removed {
    /// It is an event with no loss before it, and taken.
    Event(Event),
    /// There is none, nor a loss.
    Nothing,
    /// It is of another kind, or a loss comes first.
    NotYet,
}

/// The fate of an item that the queue refuses.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Refusal {
    /// The caller gets it back.
    Returns,
    /// The item is lost.
    Loses,
}

impl QueueView {
    /// Puts an item, such as an event, at the end.
    ///
    /// # Errors
    /// Returns an error if the queue is full and its policy is [`Overflow::Refuse`]; never under another policy.
    #[inline]
    pub fn push(&self, item: impl Into<Item>) -> Result<(), Refused> {
        let item = item.into();
        if self.add(item.into(), Refusal::Returns) { Ok(()) } else { Err(Refused(item)) }
    }

    /// The consumer; `None` while there is one already. After it is dropped there can be another.
    pub fn consumer(&self) -> Option<Consumer<'_>> {
        let had_one = self.with(|state| state.has_consumer.replace(true));
        (!had_one).then(|| Consumer::new(self))
    }

    /// Number of items that the queue has room for.
    pub const fn capacity(&self) -> usize {
        self.places.len()
    }

    /// Number of items in the queue.
    pub fn len(&self) -> usize {
        self.with(State::len)
    }

    /// Whether the queue is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of items dropped since the start, up to `u32::MAX`. [`Taken::lost`] counts those before each item.
    pub fn lost(&self) -> u32 {
        self.with(|state| state.lost.get())
    }

    /// Number of items refused since the start, up to `u32::MAX`.
    pub fn refused(&self) -> u32 {
        self.with(|state| state.refused.get())
    }

    /// The most items that the queue ever held: where none was lost, the capacity that is enough.
    pub fn peak(&self) -> usize {
        self.with(|state| state.peak.get().max(state.len()))
    }

    #[inline]
    fn with<R>(&self, act: impl FnOnce(&State) -> R) -> R {
        critical_section::with(|section| act(self.state.borrow(section)))
    }

    /// Adds an item of a bank. This is a call, as few samples give an event: with little code between its channels, a
    /// bank needs no loop over them.
    #[inline(never)]
    fn add_or_lose(&self, tick: Tick, bits: u32, rest: u32) {
        self.add(Slot::from_words((tick, bits, rest)), Refusal::Loses);
    }

    /// Adds an item, and returns whether the queue took it.
    #[inline]
    fn add(&self, slot: Slot, refusal: Refusal) -> bool {
        #[cfg_attr(not(feature = "async"), expect(unused_variables))]
        let (is_taken, waker) = critical_section::with(|section| {
            let is_taken = if self.state.borrow(section).len.get() < self.places.len() {
                self.append(section, slot);
                true
            } else {
                let (tick, bits, rest) = slot.words();
                self.add_past_loss(section, tick, bits, rest, refusal)
            };
            #[cfg(feature = "async")]
            let waker = self.waker.borrow(section).take();
            #[cfg(not(feature = "async"))]
            let waker = ();
            (is_taken, waker)
        });
        // Outside of the critical section, since it runs the executor's code.
        #[cfg(feature = "async")]
        if let Some(waker) = waker {
            waker.wake();
        }
        is_taken
    }

    /// Appends an item, for which there is room.
    #[inline]
    fn append(&self, section: CriticalSection<'_>, slot: Slot) {
        let state = self.state.borrow(section);
        // Where the capacity is known, this is less code than `ring_place`.
        let tail = state.tail.get();
        let tail = if tail < self.capacity() { tail } else { 0 };
        if let Some(Place(place)) = self.places.get(tail) {
            place.borrow(section).set(slot);
            state.tail.set(tail.wrapping_add(1));
            state.len.set(state.len.get().wrapping_add(1));
        }
    }

    /// The place at a head or tail, and the head or tail after it.
    #[inline]
    fn place<'a>(
        &'a self,
        section: CriticalSection<'a>,
        at: usize,
    ) -> Option<(&'a Cell<Slot>, usize)> {
        let (Place(place), next) = ring_place(&self.places, at)?;
        Some((place.borrow(section), next))
    }

    /// Adds an item where the queue is full, or where items were lost before it.
    #[cold]
    #[inline(never)]
    fn add_past_loss(
        &self,
        section: CriticalSection<'_>,
        tick: Tick,
        bits: u32,
        rest: u32,
        refusal: Refusal,
    ) -> bool {
        let slot = Slot::from_words((tick, bits, rest));
        let state = self.state.borrow(section);
        if state.len() < self.places.len() {
            state.len.set(state.len());
            self.append(section, with_loss(state, slot, state.behind.take()));
            return true;
        }
        match (self.overflow, refusal) {
            (Overflow::DropOldest, _) => {
                count(&state.lost);
                let dropped = self.oldest(section).map_or(0, |(oldest, next)| {
                    self.remove_oldest(section, next);
                    oldest.lost()
                });
                self.append(section, slot);
                // Losses before the dropped item come before the next one, which is the oldest now.
                if let Some((oldest, _)) = self.place(section, state.head.get()) {
                    oldest.set(with_loss(state, oldest.get(), u32::from(dropped) + 1));
                }
                true
            }
            (Overflow::Refuse, Refusal::Returns) => {
                count(&state.refused);
                false
            }
            (policy, _) => {
                if policy == Overflow::Refuse {
                    count(&state.refused);
                }
                count(&state.lost);
                count(&state.behind);
                state.behind_tick.set(slot.tick());
                state.len.set(state.len.get() | CLOSED);
                true
            }
        }
    }

    /// Takes the oldest item.
    #[inline]
    pub(super) fn take(&self) -> Option<Taken> {
        match critical_section::with(|section| self.remove_event(section)) {
            Removed::Event(event) => Some(Taken::whole(Item::Event(event))),
            Removed::Nothing => None,
            Removed::NotYet => self.take_apart(),
        }
    }

    /// Takes items up to and including the oldest event.
    #[inline]
    pub(super) fn take_event(&self) -> Option<Event> {
        match critical_section::with(|section| self.remove_event(section)) {
            Removed::Event(event) => Some(event),
            Removed::Nothing => None,
            Removed::NotYet => self.take_event_apart(),
        }
    }

    /// [`take_event`](Self::take_event) where the oldest item may be no event, or there may be no item.
    #[cold]
    #[inline(never)]
    fn take_event_apart(&self) -> Option<Event> {
        loop {
            if let Item::Event(event) = self.take_apart()?.item {
                return Some(event);
            }
        }
    }

    /// The oldest item, of any kind; a break if there is none and items were lost after the last one.
    #[cold]
    #[inline(never)]
    fn take_apart(&self) -> Option<Taken> {
        critical_section::with(|section| {
            let state = self.state.borrow(section);
            if let Some((slot, next)) = self.oldest(section) {
                self.remove_oldest(section, next);
                let excess = if slot.lost() == u8::MAX { state.excess.take() } else { 0 };
                let lost = u32::from(slot.lost()).saturating_add(excess);
                return Some(Taken { lost, item: slot.item() });
            }
            let lost = state.behind.take();
            state.len.set(0);
            (lost > 0).then(|| Taken { lost, item: Item::Break(state.behind_tick.get()) })
        })
    }

    /// Removes the oldest item if it is an event with no loss before it, as nearly all are.
    #[inline]
    fn remove_event(&self, section: CriticalSection<'_>) -> Removed {
        let state = self.state.borrow(section);
        let len = state.len.get();
        if len == 0 {
            return Removed::Nothing;
        }
        let Some((place, next)) = self.place(section, state.head.get()) else {
            return Removed::Nothing;
        };
        // A closed queue looks longer than any.
        let event = place.get().plain_event().filter(|_| len & CLOSED == 0);
        let Some(event) = event else { return Removed::NotYet };
        state.head.set(next);
        state.len.set(len.wrapping_sub(1));
        if len > state.peak.get() {
            state.peak.set(len);
        }
        Removed::Event(event)
    }

    /// The oldest item, and the head after it.
    #[inline]
    fn oldest(&self, section: CriticalSection<'_>) -> Option<(Slot, usize)> {
        let state = self.state.borrow(section);
        if state.len() == 0 {
            return None;
        }
        let (place, next) = self.place(section, state.head.get())?;
        Some((place.get(), next))
    }

    /// Removes the oldest item of a queue that has one, before this head.
    #[inline]
    fn remove_oldest(&self, section: CriticalSection<'_>, next: usize) {
        let state = self.state.borrow(section);
        let len = state.len();
        state.head.set(next);
        state.len.set(state.len.get().wrapping_sub(1));
        if len > state.peak.get() {
            state.peak.set(len);
        }
    }

    /// Allows another consumer.
    pub(super) fn release_consumer(&self) {
        self.with(|state| state.has_consumer.set(false));
    }

    /// Whether there is an item or a loss to take; otherwise keeps the waker.
    #[cfg(feature = "async")]
    pub(super) fn is_ready_or_keeps(&self, waker: &Waker) -> bool {
        let waker = waker.clone();
        let (is_ready, _before) = critical_section::with(|section| {
            let state = self.state.borrow(section);
            let is_ready = state.len.get() > 0;
            let kept = (!is_ready).then_some(waker);
            (is_ready, self.waker.borrow(section).replace(kept))
        });
        is_ready
    }
}

/// The slot with this many more losses before it.
fn with_loss(state: &State, slot: Slot, lost: u32) -> Slot {
    let sum = u32::from(slot.lost()).saturating_add(lost);
    let counted = sum.min(u8::MAX.into());
    state.excess.set(state.excess.get().saturating_add(sum - counted));
    slot.with_lost(counted as u8)
}

fn count(counter: &Cell<u32>) {
    counter.set(counter.get().saturating_add(1));
}

/// An item that is refused is lost, and counted as both.
impl Put for &QueueView {
    #[inline]
    fn put(&mut self, item: Item) {
        let (tick, bits, rest) = Slot::from(item).words();
        self.add_or_lose(tick, bits, rest);
    }
}

/// An item that is refused is lost, and counted as both.
impl<const N: usize> Put for &EventQueue<N> {
    #[inline]
    fn put(&mut self, item: Item) {
        let mut view: &QueueView = self;
        view.put(item);
    }
}
