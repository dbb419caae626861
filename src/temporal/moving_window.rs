//! Moving window (MW): a spike when a sample leaves the band around the mean of those before it.

use core::fmt::Debug;
use core::hint::black_box;
use core::ops::Sub;
use core::slice::{from_mut, from_ref};

use super::StepDecoder;
use crate::error::{checked, positive};
use crate::sample::{Tally, for_each_integer, for_each_sample, judge, magnitude};
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
///   every `N` samples. Samples must stay below `f32::MAX / N`.
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
            margin: self.threshold.times(N).margin(),
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
    /// with a difference that is not finite, as that of a sample that is not.
    #[inline]
    fn encode_groups<const M: usize>(
        &mut self,
        groups: &[[S; M]],
        spikes: &mut [[Spike; M]],
    ) -> usize {
        let margin = if self.next < FILLING { self.margin } else { S::Sum::WIDEST };
        let next = (self.next & !FILLING) as usize;
        let slots = self.ring.get_mut(next..).unwrap_or_default().as_chunks_mut::<M>().0;
        let mut partial = self.partial;
        let mut taken = 0;
        for ((spikes, &samples), slots) in spikes.iter_mut().zip(groups).zip(slots) {
            let mut sum = partial;
            let mut taint = S::Sum::default();
            for ((spike, sample), &slot) in spikes.iter_mut().zip(samples).zip(slots.iter()) {
                let difference = sample.times(N) - S::slide(&mut sum, slot, sample);
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
        self.partial = partial;
        self.next += (taken * M) as u16;
        if next + taken * M == N {
            self.close_block();
        }
        taken
    }

    /// Takes a sample of any kind. Nothing is emitted if it is not finite, nor before the window is
    /// full, nor for a difference that is not a number.
    #[cold]
    #[inline(never)]
    fn encode_carefully(&mut self, sample: S) -> Option<Spike> {
        let is_full = self.next < FILLING;
        let next = (self.next & !FILLING) as usize;
        let Some(slot) = self.ring.get_mut(next).filter(|_| sample.is_finite()) else {
            self.tally.reject();
            return None;
        };
        let difference = sample.times(N) - S::slide(&mut self.partial, *slot, sample);
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
        if let Some(slot) = self.ring.get_mut(..usual).and_then(|slots| slots.get_mut(next)) {
            let mut partial = self.partial;
            let difference = sample.times(N) - S::slide(&mut partial, *slot, sample);
            if difference.is_finite() {
                *slot = sample;
                self.partial = partial;
                self.next = next as u16 + 1;
                if next + 1 == N {
                    self.close_block();
                }
                return difference.judge(self.margin);
            }
        }
        self.encode_carefully(sample).unwrap_or_default()
    }

    #[inline]
    fn encode_slice(&mut self, mut samples: &[S], mut spikes: &mut [Spike]) -> usize {
        let length = samples.len().min(spikes.len());
        samples = samples.get(..length).unwrap_or_default();
        while let Some(&first) = samples.first() {
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
            } else if let Some(spike) = spikes.split_off_first_mut() {
                *spike = self.encode_carefully(first).unwrap_or_default();
                samples = samples.get(1..).unwrap_or_default();
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

/// How a sample type sums a window. Sealed: only this crate can name it.
pub trait Windowed: Sized {
    /// Wide enough for 16 384 samples.
    type Sum: Difference;

    fn times(self, count: usize) -> Self::Sum;

    /// Takes a sample into the partial sum; gives the sum over the window before, of which the slot is
    /// the oldest part.
    fn slide(partial: &mut Self::Sum, slot: Self, sample: Self) -> Self::Sum;

    /// At the end of a block, before the first slot's turn comes again.
    fn close_block(ring: &mut [Self], partial: &mut Self::Sum);
}

/// A sum, and the difference of `N` times a sample from it.
pub trait Difference: Copy + Default + Debug + Sub<Output = Self> {
    /// What it is compared with.
    type Margin: Copy + Debug;

    /// What no difference exceeds.
    const WIDEST: Self::Margin;

    fn margin(self) -> Self::Margin;

    fn is_nan(self) -> bool;

    fn is_finite(self) -> bool;

    /// Takes up a difference, so that whether all of a group are finite can be asked once.
    fn taint(self, difference: Self) -> Self;

    /// The spike of a difference that is a number.
    fn judge(self, margin: Self::Margin) -> Spike;
}

impl Difference for f32 {
    type Margin = u32;

    const WIDEST: u32 = f32::INFINITY.to_bits() << 1;

    #[inline]
    fn margin(self) -> u32 {
        magnitude(self)
    }

    #[inline]
    fn is_nan(self) -> bool {
        f32::is_nan(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        magnitude(self) < Self::WIDEST
    }

    #[inline]
    fn taint(self, difference: f32) -> f32 {
        self + difference
    }

    #[inline]
    fn judge(self, margin: u32) -> Spike {
        judge(self, margin)
    }
}

macro_rules! integer_difference {
    ($($sum:ty)*) => {
        $(
            impl Difference for $sum {
                type Margin = $sum;

                const WIDEST: $sum = <$sum>::MAX;

                #[inline]
                fn margin(self) -> $sum {
                    self
                }

                #[inline]
                fn is_nan(self) -> bool {
                    false
                }

                #[inline]
                fn is_finite(self) -> bool {
                    true
                }

                #[inline]
                fn taint(self, _: $sum) -> $sum {
                    self
                }

                #[inline]
                fn judge(self, margin: $sum) -> Spike {
                    if self > margin {
                        Spike::Up
                    } else if self < -margin {
                        Spike::Down
                    } else {
                        Spike::None
                    }
                }
            }
        )*
    };
}
integer_difference!(i32 i64);

/// Slots whose turn has come in this block hold its samples, and `partial` their sum. The others hold,
/// for each sample of the block before, the sum from it to that block's end.
impl Windowed for f32 {
    type Sum = f32;

    #[inline]
    fn times(self, count: usize) -> f32 {
        self * count as f32
    }

    #[inline]
    fn slide(partial: &mut f32, slot: f32, sample: f32) -> f32 {
        let sum = slot + *partial;
        *partial += sample;
        sum
    }

    #[inline]
    fn close_block(ring: &mut [f32], partial: &mut f32) {
        // -0 is the only value that leaves every other as it is.
        let mut to_the_end = -0.0;
        for slot in ring.iter_mut().rev() {
            to_the_end += *slot;
            *slot = to_the_end;
        }
        *partial = 0.0;
    }
}

/// The ring holds the samples and `partial` their sum, which integers keep exactly.
macro_rules! integer_window {
    ([$($generics:tt)*] $sample:ty, i16, $($conversions:tt)*) => {
        integer_window!(@ [$($generics)*] $sample, i32, $($conversions)*);
    };
    ([$($generics:tt)*] $sample:ty, i32, $($conversions:tt)*) => {
        integer_window!(@ [$($generics)*] $sample, i64, $($conversions)*);
    };
    (@ [$($generics:tt)*] $sample:ty, $sum:ty, $to_bits:path, $($rest:tt)*) => {
        impl<$($generics)*> Windowed for $sample {
            type Sum = $sum;

            #[inline]
            fn times(self, count: usize) -> $sum {
                <$sum>::from($to_bits(self)) * count as $sum
            }

            #[inline]
            fn slide(partial: &mut $sum, slot: Self, sample: Self) -> $sum {
                let sum = *partial;
                *partial += <$sum>::from($to_bits(sample)) - <$sum>::from($to_bits(slot));
                sum
            }

            #[inline]
            fn close_block(_: &mut [Self], _: &mut $sum) {}
        }
    };
}
for_each_integer!(integer_window);
