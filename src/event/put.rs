//! The end of a queue into which a bank puts its items.

use super::Item;

/// The end of a queue at which an interrupt puts items.
pub trait Put {
    /// Appends an item; an item that finds no room is lost and counted.
    fn put(&mut self, item: Item);
}
