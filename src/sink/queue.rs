//! A bounded queue of events from an interrupt to main.

use core::cell::RefCell;

use critical_section::Mutex;
use heapless::Deque;

use crate::{Event, EventSource, Mark};

/// What becomes of an event for which a full queue has no room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Overflow {
    /// The oldest event makes room and is counted as lost: main sees what is new.
    DropOldest,
    /// The new event is counted as lost: main sees what came first.
    DropNewest,
    /// The new event goes back to the caller, and is counted as refused.
    Refuse,
}

/// A full queue refused this event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Refused(pub Event);

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the queue is full and refused the event of address {}", self.0.address)
    }
}

impl core::error::Error for Refused {}

/// `N` events, shared between interrupts and main.
///
/// - **Never blocks.** Each call holds off interrupts for one event's copy.
/// - **Memory:** `8 N + 36` bytes on a 32-bit part.
/// - **Nothing is dropped uncounted:** see [`lost`](Self::lost) and [`refused`](Self::refused). A
///   step decoder must be told of every loss; a link's transmitter takes the count and does so.
///
/// ```
/// use spikewire::{Event, Polarity, sink::{EventQueue, Overflow}};
///
/// static EVENTS: EventQueue<2> = EventQueue::new(Overflow::DropOldest);
///
/// // In the interrupt:
/// for tick in [1, 2, 3] {
///     EVENTS.push(Event { tick, address: 0, polarity: Polarity::Up })?;
/// }
/// // In main:
/// assert!(EVENTS.drain().into_iter().map(|event| event.tick).eq([2, 3]));
/// assert_eq!(EVENTS.lost(), 1);
/// # Ok::<(), spikewire::sink::Refused>(())
/// ```
///
/// A queue without room does not compile:
///
/// ```compile_fail
/// # use spikewire::sink::{EventQueue, Overflow};
/// static EVENTS: EventQueue<0> = EventQueue::new(Overflow::DropOldest);
/// ```
#[derive(Debug)]
pub struct EventQueue<const N: usize> {
    overflow: Overflow,
    shared: Mutex<RefCell<Shared<N>>>,
}

#[derive(Debug)]
struct Shared<const N: usize> {
    events: Deque<Event, N>,
    /// How many events have left it, by either end; wraps.
    taken: u32,
    lost: u32,
    refused: u32,
    peak: usize,
}

impl<const N: usize> EventQueue<N> {
    /// An empty queue, for a `static`.
    pub const fn new(overflow: Overflow) -> Self {
        const { assert!(N >= 1, "a queue has room for at least one event") };
        let shared = Shared { events: Deque::new(), taken: 0, lost: 0, refused: 0, peak: 0 };
        Self { overflow, shared: Mutex::new(RefCell::new(shared)) }
    }

    /// Puts an event at the end.
    ///
    /// # Errors
    /// The queue is full and its policy is [`Overflow::Refuse`]; never under another policy.
    pub fn push(&self, event: Event) -> Result<(), Refused> {
        // No borrow outlives a critical section, so there is always one to be had.
        self.with(|shared| shared.push(event, self.overflow)).unwrap_or(Err(Refused(event)))
    }

    /// The same for one who takes nothing back: an event that is refused is lost, and counted as such.
    #[inline]
    pub(crate) fn put(&self, event: Event) {
        self.with(|shared| {
            if shared.push(event, self.overflow).is_err() {
                shared.lost = shared.lost.saturating_add(1);
            }
        });
    }

    /// Takes the oldest event.
    pub fn pop(&self) -> Option<Event> {
        self.with(Shared::pop).flatten()
    }

