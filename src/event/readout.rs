//! Events back to values, channel by channel: the inverse of a bank.

use super::{Assemble, Event, Tick};
use crate::{Code, ConfigError, Decoder, Firing, Scheme, error};

/// `N` decoders of one kind side by side: the events of a time step in, a value of every channel out.
///
/// Addresses are those of a [`Bank`](crate::Bank): channel `c`, neuron `n` has the address
/// `c * NEURONS + n` from the first on. So are sub-timesteps. A chip's output neurons are addresses already.
///
/// - **Work:** one pass over the events for each channel.
/// - **Time:** events outside the time step belong to another: give this one only its own.
///
/// ```
/// use spikewire::{Event, Polarity, Readout, Tick, population::{Centres, Position}};
///
/// static CENTRES: Centres<f32, 5> = Centres::<f32, _>::checked([-2.0, -0.5, 0.0, 0.5, 2.0]);
/// const THRUST: Position<f32, 5> = Position::new(&CENTRES);
/// let mut readout = Readout::<_, 1>::new(THRUST);
///
/// // What a chip sent back in this time step: neuron 3 won.
/// let tick = Tick::from_micros(1_000);
/// let events = [3, 4, 3].map(|address| Event { tick, address, polarity: Polarity::Up });
/// assert_eq!(readout.decode(tick, &events), [0.5]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Readout<D, const N: usize> {
    channels: [D; N],
    first_address: u16,
    slot_ticks: u32,
}

impl<D: Decoder, const N: usize> Readout<D, N>
where
    D::Code: Assemble,
{
    /// The same scheme on every channel.
    pub fn new<P: Scheme<Decoder = D>>(scheme: P) -> Self {
        Self::from_schemes([scheme; N])
    }

    /// A scheme for each channel.
    pub fn from_schemes<P: Scheme<Decoder = D>>(schemes: [P; N]) -> Self {
        Self::from_decoders(schemes.map(Scheme::decoder))
    }

    /// Decoders of the caller's, each with parameters of its own.
    pub fn from_decoders(channels: [D; N]) -> Self {
        const {
            assert!(N >= 1, "a readout has at least one channel");
            assert!(N * D::Code::NEURONS <= 1 << 16, "addresses have 16 bits");
        }
        Self { channels, first_address: 0, slot_ticks: 0 }
    }

    /// The same with addresses from this one on, 0 unless told; events of lower ones are left out.
    ///
    /// # Errors
    /// The last address would be above 65 535.
    pub fn with_first_address(self, first_address: u16) -> Result<Self, ConfigError> {
        error::first_address(first_address, N * D::Code::NEURONS)?;
        Ok(Self { first_address, ..self })
    }

    /// The same with sub-timesteps of this many microseconds; 0 unless told.
    #[must_use]
    pub fn with_slot_ticks(self, slot_ticks: u32) -> Self {
        Self { slot_ticks, ..self }
    }

    /// Takes the events of one time step, which begins at `tick`, and gives every channel's value.
    pub fn decode(&mut self, tick: Tick, events: &[Event]) -> [D::Sample; N] {
        let slot_ticks = self.slot_ticks;
        let mut values = [D::Sample::default(); N];
        let mut first = self.first_address;
        for (decoder, value) in self.channels.iter_mut().zip(&mut values) {
            let firings = events.iter().filter_map(|event| {
                let since = event.tick.since(tick).max(0) as u32;
                let slot = since.checked_div(slot_ticks).unwrap_or(0);
                Some(Firing {
                    neuron: event.address.checked_sub(first)?,
                    slot: slot.min(u16::MAX.into()) as u16,
                    polarity: event.polarity,
                })
            });
            *value = decoder.decode(D::Code::assemble(firings));
            first = first.wrapping_add(D::Code::NEURONS as u16);
        }
        values
    }

    /// The decoders, to resynchronise them.
    pub fn channels(&mut self) -> &mut [D; N] {
        &mut self.channels
    }
}
