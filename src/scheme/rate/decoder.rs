//! The decoder that the rate codes with a filter share: it adds up the filters of the spikes.

use super::filtered::Filtered;
use crate::num::{HAS_VECTORS, Residual};
use crate::{Sample, Spike};

/// The state of the decoder of a rate code with a filter: what past spikes add to the next `F` values.
///
/// `y[i] = shift + sum over j of s[i-j] h[j]`.
///
/// - **Range:** the sum takes the oldest spike first, one rounding each in `f32`; fixed point is
///   exact and saturates at the type's ends.
/// - **Work:** one addition a tap for a sample with a spike, two operations for a sample without. Long slices on a core
///   with vectors take every tap for every sample where spikes are dense, many samples at once.
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

    /// Decodes a long slice panel by panel if the core has vectors, and what is left one by one.
    #[inline(always)]
    pub(super) fn decode_slice(
        &mut self,
        filtered: &Filtered<S, F>,
        spikes: &[impl Copy + Into<Spike>],
        values: &mut [S],
    ) -> usize {
        let length = spikes.len().min(values.len());
        let (mut spikes, mut values) = (spikes, values);
        if HAS_VECTORS && length > PANEL + 4 * F {
            let done = self.decode_panels(filtered, spikes, values);
            spikes = spikes.get(done..).unwrap_or_default();
            values = values.get_mut(done..).unwrap_or_default();
        }
        for (value, &spike) in values.iter_mut().zip(spikes) {
            *value = self.decode(filtered, spike.into());
        }
        length
    }

    /// Decodes panel after panel, and returns how many values that made.
    ///
    /// Each value is the sum that [`decode`](Self::decode) makes, in its order: that of the spikes.
    fn decode_panels(
        &mut self,
        filtered: &Filtered<S, F>,
        spikes: &[impl Copy + Into<Spike>],
        values: &mut [S],
    ) -> usize {
        let past = F - 1;
        for (value, &spike) in values.iter_mut().zip(spikes).take(past) {
            *value = self.decode(filtered, spike.into());
        }
        let mut done = past;
        while let Some(values) = values.get_mut(done..).and_then(<[S]>::first_chunk_mut::<PANEL>)
            && let Some(spikes) = spikes.get(done - past..done + PANEL)
        {
            let taps = filtered.taps.as_array();
            let sums = if fired(spikes) < FEW {
                sums_of_few::<S, F>(taps, spikes)
            } else {
                sums::<S>(taps, spikes)
            };
            for (value, sum) in values.iter_mut().zip(sums) {
                *value = filtered.shift.restore(sum);
            }
            done += PANEL;
        }
        // What the last spikes add to the values to come.
        self.pending = [S::Residual::ZERO; F];
        for &spike in spikes.get(done - past..done).unwrap_or_default() {
            self.decode(filtered, spike.into());
        }
        done
    }
}

/// How many values are decoded at once: blocks of values, whose sums fit the registers.
const PANEL: usize = 3 * BLOCK;
const BLOCK: usize = 48;

/// Of how many taps the spikes are looked up at once.
const GROUP: usize = 16;

/// For fewer spikes in a panel, adding the filter of each is quicker than every tap.
const FEW: u8 = (PANEL / 8) as u8;

/// How many spikes the panel has, at the end of `spikes`; in bytes, of which a vector register holds most.
#[inline]
fn fired(spikes: &[impl Copy + Into<Spike>]) -> u8 {
    let panel = spikes.last_chunk::<PANEL>().into_iter().flatten();
    panel.fold(0, |fired, &spike| fired.wrapping_add(u8::from(spike.into() == Spike::Up)))
}

/// The sums of a panel, spike after spike.
#[inline]
fn sums_of_few<S: Sample, const F: usize>(
    taps: &[S; F],
    spikes: &[impl Copy + Into<Spike>],
) -> [S::Residual; PANEL] {
    let mut sums = [S::Residual::ZERO; PANEL];
    for (at, &spike) in spikes.iter().enumerate() {
        if spike.into() == Spike::Up {
            // The spikes before the panel reach into it with their last taps.
            let taps = taps.get((F - 1).saturating_sub(at)..).unwrap_or_default();
            let sums = sums.get_mut(at.saturating_sub(F - 1)..).unwrap_or_default();
            for (sum, tap) in sums.iter_mut().zip(taps) {
                *sum = sum.plus(tap.widen());
            }
        }
    }
    sums
}

/// The sums of a panel. `spikes` are the panel's, and before them one less than there are taps.
///
/// All values take the filter's last tap, then the tap before it, and so on. Without a spike they add 0, which changes
/// no sum, as none is -0.
#[inline]
fn sums<S: Sample>(taps: &[S], mut spikes: &[impl Copy + Into<Spike>]) -> [S::Residual; PANEL] {
    let mut sums = [S::Residual::ZERO; PANEL];
    for group in taps.rchunks(GROUP) {
        let mut fired = [0; PANEL + GROUP];
        for (fired, &spike) in fired.iter_mut().zip(spikes) {
            *fired = if spike.into() == Spike::Up { u32::MAX } else { 0 };
        }
        let blocks = fired.windows(BLOCK + GROUP).step_by(BLOCK);
        for (sums, fired) in sums.as_chunks_mut::<BLOCK>().0.iter_mut().zip(blocks) {
            add_block::<S>(sums, group, fired);
        }
        spikes = spikes.get(group.len()..).unwrap_or_default();
    }
    sums
}

/// Adds a group of taps to the sums of a block, out of line so that the sums have all registers.
#[inline(never)]
fn add_block<S: Sample>(sums: &mut [S::Residual; BLOCK], group: &[S], fired: &[u32]) {
    let mut local = *sums;
    for (tap, fired) in group.iter().rev().zip(fired.windows(BLOCK)) {
        for (sum, &fired) in local.iter_mut().zip(fired) {
            *sum = sum.plus(tap.widen().masked(fired));
        }
    }
    *sums = local;
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
            state.decode_slice(&self.filtered, spikes, values)
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
