//! Readout: the decoders of several channels, from address events to values.

use core::fmt;

use super::address::addressed;
use super::schemes::{CodeOf, DecoderStateOf, SampleOf, States};
use super::{Event, Schemes, Tick};
use crate::{Code, ConfigError, NeuronSpike, Scheme};

/// The decoders of `N` channels, which turn the events of a time step into a value for each channel: the inverse of
/// a [`Bank`](crate::Bank).
///
/// - **Addresses:** those of a bank: neuron `n` of channel `c` has the address `first + c * neurons + n`. The output
///   neurons of a chip count as addresses.
/// - **Codes:** all; [`Code::assemble`] says what becomes of neurons that no encoder fires together.
/// - **Memory:** the channels' states and 8 bytes, and 4 bytes for each reference to a scheme on a 32-bit part.
/// - **Work:** one pass over the events for each channel.
/// - **Time:** ticks are not checked: give each call only the events of its time step.
///
/// ```
/// use spikewire::{Event, Polarity, Readout, Tick, population::Position};
///
/// static THRUST: Position<f32, 5> = Position::new([-2.0, -0.5, 0.0, 0.5, 2.0]);
/// let mut readout = Readout::<_, 1>::new(&THRUST);
///
/// // What a chip sent back in this time step: neuron 3 won.
/// let tick = Tick::from_micros(1_000);
/// let events = [3, 4, 3].map(|address| Event { tick, address, polarity: Polarity::Up });
/// assert_eq!(readout.decode(tick, &events), [0.5]);
/// ```
pub struct Readout<T: Schemes<N>, const N: usize> {
    channels: T::Channels<DecoderStateOf<T, N>>,
    addresses: Addresses,
}

/// How an address and a tick give the channel, the neuron and the slot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Addresses {
    pub(crate) first: u16,
    /// The length of a sub-timestep in µs; 0 if all events of a sample have its tick.
    pub(crate) slot_ticks: u32,
}

impl Addresses {
    /// The first address of a channel of this many neurons.
    fn first_of(self, channel: usize, neurons: usize) -> u16 {
        self.first.wrapping_add(channel.wrapping_mul(neurons) as u16)
    }

    /// The events of a channel of this many neurons.
    pub(crate) fn events_of(
        self,
        channel: usize,
        neurons: usize,
        events: &[Event],
    ) -> impl Iterator<Item = &Event> {
        let first = self.first_of(channel, neurons);
        events.iter().filter(move |event| usize::from(event.address.wrapping_sub(first)) < neurons)
    }

    /// The code of a channel of this many neurons, from the events of a sample at this tick.
    pub(crate) fn code<C: Code>(
        self,
        channel: usize,
        neurons: usize,
        tick: Tick,
        events: &[Event],
    ) -> C {
        let first = self.first_of(channel, neurons);
        C::assemble(self.events_of(channel, neurons, events).filter_map(|event| {
            let since = event.tick.since(tick).max(0) as u32;
            let slot = since.checked_div(self.slot_ticks).unwrap_or(0);
            Some(NeuronSpike {
                neuron: event.address.checked_sub(first)?,
                slot: slot.min(u16::MAX.into()) as u16,
                polarity: event.polarity,
            })
        }))
    }
}

impl<'a, P: Scheme, const N: usize> Readout<&'a P, N> {
    /// A readout whose channels share one scheme.
    pub fn new(scheme: &'a P) -> Self {
        Self::with_schemes(scheme)
    }
}

impl<'a, P: Scheme, const N: usize> Readout<[&'a P; N], N> {
    /// A readout with a scheme for each channel.
    pub fn per_channel(schemes: [&'a P; N]) -> Self {
        Self::with_schemes(schemes)
    }
}

impl<T: Schemes<N>, const N: usize> Readout<T, N> {
    const ADDRESSES: usize = N * CodeOf::<T, N>::NEURONS;

    fn with_schemes(schemes: T) -> Self {
        const {
            assert!(N >= 1, "a readout has at least one channel");
            assert!(Self::ADDRESSES <= 1 << 16, "addresses have 16 bits");
        }
        let channels = schemes.channels(Scheme::decoder_state);
        Self { channels, addresses: Addresses { first: 0, slot_ticks: 0 } }
    }

    addressed! {
        /// Sets the first address, 0 by default; events of lower addresses are left out.
        addresses.first;
        /// Sets the length of a sub-timestep in microseconds. By default it is 0: all events of a sample have its tick.
        addresses.slot_ticks;
    }

    /// Decodes the events of one time step, which begins at `tick`, into a value for each channel.
    pub fn decode(&mut self, tick: Tick, events: &[Event]) -> [SampleOf<T, N>; N] {
        let mut values = [SampleOf::<T, N>::default(); N];
        let channels = T::each_mut(&mut self.channels).enumerate();
        for (value, (channel, (scheme, state))) in values.iter_mut().zip(channels) {
            let code = self.addresses.code(channel, scheme.neurons(), tick, events);
            *value = scheme.decode(state, code);
        }
        values
    }

    /// Sets a channel's decoder to a known value, such as the first sample. Ignores a channel that does not exist.
    pub fn resync(&mut self, channel: usize, value: SampleOf<T, N>) {
        if let Some((scheme, state)) = T::each_mut(&mut self.channels).nth(channel) {
            scheme.resync(state, value);
        }
    }

    /// Returns every decoder to its initial state.
    pub fn reset(&mut self) {
        let channels = T::each_mut(&mut self.channels);
        channels.for_each(|(scheme, state)| *state = scheme.decoder_state());
    }
}

impl<T: Schemes<N>, const N: usize> Clone for Readout<T, N>
where
    T::Channels<DecoderStateOf<T, N>>: Clone,
{
    fn clone(&self) -> Self {
        Self { channels: self.channels.clone(), addresses: self.addresses }
    }
}

impl<T: Schemes<N>, const N: usize> fmt::Debug for Readout<T, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut readout = f.debug_struct("Readout");
        readout.field("states", &States::<T, _, N>(&self.channels));
        readout.field("addresses", &self.addresses);
        readout.finish_non_exhaustive()
    }
}
