//! Step forward (SF): a spike when the signal leaves the band around a baseline that follows it.

use super::StepDecoder;
use crate::codec::{encode_each, encode_first};
use crate::error::{checked, step};
use crate::sample::{Tally, for_each_sample};
use crate::{ConfigError, Encoder, Sample, Scheme, Spike};

/// Step forward: the baseline starts at the first sample and follows the signal by one threshold
/// a spike.
///
/// If `x > base + threshold`: [`Spike::Up`] and `base += threshold`; if `x < base - threshold`:
/// [`Spike::Down`] and `base -= threshold`.
///
/// - **Threshold:** above 0, in the samples' unit; up to 10³¹ in `f32`, so that no band reaches infinity.
/// - **Latency:** 0 samples. **Memory:** 12 bytes an encoder in `f32`.
/// - **Exactness:** `f32` rounds `base ± threshold` once; fixed point is exact.
/// - **Error:** while `|x[i] - x[i-1]| <= threshold`, the decoded value stays within the threshold
///   of the signal.
///
/// Source: paper, section II-C, algorithm 7 (whose second `base + threshold` is a slip for `-`).
///
/// ```
/// use spikewire::{Decoder, Encoder, Scheme, Spike, temporal::StepForward};
///
/// const ROLL: StepForward<f32> = StepForward::<f32>::checked(0.25);
/// let mut encoder = ROLL.encoder();
/// let mut decoder = ROLL.decoder();
/// let spikes = [0.0, 0.3, 0.6, 0.6, 0.1].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [Spike::None, Spike::Up, Spike::Up, Spike::None, Spike::Down]);
/// assert_eq!(spikes.map(|s| decoder.decode(s)), [0.0, 0.25, 0.5, 0.5, 0.25]);
/// ```
///
/// A threshold that makes no sense does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::StepForward;
/// const ROLL: StepForward<f32> = StepForward::<f32>::checked(0.0);
/// # let _ = ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StepForward<S> {
    threshold: S,
}

impl<S: Sample> StepForward<S> {
    /// A scheme with this threshold, which is also the decoder's step.
    ///
    /// # Errors
    /// The threshold is not above 0, not finite, or above 10³¹.
    pub fn new(threshold: S) -> Result<Self, ConfigError> {
        step("threshold", threshold.to_f64())?;
        Ok(Self { threshold })
    }

    /// The threshold, in the samples' unit.
    pub fn threshold(&self) -> S {
        self.threshold
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path) => {
        impl<$($generics)*> StepForward<$sample> {
            /// For constants: a threshold that is not above 0, or above 10³¹, fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked(threshold: $sample) -> Self {
                checked!(step("threshold", $to_f64(threshold)));
                Self { threshold }
            }
        }
    };
}
for_each_sample!(constants);

impl<S: Sample> Scheme for StepForward<S> {
    type Sample = S;
    type Encoder = StepForwardEncoder<S>;
    type Decoder = StepDecoder<S>;

    const LATENCY: usize = 0;

    fn encoder(self) -> StepForwardEncoder<S> {
        StepForwardEncoder { threshold: self.threshold, base: S::ZERO, tally: Tally::default() }
    }

    fn decoder(self) -> StepDecoder<S> {
        StepDecoder::new(self.threshold)
    }
}

/// The encoder of [`StepForward`].
#[derive(Clone, Copy, Debug)]
pub struct StepForwardEncoder<S> {
    threshold: S,
    base: S,
    tally: Tally,
}

impl<S: Sample> StepForwardEncoder<S> {
    /// Sets the baseline, which else is the first sample; a decoder must be told, as by a keyframe. A
    /// value that is not finite is counted and ignored.
    pub fn prime(&mut self, base: S) {
        if base.is_finite() {
            self.base = base;
            self.tally.prime();
        } else {
            self.tally.reject();
        }
    }
}

/// Where a sample emits nothing.
#[derive(Clone, Copy)]
struct Band<S> {
    lower: S,
    base: S,
    upper: S,
}

impl<S: Sample> Band<S> {
    #[inline]
    fn around(base: S, threshold: S) -> Self {
        Self { lower: base.minus(threshold), base, upper: base.plus(threshold) }
    }

    /// So it is above what is not a number.
    #[inline]
    #[expect(clippy::neg_cmp_op_on_partial_ord, reason = "true of what is not a number")]
    fn is_above(self, sample: S) -> bool {
        !(sample >= self.lower)
    }
}

impl<S: Sample> Encoder for StepForwardEncoder<S> {
    type Sample = S;
    type Output = Spike;

    #[inline]
    fn encode(&mut self, sample: S) -> Spike {
        let band = Band::around(self.base, self.threshold);
        let (spike, base) = if sample > band.upper {
            (Spike::Up, band.upper)
        } else if band.is_above(sample) {
            (Spike::Down, band.lower)
        } else if self.tally.is_primed() {
            return Spike::None;
        } else {
            (Spike::None, sample)
        };
        if !sample.is_finite() {
            self.tally.reject();
            Spike::None
        } else if self.tally.is_primed() {
            self.base = base;
            spike
        } else {
            self.base = sample;
            self.tally.prime();
            Spike::None
        }
    }

    /// The band stays in registers, and whether all samples that left it were finite is asked once:
    /// if not, the slice is taken again with care.
    #[inline]
    fn encode_slice(&mut self, samples: &[S], spikes: &mut [Spike]) -> usize {
        let first = if self.tally.is_primed() { 0 } else { encode_first(self, samples, spikes) };
        let samples = samples.get(first..).unwrap_or_default();
        let spikes = spikes.get_mut(first..).unwrap_or_default();

        let threshold = self.threshold;
        let mut band = Band::around(self.base, threshold);
        let mut taint = S::ZERO;
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            *spike = Spike::None;
            if sample > band.upper {
                band = Band::around(band.upper, threshold);
                taint = taint.taint(sample);
                *spike = Spike::Up;
            } else if band.is_above(sample) {
                band = Band::around(band.lower, threshold);
                taint = taint.taint(sample);
                *spike = Spike::Down;
            }
        }
        if taint.is_finite() {
            self.base = band.base;
        } else {
            encode_each(self, samples, spikes);
        }
        first + samples.len().min(spikes.len())
    }

    /// The baseline.
    fn keyframe(&self) -> Option<S> {
        self.tally.is_primed().then_some(self.base)
    }

    fn reset(&mut self) {
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}
