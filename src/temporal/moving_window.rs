//! Moving window (MW): a spike when a sample leaves the band around the mean of those before it.

use core::hint::black_box;
use core::slice::{from_mut, from_ref};

use super::StepDecoder;
use super::window_sum::{Difference, Windowed};
use crate::error::{checked, positive};
use crate::sample::{Tally, for_each_sample};
use crate::{ConfigError, Encoder, Sample, Scheme, Spike};

/// Moving window: the baseline is the mean of the `N` samples before.
///
/// [`Spike::Up`] if `x > mean + threshold`, [`Spike::Down`] if `x < mean - threshold`. The paper's
/// window is `W = N - 1`. Nothing is emitted before `N` samples have been seen, unless the encoder
/// was [primed](MovingWindowEncoder::prime); primed with the first `N` samples of a recording it
/// compares those with their own mean, as the paper does.
///
/// - **Threshold:** above 0, in the samples' unit. **N:** 1 to 16 384.
/// - **Latency:** 0 samples. **Memory:** `4 N + 16` bytes an encoder in `f32`.
/// - **Exactness:** without division, `N x - sum` is compared with `± N threshold`. Fixed point is
///   exact over its whole range. `f32` takes the sum in this order, which keeps it free of drift:
///   samples fill blocks of `N` slots; the part of the window in the block before is summed from its
///   newest sample to its oldest, the part in the current block from its oldest to its newest, and
///   the two are added. That costs constant work a sample on average and one pass of `N` additions
///   every `N` samples. Samples must stay below `f32::MAX / N`. `FixedI32` takes fewer instructions
///   while samples stay below `2^28 / N` units in the last place.
/// - **Error:** the decoded value drifts without bound. Resynchronise it.
///
/// Source: paper, section II-C, algorithm 8.
///
/// ```
/// use spikewire::{Encoder, Scheme, Spike, temporal::MovingWindow};
///
/// const CLIMB: MovingWindow<f32, 2> = MovingWindow::<f32, _>::checked(0.5);
/// let mut encoder = CLIMB.encoder();
/// let spikes = [0.0, 1.0, 1.1, 0.4].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [Spike::None, Spike::None, Spike::Up, Spike::Down]);
/// ```
///
/// A window without samples does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::MovingWindow;
/// const CLIMB: MovingWindow<f32, 0> = MovingWindow::<f32, _>::checked(0.5);
/// # let _ = CLIMB;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MovingWindow<S, const N: usize> {
    threshold: S,
}

impl<S, const N: usize> MovingWindow<S, N> {
    const SHAPE: () = assert!(N >= 1 && N <= 16_384, "a moving window takes 1 to 16384 samples");
}

impl<S: Sample, const N: usize> MovingWindow<S, N> {
    /// A scheme with this threshold, which is also the decoder's step.
    ///
    /// # Errors
    /// The threshold is not above 0, or not finite.
    pub fn new(threshold: S) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        positive("threshold", threshold.to_f64())?;
        Ok(Self { threshold })
    }

    /// The threshold, in the samples' unit.
    pub fn threshold(&self) -> S {
        self.threshold
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path) => {
        impl<const N: usize, $($generics)*> MovingWindow<$sample, N> {
            /// For constants: a threshold that is not above 0 fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked(threshold: $sample) -> Self {
                const { Self::SHAPE };
                checked!(positive("threshold", $to_f64(threshold)));
                Self { threshold }
            }
        }
    };
}
for_each_sample!(constants);

impl<S: Sample, const N: usize> Scheme for MovingWindow<S, N> {
    type Sample = S;
    type Encoder = MovingWindowEncoder<S, N>;
    type Decoder = StepDecoder<S>;

    const LATENCY: usize = 0;

    fn encoder(self) -> MovingWindowEncoder<S, N> {
        MovingWindowEncoder {
            ring: [S::ZERO; N],
            partial: S::Sum::default(),
            margin: S::margin(self.threshold, N),
            next: FILLING,
            tally: Tally::default(),
        }
    }

    fn decoder(self) -> StepDecoder<S> {
        StepDecoder::new(self.threshold)
    }
}

/// Added to the next slot until the window is full: such a slot is not found.
const FILLING: u16 = 1 << 15;

/// The slice form takes a block of up to so many samples at once, in registers, and of a longer one
/// groups of [`GROUP`].
const SHORT: usize = 8;

const GROUP: usize = 4;

/// The encoder of [`MovingWindow`].
#[derive(Clone, Copy, Debug)]
pub struct MovingWindowEncoder<S: Sample, const N: usize> {
    ring: [S; N],
    partial: S::Sum,
    margin: <S::Sum as Difference>::Margin,
    next: u16,
    tally: Tally,
}

impl<S: Sample, const N: usize> MovingWindowEncoder<S, N> {
    /// Fills the window with these samples, oldest first. A window with a value that is not finite
    /// is counted and ignored.
    pub fn prime(&mut self, window: &[S; N]) {
        if window.iter().all(S::is_finite) {
            self.clear_window();
            for &sample in window {
                self.encode_carefully(sample);
            }
        } else {
            self.tally.reject();
        }
    }

