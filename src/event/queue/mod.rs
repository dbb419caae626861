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

/// What becomes of an item for which a full queue has no room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Overflow {
    /// The oldest item makes room and is counted as lost: main sees what is new.
    DropOldest,
    /// The new item is counted as lost: main sees what came first.
    DropNewest,
    /// The new item goes back to the caller, and is counted as refused.
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
