//! Networks: chains of layers.

use crate::checksum::Checksum;
use core::fmt::Debug;
use spikewire::{Event, Tick};

/// A network: a layer, or a chain of layers. Its parameters are references to data in flash.
pub trait Network: Copy {
    /// Type of the input of a step: `[u16]`, the numbers of the inputs that fired, or a value for each input.
    type Input: ?Sized;
    /// Type of the state between steps.
    type State: State;
    /// Number of inputs.
    const INPUTS: usize;
    /// Number of neurons in the last layer.
    const OUTPUTS: usize;

    /// Returns a state at rest: all potentials and currents 0, and nothing fired. The state belongs to this network, and
    /// to its copies, which have the same weights and neurons.
    fn state(&self) -> Self::State;

    /// Runs a step through all layers, and returns the neurons of the last layer that fired, in rising order. Inputs
    /// that the network does not have, and values that are not finite, are left out and [counted](State::rejected). The
    /// state of another network is counted too; it is at rest before the step, and belongs to this network from then on.
    fn step<'s>(&self, state: &'s mut Self::State, input: &Self::Input) -> &'s [u16];

    /// Returns a checksum over all weights and neurons as they are in memory. A change of bits within one number always
    /// changes it: a firmware compares it with the one that it had, before arming.
    fn checksum(&self) -> u32;
}

/// The state of a network.
pub trait State: Copy + Debug {
    /// The type of potentials.
    type Value;

    /// Returns the neurons of the last layer that fired in the last step, in rising order.
    fn spikes(&self) -> &[u16];

    /// Returns the potentials of the last layer, in the units of its weights.
    fn values(&self) -> &[Self::Value];

    /// Returns the number of inputs that were left out: spikes of inputs that do not exist, and values that are not
    /// finite or above ±10⁶; and how often a layer was given the state of another one.
    fn rejected(&self) -> u32;

    /// Returns how often a potential or current left the range of its integer type, and was clamped.
    fn saturated(&self) -> u32;

    /// Returns the spikes of the last step as events for a queue, a link, a chip or a [`Readout`](spikewire::Readout).
    /// The first neuron has the address `first_address`. Addresses above 65 535 are left out.
    fn events(&self, tick: Tick, first_address: u16) -> impl Iterator<Item = Event> {
        crate::spikes::events(self.spikes(), tick, first_address)
    }
}

/// A network followed by another, which takes its spikes in the same step.
#[derive(Clone, Copy, Debug)]
pub struct Then<A, B> {
    first: A,
    next: B,
}

/// The state of a network followed by another.
#[derive(Clone, Copy, Debug)]
pub struct ThenState<A, B> {
    /// State of the first network.
    pub first: A,
    /// State of the network that follows.
    pub next: B,
}

impl<A: Network, B: Network<Input = [u16]>> Then<A, B> {
    pub(crate) const fn new(first: A, next: B) -> Self {
        const { assert!(A::OUTPUTS == B::INPUTS, "a layer has an input for each neuron before it") };
        Self { first, next }
    }

    /// Returns a network of these layers, followed by another network.
    pub const fn then<C: Network<Input = [u16]>>(self, next: C) -> Then<Self, C> {
        Then::new(self, next)
    }
}

impl<A: Network, B: Network<Input = [u16]>> Network for Then<A, B> {
    type Input = A::Input;
    type State = ThenState<A::State, B::State>;
    const INPUTS: usize = A::INPUTS;
    const OUTPUTS: usize = B::OUTPUTS;

    fn state(&self) -> Self::State {
        ThenState { first: self.first.state(), next: self.next.state() }
    }

    #[inline]
    fn step<'s>(&self, state: &'s mut Self::State, input: &A::Input) -> &'s [u16] {
        let spikes = self.first.step(&mut state.first, input);
        self.next.step(&mut state.next, spikes)
    }

    fn checksum(&self) -> u32 {
        let mut sum = Checksum::new();
        sum.add(self.first.checksum());
        sum.add(self.next.checksum());
        sum.end()
    }
}

impl<A: State, B: State> State for ThenState<A, B> {
    type Value = B::Value;

    fn spikes(&self) -> &[u16] {
        self.next.spikes()
    }

    fn values(&self) -> &[B::Value] {
        self.next.values()
    }

    fn rejected(&self) -> u32 {
        self.first.rejected().saturating_add(self.next.rejected())
    }

    fn saturated(&self) -> u32 {
        self.first.saturated().saturating_add(self.next.saturated())
    }
}
