//! Events back to values, channel by channel: the inverse of a bank.

use crate::error;
use crate::population::{Neuron, Volley};
use crate::spike::{Code, Firing, Polarity};
use crate::{ConfigError, Decoder, Event, Scheme, Spike, tick};

/// A code that can be put together from the neurons that fired in one time step.
///
/// A bank's own events give back its codes. A chip may also fire too often, or neurons that no encoder
/// would have fired together; each code says what it makes of that.
pub trait Assemble: Code {
    /// The code, from firings in any order. Neurons that the code has not are left out.
    fn assemble(firings: impl Iterator<Item = Firing>) -> Self;
}

/// The direction of most spikes; none if as many went up as down.
impl Assemble for Spike {
    fn assemble(firings: impl Iterator<Item = Firing>) -> Self {
        let balance =
            firings.filter(|firing| firing.neuron == 0).fold(0_i32, |balance, firing| match firing
                .polarity
            {
                Polarity::Up => balance.saturating_add(1),
                Polarity::Down => balance.saturating_sub(1),
            });
        match balance.signum() {
            1 => Self::Up,
            -1 => Self::Down,
            _ => Self::None,
        }
    }
}

/// The neuron that fired most often, the lowest of several.
impl<const M: usize> Assemble for Option<Neuron<M>> {
    fn assemble(firings: impl Iterator<Item = Firing>) -> Self {
        let mut counts = [0_u16; M];
        for firing in firings {
            if let Some(count) = counts.get_mut(usize::from(firing.neuron)) {
                *count = count.saturating_add(1);
            }
        }
        let most = counts.iter().copied().max().filter(|&most| most > 0)?;
        let winner = counts.iter().position(|&count| count == most)?;
        Neuron::new(winner as u16)
    }
}

/// Each neuron in the slot of its first spike: of the neighbours without a gap around the neuron that
/// fired first, the lowest of several.
impl<const M: usize, const N: usize> Assemble for Volley<M, N> {
    fn assemble(firings: impl Iterator<Item = Firing>) -> Self {
        const SILENT: u8 = u8::MAX;
        let mut slots = [SILENT; M];
        for Firing { neuron, slot, .. } in firings.filter(|firing| usize::from(firing.slot) < N) {
            if let Some(known) = slots.get_mut(usize::from(neuron)) {
                *known = slot.min(SILENT.into()).min((*known).into()) as u8;
            }
        }
        let earliest = slots.iter().copied().min().filter(|&slot| slot != SILENT);
        earliest
            .and_then(|earliest| {
                let winner = slots.iter().position(|&slot| slot == earliest)?;
                let (before, after) = slots.split_at_checked(winner)?;
                let left = before.iter().rev().take_while(|&&slot| slot != SILENT).count();
                let right = after.iter().take_while(|&&slot| slot != SILENT).count();
                let first = winner - left;
                Self::new(first as u16, slots.get(first..winner + right)?)
            })
            .unwrap_or(Self::EMPTY)
    }
}

/// `N` decoders of one kind side by side: the events of a time step in, a value of every channel out.
///
/// Addresses are those of a [`Bank`](crate::Bank): channel `c`, neuron `n` has the address
/// `c * NEURONS + n` from the first on. So are sub-timesteps. A chip's output neurons are addresses already.
///
/// - **Work:** one pass over the events for each channel.
/// - **Time:** events outside the time step belong to another: give this one only its own.
///
/// ```
/// use spikewire::{Event, Polarity, Readout, population::{Centres, Position}};
///
/// static CENTRES: Centres<f32, 5> = Centres::<f32, _>::checked([-2.0, -0.5, 0.0, 0.5, 2.0]);
/// const THRUST: Position<f32, 5> = Position::new(&CENTRES);
/// let mut readout = Readout::<_, 1>::new(THRUST);
///
/// // What a chip sent back in this time step: neuron 3 won.
/// let events = [3, 4, 3].map(|address| Event { tick: 0, address, polarity: Polarity::Up });
/// assert_eq!(readout.decode(0, &events), [0.5]);
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
    pub fn decode(&mut self, tick: u32, events: &[Event]) -> [D::Sample; N] {
        let slot_ticks = self.slot_ticks;
        let mut values = [D::Sample::default(); N];
        let mut first = self.first_address;
        for (decoder, value) in self.channels.iter_mut().zip(&mut values) {
            let firings = events.iter().filter_map(|event| {
                let since = tick::difference(event.tick, tick).max(0) as u32;
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
