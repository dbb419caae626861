//! Every loss, accounted for at the item that follows it.

use spikewire::{Item, Taken};

use crate::{
    check::ensure,
    source::{SOURCES, read},
};

/// What main has taken. The numbers of a source's events tell which of them are missing; the queue tells how many
/// are missing of both before each item. The two must agree at every item.
#[derive(Default)]
pub struct Account {
    of: [OfSource; 2],
    /// What the queue has told as lost.
    lost: u32,
}

#[derive(Default)]
struct OfSource {
    taken: u32,
    /// The number that its next event has at least.
    next: u32,
    /// How many of its events were told as lost, at the last event of the other.
    told: u32,
}

impl OfSource {
    /// How many events are missing before the last one that was taken.
    fn missing(&self) -> u32 {
        self.next - self.taken
    }
}

impl Account {
    pub fn take(&mut self, Taken { lost, item }: Taken) -> Result<(), &'static str> {
        self.lost += lost;
        match item {
            Item::Break(_) => ensure(lost > 0, "nothing was lost before a break"),
            Item::Keyframe(_) | Item::Heartbeat { .. } => {
                Err("a keyframe or heartbeat that nobody pushed")
            }
            Item::Event(event) => {
                let (source, number) = read(event).ok_or("an event is torn")?;
                let [upper, lower] = &mut self.of;
                let (own, other) = if source == 0 { (upper, lower) } else { (lower, upper) };
                ensure(number >= own.next, "an event is out of order, or came twice")?;
                own.next = number + 1;
                own.taken += 1;
                ensure(own.told <= own.missing(), "a loss was told that was none")?;
                // All of its own losses lie before this event: the others told are the other's.
                other.told = self.lost.checked_sub(own.missing()).ok_or("a loss is told late")?;
                ensure(other.told >= other.missing(), "a loss is told late")
            }
        }
    }

    /// At the end, when nothing is left: every event was taken, lost or refused.
    pub fn close(&self, lost: u32) -> Result<(), &'static str> {
        let kept: u32 = SOURCES.iter().map(|source| source.kept()).sum();
        ensure(kept == self.taken() + lost, "an event is not accounted for")?;
        ensure(self.lost == lost, "a loss is counted but not told, or told but not counted")
    }

    pub fn taken(&self) -> u32 {
        self.of.iter().map(|source| source.taken).sum()
    }
}
