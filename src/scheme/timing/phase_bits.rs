//! The code of a sample as the digits of its value.

use crate::{Code, NeuronSpike, Polarity};

/// The spikes of one sample in up to `K` slots: one for each binary digit that is 1, the highest first.
///
/// Two bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PhaseBits<const K: usize>(u16);

impl<const K: usize> PhaseBits<K> {
    /// No spike.
    pub const SILENT: Self = Self(0);

    /// The code of these digits; only the lowest `K` are kept.
    pub const fn new(digits: u16) -> Self {
        Self(if K < 16 { digits & ((1 << K) - 1) } else { digits })
    }

    /// The digits: slot `t` is bit `K - 1 - t`.
    pub const fn digits(self) -> u16 {
        self.0
    }
}

impl<const K: usize> Code for PhaseBits<K> {
    const NEURONS: usize = 1;
    const SLOTS: usize = K;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        let digits = self.0.reverse_bits() >> (16_usize.saturating_sub(K) & 15);
        let fired = (0..K as u16).filter(move |&slot| digits >> (slot & 15) & 1 == 1);
        fired.map(|slot| NeuronSpike { neuron: 0, slot, polarity: Polarity::Up })
    }

    /// A digit is 1 where a spike fired in its slot, once or more often.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let slots = firings.filter(|firing| firing.neuron == 0).map(|firing| firing.slot.into());
        let digits = slots.filter_map(|slot: usize| (K - 1).checked_sub(slot));
        Self::new(digits.fold(0, |digits, digit| digits | 1 << (digit & 15)))
    }
}
