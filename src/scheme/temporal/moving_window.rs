//! Moving window (MW): a spike when a sample leaves the band around the mean of the samples before it.

use core::hint::black_box;
use core::slice::{from_mut, from_ref};

use super::StepState;
use super::steps::decode_steps;
use crate::error::{positive, tri, unwrap};
use crate::num::{Difference, HAS_VECTORS, Tally, Windowed, fast_margin, margin, to_f64};
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Moving window: the baseline is the mean of the `N` samples before.
///
/// [`Spike::Up`] if `x > mean + threshold`, [`Spike::Down`] if `x < mean - threshold`. The paper's
/// window is `W = N - 1`. The first `N` samples emit no spike, unless the encoder was
/// [primed](crate::Encoder::prime). Primed with the first `N` samples of a recording, it compares those samples
/// with their own mean, as the paper does, and even the first one can spike. The decoder then starts from the
/// value of the first sample and decodes from the second spike on.
///
/// - **Threshold:** above 0, in the samples' unit. **N:** 1 to 16 384.
/// - **Latency:** 0 samples. **Memory:** `4 N + 12` bytes a channel in `f32`, 4 to decode.
/// - **Exactness:** `N x - sum` is compared with `± N threshold`, without division. Fixed point is exact over
///   its whole range. `f32` adds in this order, which keeps the sum free of drift: samples fill blocks of `N`; the
///   part of the window in the previous block is summed from its newest sample to its oldest, the part in the
///   current block from its oldest to its newest, and the two are added. Samples must stay below `f32::MAX / N`.
/// - **Work:** constant, and in `f32` a pass of `N` additions every `N` samples. `FixedI32` takes fewer
///   instructions while samples stay below `2^28 / N` units in the last place.
/// - **Error:** the decoded value drifts without bound. Resynchronise it.
/// - **Silence:** a signal that was constant for `N` samples gives no spike, in `f32` if the threshold exceeds what
///   rounding leaves in the sum. A larger threshold never gives more spikes.
///
/// Source: paper, section II-C, algorithm 8.
///
/// ```
/// use spikewire::{Scheme, Spike, temporal::MovingWindow};
///
/// const CLIMB: MovingWindow<f32, 2> = MovingWindow::new(0.5);
/// let mut encoder = CLIMB.encoder();
/// let spikes = [0.0, 1.0, 1.1, 0.4].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [Spike::None, Spike::None, Spike::Up, Spike::Down]);
/// ```
///
/// A window without samples does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::MovingWindow;
/// const CLIMB: MovingWindow<f32, 0> = MovingWindow::new(0.5);
/// # let _ = CLIMB;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MovingWindow<S: Sample, const N: usize> {
    threshold: S,
    /// `N` times the threshold, to compare differences with.
    #[cfg_attr(feature = "serde", serde(skip))]
    margin: <S::Sum as Difference>::Margin,
    /// The margin for fast sums.
    #[cfg_attr(feature = "serde", serde(skip))]
    fast_margin: <S::Fast as Difference>::Margin,
}

#[cfg(feature = "defmt")]
impl<S: Sample + defmt::Format, const N: usize> defmt::Format for MovingWindow<S, N> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "MovingWindow {{ threshold: {} }}", self.threshold);
    }
}

impl<S: Sample, const N: usize> MovingWindow<S, N> {
    const SHAPE: () = assert!(N >= 1 && N <= 16_384, "a moving window takes 1 to 16384 samples");

    /// A scheme with this threshold, which is also the decoder's step. For constants, where a bad threshold
    /// fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not above 0, or not finite.
    pub const fn new(threshold: S) -> Self {
        unwrap(Self::try_new(threshold))
    }

    /// A scheme with this threshold, which is also the decoder's step.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, or not finite.
    pub const fn try_new(threshold: S) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        tri!(positive("threshold", to_f64(threshold)));
        let (margin, fast_margin) = (margin(threshold, N), fast_margin(threshold, N));
        Ok(Self { threshold, margin, fast_margin })
    }

    /// The threshold, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }
}

/// Added to the index of the next slot until the window is full, which puts it out of the ring.
const FILLING: u16 = 1 << 15;

/// The longest window whose blocks [`encode_slice`](Scheme::encode_slice) takes at once, in registers. Of longer
/// ones it takes groups of [`GROUP`] samples.
const SHORT: usize = 8;

const GROUP: usize = 4;

/// The state of a [`MovingWindow`] encoder: the window and its sum. `4 N + 12` bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
#[repr(C)]
pub struct MovingWindowState<S: Sample, const N: usize> {
    // Most cores reach a slot in one instruction if the window comes first. A Cortex-M0, the only core without atomic
    // exchange, never does; it reaches the other fields in one instruction if they come first.
    #[cfg(target_has_atomic = "32")]
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    ring: [S; N],
    partial: S::Sum,
    next: u16,
    tally: Tally,
    #[cfg(not(target_has_atomic = "32"))]
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    ring: [S; N],
}

