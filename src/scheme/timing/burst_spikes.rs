//! The code of a sample as a burst of spikes at one interval.

use crate::{Code, NeuronSpike, Polarity};

/// The spikes of one sample: a number of them, from slot 0 on, at one interval, in slots below `N`.
///
/// Two bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BurstSpikes<const N: usize> {
    count: u8,
    interval: u8,
}

impl<const N: usize> BurstSpikes<N> {
    /// No spike.
    pub const SILENT: Self = Self { count: 0, interval: 0 };

    /// `count` spikes, `interval` slots apart. With fewer than two spikes the interval is ignored; with more the result
    /// is `None` if the interval is 0, or the last spike would fire after slot `N - 1`.
    pub const fn new(count: u8, interval: u8) -> Option<Self> {
        if count < 2 {
            return Some(Self { count, interval: 0 });
        }
        let last = (count as usize - 1) * interval as usize;
        if interval > 0 && last < N { Some(Self { count, interval }) } else { None }
    }

    /// How many spikes there are.
    pub const fn count(self) -> u8 {
        self.count
    }

    /// From one spike to the next, in slots; 0 below two spikes.
    pub const fn interval(self) -> u8 {
        self.interval
    }

    /// A burst without the checks of [`new`](Self::new).
    pub(super) const fn of([count, interval]: [u8; 2]) -> Self {
        Self { count, interval }
    }

    /// A number that rises with the value: with more spikes, or as many at a shorter interval.
    #[inline]
    pub(super) const fn rank(self) -> u16 {
        (self.count as u16) << 8 | (u8::MAX - self.interval) as u16
    }
}

impl<const N: usize> Code for BurstSpikes<N> {
    const NEURONS: usize = 1;
    const SLOTS: usize = N;

    fn firings(&self) -> impl Iterator<Item = NeuronSpike> {
        let interval = u16::from(self.interval);
        let slots = (0..u16::from(self.count)).map(move |spike| spike.wrapping_mul(interval));
        slots.map(|slot| NeuronSpike { neuron: 0, slot, polarity: Polarity::Up })
    }

    /// The spikes from slot 0 on at the interval of the first two, up to the first that is missing.
    fn assemble(firings: impl Iterator<Item = NeuronSpike>) -> Self {
        let mut fired = [false; N];
        for firing in firings.filter(|firing| firing.neuron == 0) {
            if let Some(fired) = fired.get_mut(usize::from(firing.slot)) {
                *fired = true;
            }
        }
        let Some((true, later)) = fired.split_first() else { return Self::SILENT };
        let Some(pause) = later.iter().position(|&fired| fired) else {
            return Self { count: 1, interval: 0 };
        };
        let interval = pause.wrapping_add(1);
        let mut count = 0_u8;
        let mut slot = 0_usize;
        while fired.get(slot) == Some(&true) && count < u8::MAX {
            count = count.wrapping_add(1);
            slot = slot.wrapping_add(interval);
        }
        Self { count, interval: interval as u8 }
    }
}
