//! Codes from the neurons that fired in one time step.

use crate::population::{Neuron, Volley};
use crate::{Code, Firing, Polarity, Spike};

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
        const SILENT: u16 = u16::MAX;
        let mut slots = [SILENT; M];
        for Firing { neuron, slot, .. } in firings.filter(|firing| usize::from(firing.slot) < N) {
            if let Some(known) = slots.get_mut(usize::from(neuron)) {
                *known = slot.min(*known);
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
                let slots = slots.map(|slot| slot as u8); // below N, which is at most 256
                Self::new(first as u16, slots.get(first..winner + right)?)
            })
            .unwrap_or(Self::EMPTY)
    }
}
