//! The decoder that the rate codes with a filter share: it adds up the filters of the spikes.

use super::filtered::Filtered;
use crate::num::Residual;
use crate::{Sample, Spike};

/// The state of the decoder of a rate code with a filter: what past spikes add to the next `F` values.
///
/// `y[i] = shift + sum over j of s[i-j] h[j]`.
///
/// - **Range:** the sum takes the oldest spike first, one rounding each in `f32`; fixed point is
///   exact and saturates at the type's ends.
/// - **Work:** one addition a tap for a sample with a spike, two operations for a sample without.
/// - **Memory:** `4 F + 4` bytes in `f32`.
/// - **Loss:** a lost spike is forgotten after `F` samples, so a rate decoder needs no keyframes.
///
/// [`Spike::Down`], which no rate code emits, decodes as [`Spike::None`].
///
/// Source: paper, section II-B.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct RateDecoderState<S: Sample, const F: usize> {
    /// A ring of sums, of which the one in slot `next` belongs to the next value.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    pending: [S::Residual; F],
    next: u16,
}

impl<S: Sample, const F: usize> RateDecoderState<S, F> {
    pub(super) const START: Self = Self { pending: [S::Residual::ZERO; F], next: 0 };

    pub(super) fn fits(&self) -> bool {
        usize::from(self.next) < F
    }

    #[inline(always)]
    pub(super) fn decode(&mut self, filtered: &Filtered<S, F>, spike: Spike) -> S {
        let taps = |slot| filtered.taps.starting_at(slot).as_slice();
        filtered.shift.restore(decode(&mut self.pending, &mut self.next, taps, spike))
    }
}

/// Takes the sum of the next value out of the slot `next` of a ring, which is in an array or on the heap. `taps`
/// returns the taps rotated to a slot.
#[inline(always)]
pub(super) fn decode<'t, S: Sample>(
    pending: &mut [S::Residual],
    next: &mut u16,
    taps: impl FnOnce(usize) -> &'t [S],
    spike: Spike,
) -> S::Residual {
    let slot = usize::from(*next).min(pending.len().wrapping_sub(1));
    let after = slot.wrapping_add(1);
    *next = if after < pending.len() { after as u16 } else { 0 };
    if spike == Spike::Up {
        for (sum, tap) in pending.iter_mut().zip(taps(slot)) {
            *sum = sum.plus(tap.widen());
        }
    }
    let mut sum = S::Residual::ZERO;
    if let Some(pending) = pending.get_mut(slot) {
        core::mem::swap(&mut sum, pending);
    }
    sum
}

/// The decoding half of a rate code's [`Scheme`](crate::Scheme), with a field `filtered`.
macro_rules! decode_rate {
    () => {
        fn decoder_state(&self) -> RateDecoderState<S, F> {
            RateDecoderState::START
        }

        #[inline]
        fn decode(&self, state: &mut RateDecoderState<S, F>, spike: Spike) -> S {
            state.decode(&self.filtered, spike)
        }

        #[inline]
        fn decode_slice(
            &self,
            state: &mut RateDecoderState<S, F>,
            spikes: &[impl Copy + Into<Spike>],
            values: &mut [S],
        ) -> usize {
            for (value, &spike) in values.iter_mut().zip(spikes) {
                *value = state.decode(&self.filtered, spike.into());
            }
            spikes.len().min(values.len())
        }

        fn fits_decoder(&self, state: &RateDecoderState<S, F>) -> bool {
            state.fits()
        }

        /// Forgets past spikes. The value is unused, since the values of a rate code come from spikes alone.
        fn resync(&self, state: &mut RateDecoderState<S, F>, _: S) {
            *state = RateDecoderState::START;
        }
    };
}
pub(super) use decode_rate;
