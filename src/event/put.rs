//! The end of a queue into which a bank puts its items, and a fork to two queues.

use super::Item;

/// The end of a queue at which an interrupt puts items.
pub trait Put {
    /// Appends an item; an item that finds no room is lost and counted.
    fn put(&mut self, item: Item);
}

/// A fork: every item goes to both, first to the first. A queue has one consumer, so that a chip and a link that share a bank
/// have a queue each; each counts its own losses.
///
/// ```
/// # #[cfg(feature = "queue")] {
/// use spikewire::{Bank, EventQueue, Overflow, Source, Tick, temporal::StepForward};
///
/// static RATE: StepForward<f32> = StepForward::new(0.1);
/// static TO_LINK: EventQueue<64> = EventQueue::new(Overflow::DropOldest);
/// static TO_CHIP: EventQueue<64> = EventQueue::new(Overflow::DropOldest);
///
/// let mut bank = Bank::<_, 3>::new(&RATE);
/// for (millis, rates) in [[0.0; 3], [0.2, 0.0, -0.3]].into_iter().enumerate() {
///     bank.encode_into(Tick::from_micros(1_000 * millis as u64), rates, (&TO_LINK, &TO_CHIP));
/// }
/// for queue in [&TO_LINK, &TO_CHIP] {
///     let mut events = queue.consumer().expect("the only consumer");
///     assert_eq!(core::iter::from_fn(|| events.take_event()).count(), 2);
/// }
/// # }
/// ```
impl<A: Put, B: Put> Put for (A, B) {
    fn put(&mut self, item: Item) {
        self.0.put(item);
        self.1.put(item);
    }
}