    /// Takes groups of samples up to the end of a block, and says how many. It stops before a group
    /// that the fast sum is not wide enough for, as it is not for a sample that is not finite.
    #[inline]
    fn encode_groups<const M: usize>(
        &mut self,
        groups: &[[S; M]],
        spikes: &mut [[Spike; M]],
    ) -> usize {
        let Some(mut partial) = S::fast(self.partial) else { return 0 };
        let is_full = self.next < FILLING;
        let margin = if is_full { S::fast_margin(self.margin) } else { S::Fast::WIDEST };
        let next = (self.next & !FILLING) as usize;
        let slots = self.ring.get_mut(next..).unwrap_or_default().as_chunks_mut::<M>().0;
        let mut taken = 0;
        for ((spikes, &samples), slots) in spikes.iter_mut().zip(groups).zip(slots) {
            if !S::are_small(N, &samples, slots) {
                break;
            }
            let mut sum = partial;
            let mut taint = S::Fast::default();
            for ((spike, sample), &slot) in spikes.iter_mut().zip(samples).zip(slots.iter()) {
                let difference = sample.excess(N, slot, &mut sum);
                *spike = difference.judge(margin);
                taint = taint.taint(difference);
            }
            if !taint.is_finite() {
                break;
            }
            *slots = samples;
            partial = sum;
            taken += 1;
        }
        self.partial = S::exact(partial);
        self.next += (taken * M) as u16;
        if next + taken * M == N {
            self.close_block();
        }
        taken
    }

    /// Takes any sample. Nothing is emitted if it is not finite, nor before the window is full, nor for
    /// a difference that is not a number.
    #[cold]
    #[inline(never)]
    fn encode_carefully(&mut self, sample: S) -> Option<Spike> {
        let is_full = self.next < FILLING;
        let next = (self.next & !FILLING) as usize;
        let Some(slot) = self.ring.get_mut(next).filter(|_| sample.is_finite()) else {
            self.tally.reject();
            return None;
        };
        let difference = sample.excess(N, *slot, &mut self.partial);
        *slot = sample;
        self.next += 1;
        if next + 1 == N {
            self.close_block();
        }
        (is_full && !difference.is_nan()).then(|| difference.judge(self.margin))
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
        self.partial = S::Sum::default();
        self.next = FILLING;
    }
}

/// Of a length that the compiler does not know, or it would write out every slot.
#[inline(never)]
fn close_long_block<S: Windowed>(ring: &mut [S], partial: &mut S::Sum) {
    let length = black_box(ring.len());
    S::close_block(ring.get_mut(..length).unwrap_or_default(), partial);
}

impl<S: Sample, const N: usize> Encoder for MovingWindowEncoder<S, N> {
    type Sample = S;
    type Output = Spike;

    #[inline]
    fn encode(&mut self, sample: S) -> Spike {
        // The sample that closes a long block is left to the careful way, so that this one stays short.
        let usual = if N <= SHORT { N } else { N - 1 };
        let next = self.next as usize;
        if let Some(slot) = self.ring.get_mut(..usual).and_then(|slots| slots.get_mut(next))
            && let Some(mut partial) = S::fast(self.partial)
            && S::are_small(N, &[sample], &[*slot])
        {
            let difference = sample.excess(N, *slot, &mut partial);
            if difference.is_finite() {
                *slot = sample;
                self.partial = S::exact(partial);
                self.next = next as u16 + 1;
                if next + 1 == N {
                    self.close_block();
                }
                return difference.judge(S::fast_margin(self.margin));
            }
        }
        self.encode_carefully(sample).unwrap_or_default()
    }

    #[inline]
    fn encode_slice(&mut self, mut samples: &[S], mut spikes: &mut [Spike]) -> usize {
        let length = samples.len().min(spikes.len());
        samples = samples.get(..length).unwrap_or_default();
        while !samples.is_empty() {
            let taken = if N > SHORT {
                let (groups, spikes) = (samples.as_chunks().0, spikes.as_chunks_mut().0);
                GROUP * self.encode_groups::<GROUP>(groups, spikes)
            } else if self.next == 0
                && let Some(block) = samples.first_chunk()
                && let Some(spikes) = spikes.first_chunk_mut()
            {
                N * self.encode_groups::<N>(from_ref(block), from_mut(spikes))
            } else {
                0
            };
            if taken > 0 {
                samples = samples.get(taken..).unwrap_or_default();
                spikes = spikes.get_mut(taken..).unwrap_or_default();
            } else if let (Some(&sample), Some(spike)) =
                (samples.split_off_first(), spikes.split_off_first_mut())
            {
                *spike = self.encode_carefully(sample).unwrap_or_default();
            }
        }
        length
    }

    /// The last sample, once the window is full.
    fn keyframe(&self) -> Option<S> {
        let newest = (self.next as usize).checked_sub(1).unwrap_or(N - 1);
        self.ring.get(newest).copied()
    }

    fn reset(&mut self) {
        self.clear_window();
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}