impl<S: Sample, const N: usize> Start for MovingWindow<S, N> {
    const START: MovingWindowState<S, N> = MovingWindowState {
        ring: [S::ZERO; N],
        partial: S::Sum::ZERO,
        next: FILLING,
        tally: Tally::NONE,
    };
}

impl<S: Sample, const N: usize> MovingWindowState<S, N> {
    /// Encodes groups of samples up to the end of a block, and returns how many samples. Stops before a group that
    /// could overflow the fast sum, or that holds a sample that is not finite.
    #[inline]
    fn encode_groups<const M: usize>(
        &mut self,
        margin: <S::Fast as Difference>::Margin,
        groups: &[[S; M]],
        spikes: &mut [[impl Destination<Spike>; M]],
    ) -> usize {
        let Some(mut partial) = S::fast(self.partial) else { return 0 };
        let is_full = self.next < FILLING;
        let margin = if is_full { margin } else { S::Fast::WIDEST };
        let next = (self.next & !FILLING) as usize;
        let slots = self.ring.get_mut(next..).unwrap_or_default().as_chunks_mut::<M>().0;
        let mut taken = 0;
        for ((spikes, &samples), slots) in spikes.iter_mut().zip(groups).zip(slots) {
            if !S::are_small(N, &samples, slots) {
                break;
            }
            let mut sum = partial;
            let mut check = S::Fast::ZERO;
            for ((spike, sample), &slot) in spikes.iter_mut().zip(samples).zip(slots.iter()) {
                let difference = sample.excess(N, slot, &mut sum);
                spike.write(Spike::from_side(difference.beyond(margin)));
                check = check.including(difference);
            }
            if !check.is_finite() {
                break;
            }
            *slots = samples;
            partial = sum;
            taken += M;
        }
        self.partial = S::exact(partial);
        self.next += taken as u16;
        if next + taken == N {
            self.close_block();
        }
        taken
    }

    /// Encodes whole blocks of a short window with a copy of the state, which stays in registers, and returns how many
    /// samples. Stops before a block that [`encode_groups`](Self::encode_groups) does not take.
    #[inline]
    fn encode_blocks(
        &mut self,
        margin: <S::Fast as Difference>::Margin,
        blocks: &[[S; N]],
        spikes: &mut [[impl Destination<Spike>; N]],
    ) -> usize {
        let mut local = *self;
        let mut taken = 0;
        for (block, spikes) in blocks.iter().zip(spikes) {
            if local.next != 0
                || local.encode_groups::<N>(margin, from_ref(block), from_mut(spikes)) == 0
            {
                break;
            }
            taken += N;
        }
        *self = local;
        taken
    }

    /// [`encode_groups`](Self::encode_groups) of a long block, out of line so that it has all registers.
    #[inline(never)]
    fn encode_long(
        &mut self,
        margin: <S::Fast as Difference>::Margin,
        groups: &[[S; GROUP]],
        spikes: &mut [[impl Destination<Spike>; GROUP]],
    ) -> usize {
        self.encode_groups(margin, groups, spikes)
    }

    /// Stores a sample in the slot `next`, and the sum over the window with it.
    #[inline]
    fn take(&mut self, next: usize, sample: S, partial: S::Fast) {
        if let Some(slot) = self.ring.get_mut(next) {
            *slot = sample;
        }
        self.partial = S::exact(partial);
        self.next = next as u16 + 1;
        if next + 1 == N {
            self.close_block_once();
        }
    }

    /// Ends a block. In `f32`, where this takes a pass of additions, in a function of its own: one sample in `N` comes
    /// here.
    #[inline]
    fn close_block_once(&mut self) {
        if S::Fast::IS_ALWAYS_FINITE { self.close_block() } else { self.close_block_apart() }
    }

    #[inline(never)]
    fn close_block_apart(&mut self) {
        self.close_block();
    }

    #[inline]
    fn close_block(&mut self) {
        self.next = 0;
        if N <= SHORT {
            S::close_block(&mut self.ring, &mut self.partial);
        } else {
            close_long_block(&mut self.ring, &mut self.partial);
        }
    }

    fn clear_window(&mut self) {
        self.ring = [S::ZERO; N];
        self.partial = S::Sum::ZERO;
        self.next = FILLING;
    }
}

/// Ends a long block. The length is hidden from the compiler, which would unroll the loop over all slots.
#[inline(never)]
fn close_long_block<S: Windowed>(ring: &mut [S], partial: &mut S::Sum) {
    let length = black_box(ring.len());
    S::close_block(ring.get_mut(..length).unwrap_or_default(), partial);
}

