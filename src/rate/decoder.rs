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

    #[inline]
    fn add_filter(&mut self) {
        let next = self.next as usize;
        let (late, early) = self.pending.split_at_mut_checked(next).unwrap_or_default();
        let (first, rest) = self.taps.as_array().split_at_checked(F - next).unwrap_or_default();
        add(early, first);
        add(late, rest);
    }
}

/// Adds taps to sums, one by one.
#[inline]
fn add<S: Sample>(sums: &mut [S::Residual], taps: &[S]) {
    for (sum, tap) in sums.iter_mut().zip(taps) {
        *sum = sum.plus(tap.widen());
    }
}

impl<S: Sample, const F: usize> Decoder for RateDecoder<'_, S, F> {
    type Sample = S;
    type Code = Spike;

    #[inline]
    fn decode(&mut self, spike: Spike) -> S {
        if spike == Spike::Up {
            self.add_filter();
        }
        let sum = match self.pending.get_mut(self.next as usize) {
            Some(slot) => core::mem::replace(slot, S::Residual::ZERO),
            None => S::Residual::ZERO,
        };
        self.next += 1;
        if self.next as usize == F {
            self.next = 0;
        }
        self.shift.restore(sum)
    }

    /// Sums lie in one line of memory, two filters long on the stack, where a filter does not wrap.
    #[inline]
    fn decode_slice(&mut self, spikes: &[Spike], values: &mut [S]) -> usize {
        let length = spikes.len().min(values.len());
        let spikes = spikes.get(..length).unwrap_or_default();
        let values = values.get_mut(..length).unwrap_or_default();
        let mut pending = self.pending;
        pending.rotate_left((self.next as usize).min(F));
        let mut line = [pending, [S::Residual::ZERO; F]];
        let line = line.as_flattened_mut();
        for (spikes, values) in spikes.chunks(F).zip(values.chunks_mut(F)) {
            for (start, &spike) in spikes.iter().enumerate() {
                if spike == Spike::Up
                    && let Some(sums) = line.get_mut(start..).and_then(<[_]>::first_chunk_mut::<F>)
                {
                    add(sums, self.taps.as_array());
                }
            }
            for (value, &sum) in values.iter_mut().zip(line.iter()) {
                *value = self.shift.restore(sum);
            }
            line.copy_within(spikes.len().., 0);
            let (_, beyond) = line.split_at_mut_checked(2 * F - spikes.len()).unwrap_or_default();
            beyond.fill(S::Residual::ZERO);
        }
        if let Some(pending) = line.first_chunk() {
            self.pending = *pending;
            self.next = 0;
        }
        length
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
