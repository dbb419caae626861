//! The decoder of the rate codes.

use super::filter::Taps;
use super::residual::Residual;
use crate::{Decoder, Sample, Spike};

/// Adds up the filters of the spikes: `y[i] = shift + sum over j of s[i-j] h[j]`.
///
/// - **Range:** the sum takes the oldest spike first, one rounding each in `f32`; fixed point is
///   exact and saturates at the type's ends.
/// - **Work:** one addition a tap for each spike, two operations for each sample without.
/// - **Memory:** `4 F + 12` bytes in `f32`.
/// - **Loss:** a lost spike is forgotten after `F` samples, so a rate decoder needs no keyframes;
///   [`resync`](Decoder::resync) forgets the spikes of the past at once.
///
/// [`Spike::Down`], which no rate code emits, decodes as [`Spike::None`].
///
/// Source: paper, section II-B.
#[derive(Clone, Copy, Debug)]
pub struct RateDecoder<'a, S: Sample, const F: usize> {
    taps: &'a Taps<S, F>,
    shift: S,
    /// What the spikes so far add to the next `F` values, from `next` on.
    pending: [S::Residual; F],
    next: u16,
}

impl<'a, S: Sample, const F: usize> RateDecoder<'a, S, F> {
    pub(super) fn new(taps: &'a Taps<S, F>, shift: S) -> Self {
        Self { taps, shift, pending: [S::Residual::ZERO; F], next: 0 }
    }

    #[inline(always)]
    fn decode_one(&mut self, spike: Spike) -> S {
        let next = (self.next as usize).min(F - 1);
        if spike == Spike::Up {
            for (sum, tap) in self.pending.iter_mut().zip(self.taps.starting_at(next)) {
                *sum = sum.plus(tap.widen());
            }
        }
        let mut sum = S::Residual::ZERO;
        if let Some(pending) = self.pending.get_mut(next) {
            core::mem::swap(&mut sum, pending);
        }
        self.next = if next + 1 < F { next as u16 + 1 } else { 0 };
        self.shift.restore(sum)
    }
}

impl<S: Sample, const F: usize> Decoder for RateDecoder<'_, S, F> {
    type Sample = S;
    type Code = Spike;

    #[inline]
    fn decode(&mut self, spike: Spike) -> S {
        self.decode_one(spike)
    }

    #[inline]
    fn decode_slice(&mut self, spikes: &[Spike], values: &mut [S]) -> usize {
        for (value, &spike) in values.iter_mut().zip(spikes) {
            *value = self.decode_one(spike);
        }
        spikes.len().min(values.len())
    }

    /// Forgets the spikes of the past, whose filters would reach into the future; the value itself
    /// is not taken up, as this decoder's values come from spikes alone.
    fn resync(&mut self, _: S) {
        self.reset();
    }

    fn reset(&mut self) {
        self.pending = [S::Residual::ZERO; F];
        self.next = 0;
    }
}