impl<S: Sample, const N: usize> MovingWindow<S, N> {
    /// Encodes any sample. Emits no spike before the window is full, for a sample that is not finite, and for a
    /// difference that is NaN.
    ///
    /// It has the arguments and the result of [`encode`](Scheme::encode), in that order: they stay in their
    /// registers, and the usual path needs no stack.
    #[cold]
    #[inline(never)]
    fn encode_carefully(&self, state: &mut MovingWindowState<S, N>, sample: S) -> Spike {
        let is_full = state.next < FILLING;
        let next = (state.next & !FILLING) as usize;
        let Some(slot) = state.ring.get_mut(next).filter(|_| sample.is_finite()) else {
            state.tally.reject();
            return Spike::None;
        };
        let difference = sample.excess(N, *slot, &mut state.partial);
        *slot = sample;
        let spike = if is_full && !difference.is_nan() {
            // Hides the scheme from the compiler, which would otherwise load the margin early, on the usual path,
            // and pass it here in a register that the usual path lacks.
            Spike::from_side(difference.beyond(black_box(self).margin))
        } else {
            Spike::None
        };
        state.next = state.next.wrapping_add(1);
        if next.wrapping_add(1) == N {
            state.close_block_once();
        }
        spike
    }
}

impl<S: Sample, const N: usize> Scheme for MovingWindow<S, N> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = MovingWindowState<S, N>;
    type DecoderState = StepState<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Keyframe;

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("MovingWindow").sample(self.threshold).number(N as u32)
    }

    #[inline]
    fn encode(&self, state: &mut MovingWindowState<S, N>, sample: S) -> Spike {
        // The sample that ends a long block is left to `encode_carefully`, so that this path stays short.
        let usual = if N <= SHORT { N } else { N - 1 };
        let next = state.next as usize;
        if let Some(&slot) = state.ring.get(..usual).and_then(|slots| slots.get(next))
            && let Some(mut partial) = S::fast(state.partial)
            && S::are_small(N, &[sample], &[slot])
        {
            let difference = sample.excess(N, slot, &mut partial);
            if S::Fast::IS_ALWAYS_FINITE {
                state.take(next, sample, partial);
                return Spike::from_side(difference.beyond(self.fast_margin));
            }
            // A difference within the margin is finite: only those beyond it need the check.
            let side = difference.beyond(self.fast_margin);
            if side.is_eq() {
                state.take(next, sample, partial);
                return Spike::None;
            }
            if difference.is_finite() {
                state.take(next, sample, partial);
                return Spike::from_side(side);
            }
        }
        self.encode_carefully(state, sample)
    }

    #[inline]
    fn encode_slice(
        &self,
        state: &mut MovingWindowState<S, N>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
    ) -> usize {
        let length = samples.len().min(spikes.len());
        let mut encoded = 0;
        while encoded < length {
            let samples = samples.get(encoded..length).unwrap_or_default();
            let spikes = spikes.get_mut(encoded..length).unwrap_or_default();
            let taken = if N > SHORT {
                let (groups, spikes) = (samples.as_chunks().0, spikes.as_chunks_mut().0);
                state.encode_long(self.fast_margin, groups, spikes)
            } else if HAS_VECTORS {
                let (blocks, spikes) = (samples.as_chunks().0, spikes.as_chunks_mut().0);
                state.encode_blocks(self.fast_margin, blocks, spikes)
            } else if state.next == 0
                && let Some(block) = samples.first_chunk()
                && let Some(spikes) = spikes.first_chunk_mut()
            {
                state.encode_groups::<N>(self.fast_margin, from_ref(block), from_mut(spikes))
            } else {
                0
            };
            if taken == 0
                && let (Some(&sample), Some(spike)) = (samples.first(), spikes.first_mut())
            {
                spike.write(self.encode_carefully(state, sample));
            }
            encoded += taken.max(1);
        }
        length
    }

    /// The last `N` samples of the past fill the window; a shorter past is ignored.
    fn prime(&self, state: &mut MovingWindowState<S, N>, past: &[S]) {
        let Some(window) = past.last_chunk::<N>() else { return };
        if window.iter().all(S::is_finite) {
            state.clear_window();
            for &sample in window {
                self.encode_carefully(state, sample);
            }
        } else {
            state.tally.reject();
        }
    }

    /// The last sample, once the window is full.
    fn keyframe(&self, state: &MovingWindowState<S, N>) -> Option<S> {
        let newest = (state.next as usize).checked_sub(1).unwrap_or(N - 1);
        state.ring.get(newest).copied()
    }

    fn fits(&self, state: &MovingWindowState<S, N>) -> bool {
        ((state.next & !FILLING) as usize) < N
    }

    fn rejected(state: &MovingWindowState<S, N>) -> u32 {
        state.tally.rejected()
    }

    decode_steps!(threshold);
}