    /// Takes the events that are in the queue now, oldest first, as an iterator or a source.
    ///
    /// Interrupts may push meanwhile: at most as many events come out as were in when it was
    /// called, so that it ends even under a storm.
    pub fn drain(&self) -> Drain<'_, N> {
        Drain { queue: self, left: self.len() }
    }

    /// How many events it holds.
    pub fn len(&self) -> usize {
        self.with(|shared| shared.events.len()).unwrap_or_default()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many events found no room and were dropped; stays at `u32::MAX` once there.
    pub fn lost(&self) -> u32 {
        self.with(|shared| shared.lost).unwrap_or_default()
    }

    /// Where it stands, for a keyframe that comes after the events pushed so far.
    pub fn mark(&self) -> Mark {
        self.with(|shared| Mark {
            lost: shared.lost,
            place: Some(shared.taken.wrapping_add(shared.events.len() as u32)),
        })
        .unwrap_or_default()
    }

    /// How often an event went back to the caller; stays at `u32::MAX` once there.
    pub fn refused(&self) -> u32 {
        self.with(|shared| shared.refused).unwrap_or_default()
    }

    /// The most events it ever held, to choose `N` by.
    pub fn peak(&self) -> usize {
        self.with(|shared| shared.peak).unwrap_or_default()
    }

    fn with<R>(&self, act: impl FnOnce(&mut Shared<N>) -> R) -> Option<R> {
        critical_section::with(|section| {
            let mut shared = self.shared.borrow(section).try_borrow_mut().ok()?;
            Some(act(&mut shared))
        })
    }
}

impl<const N: usize> Shared<N> {
    fn push(&mut self, event: Event, overflow: Overflow) -> Result<(), Refused> {
        if self.events.is_full() {
            match overflow {
                Overflow::DropOldest => {
                    self.pop();
                    self.lost = self.lost.saturating_add(1);
                }
                Overflow::DropNewest => {
                    self.lost = self.lost.saturating_add(1);
                    return Ok(());
                }
                Overflow::Refuse => {
                    self.refused = self.refused.saturating_add(1);
                    return Err(Refused(event));
                }
            }
        }
        let pushed = self.events.push_back(event).map_err(Refused);
        self.peak = self.peak.max(self.events.len());
        pushed
    }

    fn pop(&mut self) -> Option<Event> {
        let event = self.events.pop_front()?;
        self.taken = self.taken.wrapping_add(1);
        Some(event)
    }
}

/// The events of a queue, taken one by one; see [`EventQueue::drain`].
#[derive(Debug)]
pub struct Drain<'a, const N: usize> {
    queue: &'a EventQueue<N>,
    left: usize,
}

impl<const N: usize> Drain<'_, N> {
    fn pop(&mut self) -> Option<Event> {
        self.left = self.left.checked_sub(1)?;
        self.queue.pop()
    }
}

impl<'a, const N: usize> IntoIterator for Drain<'a, N> {
    type Item = Event;
    type IntoIter = Drained<'a, N>;

    fn into_iter(self) -> Drained<'a, N> {
        Drained(self)
    }
}

/// The iterator of a [`Drain`]. For a link take the `Drain` itself, which tells what the queue lost.
#[derive(Debug)]
pub struct Drained<'a, const N: usize>(Drain<'a, N>);

impl<const N: usize> Iterator for Drained<'_, N> {
    type Item = Event;

    fn next(&mut self) -> Option<Event> {
        self.0.pop()
    }
}

macro_rules! drain_is_source {
    ($(#[$documentation:meta] $drain:ty),*) => {$(
        #[$documentation]
        impl<const N: usize> EventSource for $drain {
            fn next_event(&mut self) -> Option<Event> {
                self.pop()
            }

            fn lost(&self) -> u32 {
                self.queue.lost()
            }

            fn place(&self) -> Option<u32> {
                EventSource::place(&self.queue)
            }
        }
    )*};
}
drain_is_source! {
    /// A sink takes `EVENTS.drain()`, and no more than is there now.
    Drain<'_, N>,
    /// For several frames from one drain.
    &mut Drain<'_, N>
}

/// A sink takes `&EVENTS`.
impl<const N: usize> EventSource for &EventQueue<N> {
    fn next_event(&mut self) -> Option<Event> {
        self.pop()
    }

    fn lost(&self) -> u32 {
        EventQueue::lost(self)
    }

    fn place(&self) -> Option<u32> {
        self.with(|shared| shared.taken)
    }
}
