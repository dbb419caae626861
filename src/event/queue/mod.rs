//! Bounded queues of items from an interrupt to main.

mod consumer;
mod ring;
mod slot;
mod spsc;

use core::fmt;

use super::Item;

pub use consumer::Consumer;
pub use ring::{EventQueue, Queue, QueueView};
pub use spsc::{SpscConsumer, SpscProducer, SpscQueue};

/// The policy of a full queue for a new item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Overflow {
    /// Drops the oldest item and counts it as lost: main gets the newest items.
    DropOldest,
    /// Drops the new item and counts it as lost: main gets the oldest items.
    DropNewest,
    /// Returns the new item to the caller and counts it as refused.
    Refuse,
}

/// A full queue refused this item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Refused(pub Item);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the queue is full and refused the item of tick {}", self.0.tick().micros())
    }
}

impl core::error::Error for Refused {}

/// The place of a ring at this number, and the number of the place after it. The first place has its own number 0 and
/// that after the last, so that one comparison guards the access and finds the end of the ring.
#[inline]
fn ring_place<T>(places: &[T], at: usize) -> Option<(&T, usize)> {
    match places.get(at) {
        Some(place) => Some((place, at.wrapping_add(1))),
        None => first_place(places),
    }
}

#[cold]
#[inline]
fn first_place<T>(places: &[T]) -> Option<(&T, usize)> {
    places.first().map(|place| (place, 1))
}
