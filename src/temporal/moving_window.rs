//! Moving window (MW): a spike when a sample leaves the band around the mean of those before it.

use core::ops::{Add, Sub};

use super::StepDecoder;
use crate::codec::{all_finite, encode_each};
use crate::error::{checked, positive};
use crate::sample::{Tally, for_each_integer, for_each_sample};
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
/// - **Exactness:** without division, `N x` is compared with `sum ± N threshold`. Fixed point is
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
            margin: self.threshold.times(N),
            next: 0,
            tally: Tally::default(),
        }
    }

    fn decoder(self) -> StepDecoder<S> {
        StepDecoder::new(self.threshold)
    }
}

/// The encoder of [`MovingWindow`].
#[derive(Clone, Copy, Debug)]
pub struct MovingWindowEncoder<S: Sample, const N: usize> {
    ring: [S; N],
    partial: S::Sum,
    margin: S::Sum,
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
                self.slide(sample);
            }
        } else {
            self.tally.reject();
        }
    }

    /// Takes a finite sample, and gives the spike that it is against a full window.
    #[inline]
    fn slide(&mut self, sample: S) -> Spike {
        let Some(slot) = self.ring.get_mut(self.next as usize) else { return Spike::None };
        let sum = S::slide(slot, &mut self.partial, sample);
        self.next += 1;
        if self.next as usize == N {
            self.close_block();
        }
        judge(sample.times(N), sum, self.margin)
    }

    /// The same for a slice against a full window: one run to the end of a block after the other, in
    /// which nothing wraps.
    #[inline]
    fn slide_slice(&mut self, samples: &[S], spikes: &mut [Spike]) {
        let mut pairs = spikes.iter_mut().zip(samples);
        while pairs.len() > 0 {
            let margin = self.margin;
            let mut partial = self.partial;
            let slots = self.ring.get_mut(self.next as usize..).unwrap_or_default();
            let run = pairs.len().min(slots.len());
            for (slot, (spike, &sample)) in slots.iter_mut().zip(&mut pairs) {
                let sum = S::slide(slot, &mut partial, sample);
                *spike = judge(sample.times(N), sum, margin);
            }
            self.partial = partial;
            self.next += run as u16;
            if self.next as usize == N {
                self.close_block();
            }
        }
    }

    #[inline]
    fn close_block(&mut self) {
        S::close_block(&mut self.ring, &mut self.partial);
        self.next = 0;
        self.tally.prime();
    }

    fn clear_window(&mut self) {
        self.ring = [S::ZERO; N];
        self.partial = S::Sum::default();
        self.next = 0;
    }
}

impl<S: Sample, const N: usize> Encoder for MovingWindowEncoder<S, N> {
    type Sample = S;
    type Output = Spike;

    #[inline]
    fn encode(&mut self, sample: S) -> Spike {
        if !sample.is_finite() {
            self.tally.reject();
            return Spike::None;
        }
        let is_primed = self.tally.is_primed();
        let spike = self.slide(sample);
        if is_primed { spike } else { Spike::None }
    }

    /// Whether all samples are finite is asked once; if not, each is taken with care.
    #[inline]
    fn encode_slice(&mut self, samples: &[S], spikes: &mut [Spike]) -> usize {
        if !all_finite(samples) || !self.tally.is_primed() {
            return encode_each(self, samples, spikes);
        }
        self.slide_slice(samples, spikes);
        samples.len().min(spikes.len())
    }

    /// The last sample, once the window is full.
    fn keyframe(&self) -> Option<S> {
        let newest = (self.next as usize).checked_sub(1).unwrap_or(N - 1);
        self.ring.get(newest).copied().filter(|_| self.tally.is_primed())
    }

    fn reset(&mut self) {
        self.clear_window();
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}

/// The spike of `N` times a sample against the sum over the window.
#[inline]
fn judge<T: Copy + PartialOrd + Add<Output = T> + Sub<Output = T>>(
    scaled: T,
    sum: T,
    margin: T,
) -> Spike {
    if scaled > sum + margin {
        Spike::Up
    } else if scaled < sum - margin {
        Spike::Down
    } else {
        Spike::None
    }
}

/// How a sample type sums a window. Sealed: only this crate can name it.
pub trait Windowed: Sized {
    /// Wide enough for 16 384 samples.
    type Sum: Copy
        + Default
        + core::fmt::Debug
        + PartialOrd
        + Add<Output = Self::Sum>
        + Sub<Output = Self::Sum>;

    fn times(self, count: usize) -> Self::Sum;

    /// Puts a sample in the oldest one's slot; gives the sum over the window before.
    fn slide(slot: &mut Self, partial: &mut Self::Sum, sample: Self) -> Self::Sum;

    /// At the end of a block, before the first slot's turn comes again.
    fn close_block(ring: &mut [Self], partial: &mut Self::Sum);
}

/// Slots whose turn has come in this block hold its samples, and `partial` their sum. The others hold,
/// for each sample of the block before, the sum from it to that block's end.
impl Windowed for f32 {
    type Sum = f32;

    #[inline]
    fn times(self, count: usize) -> f32 {
        self * count as f32
    }

    #[inline]
    fn slide(slot: &mut f32, partial: &mut f32, sample: f32) -> f32 {
        let sum = core::mem::replace(slot, sample) + *partial;
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
            fn slide(slot: &mut Self, partial: &mut $sum, sample: Self) -> $sum {
                let sum = *partial;
                let oldest = core::mem::replace(slot, sample);
                *partial += <$sum>::from($to_bits(sample)) - <$sum>::from($to_bits(oldest));
                sum
            }

            #[inline]
            fn close_block(_: &mut [Self], _: &mut $sum) {}
        }
    };
}
for_each_integer!(integer_window);
