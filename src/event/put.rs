//! Where a bank puts its items.

use super::Item;

/// Takes items in an interrupt: the end of a queue that is pushed to.
pub trait Put {
    /// Puts an item at the end; one that finds no room is lost and counted.
    fn put(&mut self, item: Item);
}
