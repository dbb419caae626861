//! A bounded queue of events from an interrupt to main.

use core::cell::RefCell;

use critical_section::Mutex;
use heapless::Deque;

use crate::{Event, EventSource};

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
/// - **Memory:** `8 N + 28` bytes on a 32-bit part.
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
/// assert!(EVENTS.drain().map(|event| event.tick).eq([2, 3]));
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
    lost: u32,
    refused: u32,
    peak: usize,
}

impl<const N: usize> EventQueue<N> {
    /// An empty queue, for a `static`.
    pub const fn new(overflow: Overflow) -> Self {
        const { assert!(N >= 1, "a queue has room for at least one event") };
        let shared = Shared { events: Deque::new(), lost: 0, refused: 0, peak: 0 };
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
        self.with(|shared| shared.events.pop_front()).flatten()
    }

    /// Takes the events that are in the queue now, oldest first.
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
                    self.events.pop_front();
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
}

/// The events of a queue, taken one by one; see [`EventQueue::drain`].
#[derive(Debug)]
pub struct Drain<'a, const N: usize> {
    queue: &'a EventQueue<N>,
    left: usize,
}

impl<const N: usize> Iterator for Drain<'_, N> {
    type Item = Event;

    fn next(&mut self) -> Option<Event> {
        self.left = self.left.checked_sub(1)?;
        self.queue.pop()
    }
}

/// A sink takes `&EVENTS`.
impl<const N: usize> EventSource for &EventQueue<N> {
    fn next_event(&mut self) -> Option<Event> {
        self.pop()
    }

    fn lost(&self) -> u32 {
        EventQueue::lost(self)
    }
}
