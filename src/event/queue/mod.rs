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
