//! A list of the outputs that a chip sends in one time step, as events.

use spikewire::Polarity;
use spikewire::{Event, Tick};

/// A list of up to `N` events of one time step. It collects the outputs of a chip for a
/// [`Readout`](spikewire::Readout).
///
/// **Memory:** `8 N + 8` bytes on a 32-bit part.
///
/// ```
/// use spikewire::{Readout, Tick, population::Position};
/// use spikewire_chips::{Describe, Inputs, Network, Spikes, TinyOdinInput, TinyOdinNeuron};
///
/// static THRUST: Position<f32, 5> = Position::new([-2.0, -0.5, 0.0, 0.5, 2.0]);
/// static NETWORK: Network<TinyOdinInput, 1, 8, 5> = Network {
///     neurons: [TinyOdinNeuron { threshold: 4, ..TinyOdinNeuron::REST }; 8],
///     inputs: Inputs::Virtual([(0, 5)]),
///     recurrent: &[],
///     outputs: [3, 4, 5, 6, 7],
/// };
/// let mut readout = Readout::<_, 1>::new(&THRUST);
/// let tick = Tick::from_micros(1_000);
///
/// let mut spikes = Spikes::<16>::new();
/// // In flight, `chip.poll(NETWORK.answers(…))?` passes the neurons that fire.
/// // Here neurons 1 and 6 fire. Neuron 1 is not an output, and is ignored.
/// [1, 6].map(NETWORK.answers(tick, |event| spikes.push(event)));
/// let [value] = readout.decode(tick, spikes.as_slice());
/// assert_eq!(value, 0.5);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Spikes<const N: usize> {
    events: [Event; N],
    len: usize,
    lost: u32,
}

impl<const N: usize> Default for Spikes<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Spikes<N> {
    /// Makes an empty list.
    pub const fn new() -> Self {
        const NONE: Event =
            Event { tick: Tick::from_micros(0), address: 0, polarity: Polarity::Up };
        Self { events: [NONE; N], len: 0, lost: 0 }
    }

    /// Appends an event. If the list is full, the event is lost and counted.
    pub fn push(&mut self, event: Event) {
        if let Some(slot) = self.events.get_mut(self.len) {
            *slot = event;
            self.len += 1;
        } else {
            self.lost = self.lost.saturating_add(1);
        }
    }

    /// Returns the events, in the order in which they were appended.
    pub fn as_slice(&self) -> &[Event] {
        self.events.get(..self.len).unwrap_or_default()
    }

    /// Empties the list, for the next time step.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Returns the number of events that were lost because the list was full.
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}
