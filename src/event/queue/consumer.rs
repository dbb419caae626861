//! The end of a queue at which main takes items.

use super::QueueView;
use crate::event::{AtMost, Event, Source, Taken};

/// Takes the items of a queue, oldest first. A queue has [one consumer](QueueView::consumer) at a time.
#[derive(Debug)]
pub struct Consumer<'a> {
    queue: &'a QueueView,
}

impl<'a> Consumer<'a> {
    pub(super) fn new(queue: &'a QueueView) -> Self {
        Self { queue }
    }

    /// The queue, for its counters.
    pub fn queue(&self) -> &'a QueueView {
        self.queue
    }

    /// The items that are in the queue now, as a source that ends even if interrupts go on pushing.
    pub fn waiting(&mut self) -> AtMost<&mut Self> {
        let items = self.queue.len();
        self.at_most(items)
    }

    /// Waits until there is an item to take, without polling: the push that brings it wakes the task.
    ///
    /// Dropping the future loses no item.
    #[cfg(feature = "async")]
    pub async fn wait(&mut self) {
        use core::task::Poll;
        core::future::poll_fn(|context| {
            if self.queue.is_ready_or_keeps(context.waker()) {
                Poll::Ready(())
            } else {
                Poll::Pending
            }
        })
        .await;
    }
}

impl Source for Consumer<'_> {
    #[inline]
    fn take(&mut self) -> Option<Taken> {
        self.queue.take()
    }

    #[inline]
    fn take_event(&mut self) -> Option<Event> {
        self.queue.take_event()
    }
}

impl Drop for Consumer<'_> {
    fn drop(&mut self) {
        self.queue.release_consumer();
    }
}
