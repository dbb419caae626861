//! Sources: what links, sinks and chips take their items from.

use super::{Event, Item, Taken};

/// A source of items in their order: the consumer of a queue, or an adapter over an iterator.
pub trait Source {
    /// Takes the next item, with the number of items lost before it; `None` if there is no item now.
    fn take(&mut self) -> Option<Taken>;

    /// Takes items up to and including the next event, and returns that event: for users that need no keyframes.
    #[inline]
    fn take_event(&mut self) -> Option<Event> {
        loop {
            if let Item::Event(event) = self.take()?.item {
                return Some(event);
            }
        }
    }

    /// A source that ends after this many items, even if a queue is filled again meanwhile.
    fn at_most(self, items: usize) -> AtMost<Self>
    where
        Self: Sized,
    {
        AtMost { source: self, left: items }
    }
}

impl<S: Source + ?Sized> Source for &mut S {
    fn take(&mut self) -> Option<Taken> {
        (**self).take()
    }
}

/// The first items of a source; see [`Source::at_most`].
#[derive(Clone, Copy, Debug)]
pub struct AtMost<S> {
    source: S,
    left: usize,
}

impl<S: Source> Source for AtMost<S> {
    fn take(&mut self) -> Option<Taken> {
        self.left = self.left.checked_sub(1)?;
        self.source.take()
    }
}

/// An iterator of events as a source without losses.
///
/// ```
/// use spikewire::{Event, FromEvents, Polarity, Source, Tick};
///
/// let event = Event { tick: Tick::from_micros(5), address: 0, polarity: Polarity::Up };
/// let mut source = FromEvents([event; 2].into_iter());
/// assert_eq!(source.take_event(), Some(event));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FromEvents<I>(pub I);

impl<I: Iterator<Item = Event>> Source for FromEvents<I> {
    fn take(&mut self) -> Option<Taken> {
        self.0.next().map(|event| Taken::whole(Item::Event(event)))
    }
}

/// An iterator of items, each of which may tell how many were [lost before it](Taken), as a source.
#[derive(Clone, Copy, Debug)]
pub struct FromItems<I>(pub I);

impl<I: Iterator<Item: Into<Taken>>> Source for FromItems<I> {
    fn take(&mut self) -> Option<Taken> {
        self.0.next().map(Into::into)
    }
}
