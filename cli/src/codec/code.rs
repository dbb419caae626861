//! From the events of one sample back to the code that a decoder takes.

use super::Event;
use spikewire::population::{Neuron, Pattern, Volley};
use spikewire::{Code, Spike};

/// Takes the events of this sample from the front of the list.
pub(super) fn leading<'a>(events: &mut &'a [Event], sample: u64) -> &'a [Event] {
    let count = events.iter().take_while(|event| event.sample == sample).count();
    let (now, later) = events.split_at(count);
    *events = later;
    now
}

/// A code that can be told from its events.
pub(super) trait FromEvents: Code {
    /// The code with these events, which are those of one sample, or `None` if there is no such code.
    fn from_events(events: &[Event]) -> Option<Self>;
}

impl FromEvents for Spike {
    fn from_events(events: &[Event]) -> Option<Self> {
        match events {
            [] => Some(Self::None),
            [event] => Some(event.polarity.into()),
            _ => None,
        }
    }
}

impl<const M: usize> FromEvents for Option<Neuron<M>> {
    fn from_events(events: &[Event]) -> Option<Self> {
        match events {
            [] => Some(None),
            [event] => Neuron::new(event.neuron).map(Some),
            _ => None,
        }
    }
}

impl<const M: usize, const N: usize> FromEvents for Volley<M, N> {
    fn from_events(events: &[Event]) -> Option<Self> {
        let mut slots = [0; M];
        let (first, slots) = neighbours(events, &mut slots)?;
        Self::new(first, slots)
    }
}

/// The first neuron, and the slots of it and its neighbours. The events come by slot.
fn neighbours<'a>(events: &[Event], slots: &'a mut [u8]) -> Option<(u16, &'a [u8])> {
    let first = events.iter().map(|event| event.neuron).min().unwrap_or(0);
    let slots = slots.get_mut(..events.len())?;
    for (neuron, slot) in (first..).zip(slots.iter_mut()) {
        let event = events.iter().find(|event| event.neuron == neuron)?;
        *slot = u8::try_from(event.slot).ok()?;
    }
    Some((first, slots))
}

impl<const M: usize> FromEvents for Pattern<M> {
    fn from_events(events: &[Event]) -> Option<Self> {
        let mut neurons = events.iter().map(|event| event.neuron);
        Self::new(&mut neurons as &mut dyn Iterator<Item = u16>)
    }
}
