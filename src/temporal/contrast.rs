//! Temporal contrast (TBR): a spike when one sample differs enough from the one before.

use super::StepDecoder;
use crate::codec::{encode_each, encode_first};
use crate::error::{checked, positive};
use crate::sample::{Tally, for_each_sample};
use crate::{Calibration, ConfigError, Encoder, Sample, Scheme, Spike};

/// Temporal contrast, also called temporal-based representation (TBR): what event cameras do.
///
/// With `d = x[i] - x[i-1]`: [`Spike::Up`] if `d > threshold`, [`Spike::Down`] if
/// `d < -threshold`. The first sample has no predecessor and emits nothing, unless the encoder was
/// [primed](TemporalContrastEncoder::prime).
///
/// - **Threshold:** above 0, in the samples' unit. **Step** of the decoder: the threshold, unless
///   chosen apart.
/// - **Latency:** 0 samples. **Memory:** 12 bytes an encoder in `f32`.
/// - **Exactness:** `f32` rounds `d` once; fixed point compares exact differences.
/// - **Error:** the decoded value drifts without bound, since a difference within the threshold is
///   never made up for. Resynchronise it.
///
/// Source: paper, section II-C, algorithm 6.
///
/// ```
/// use spikewire::{Encoder, Scheme, Spike, temporal::TemporalContrast};
///
/// const RATE: TemporalContrast<f32> = TemporalContrast::<f32>::checked(0.5);
/// let mut encoder = RATE.encoder();
/// let spikes = [0.0, 0.6, 0.9, 0.2].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [Spike::None, Spike::Up, Spike::None, Spike::Down]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TemporalContrast<S> {
    threshold: S,
    step: S,
}

impl<S: Sample> TemporalContrast<S> {
    /// A scheme whose decoder steps by the threshold.
    ///
    /// # Errors
    /// The threshold is not above 0, or not finite.
    pub fn new(threshold: S) -> Result<Self, ConfigError> {
        Self::with_step(threshold, threshold)
    }

    /// A scheme whose decoder steps by `step`; the paper's figures take twice the threshold.
    ///
    /// # Errors
    /// The threshold or the step is not above 0, or not finite.
    pub fn with_step(threshold: S, step: S) -> Result<Self, ConfigError> {
        positive("threshold", threshold.to_f64())?;
        positive("step", step.to_f64())?;
        Ok(Self { threshold, step })
    }

    /// The paper's threshold, `mean(d) + factor * std(d)`, over the differences of a calibration.
    ///
    /// # Errors
    /// The calibration saw fewer than three samples, or the threshold comes out at 0 or below, as
    /// it does for a signal that falls more than it varies: then use
    /// [`from_magnitudes`](Self::from_magnitudes).
    pub fn from_calibration(
        calibration: &Calibration<S>,
        factor: f32,
    ) -> Result<Self, ConfigError> {
        Self::new(S::from_f64(calibration.differences()?.threshold(factor)?))
    }

    /// `mean(|d|) + factor * std(|d|)`: above 0 for any signal that moves, if `factor` is not
    /// negative.
    ///
    /// # Errors
    /// The calibration saw fewer than three samples, or a signal that never moved.
    pub fn from_magnitudes(calibration: &Calibration<S>, factor: f32) -> Result<Self, ConfigError> {
        Self::new(S::from_f64(calibration.magnitudes()?.threshold(factor)?))
    }

    /// The threshold, in the samples' unit.
    pub fn threshold(&self) -> S {
        self.threshold
    }

    /// The decoder's step, in the samples' unit.
    pub fn step(&self) -> S {
        self.step
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path) => {
        impl<$($generics)*> TemporalContrast<$sample> {
            /// For constants: a threshold that is not above 0 fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked(threshold: $sample) -> Self {
                Self::checked_with_step(threshold, threshold)
            }

            /// For constants: a threshold or step that is not above 0 fails the build.
            ///
            /// # Panics
            /// On such a value; at compile time where it initialises a constant.
            pub const fn checked_with_step(threshold: $sample, step: $sample) -> Self {
                checked!(positive("threshold", $to_f64(threshold)));
                checked!(positive("step", $to_f64(step)));
                Self { threshold, step }
            }
        }
    };
}
for_each_sample!(constants);

impl<S: Sample> Scheme for TemporalContrast<S> {
    type Sample = S;
    type Encoder = TemporalContrastEncoder<S>;
    type Decoder = StepDecoder<S>;

    const LATENCY: usize = 0;

    fn encoder(self) -> TemporalContrastEncoder<S> {
        TemporalContrastEncoder {
            threshold: self.threshold,
            previous: S::ZERO,
            tally: Tally::default(),
        }
    }

    fn decoder(self) -> StepDecoder<S> {
        StepDecoder::new(self.step)
    }
}

/// The encoder of [`TemporalContrast`].
#[derive(Clone, Copy, Debug)]
pub struct TemporalContrastEncoder<S> {
    threshold: S,
    previous: S,
    tally: Tally,
}

impl<S: Sample> TemporalContrastEncoder<S> {
    /// Sets the predecessor of the next sample. A value that is not finite is counted and ignored.
    pub fn prime(&mut self, previous: S) {
        if previous.is_finite() {
            self.previous = previous;
            self.tally.prime();
        } else {
            self.tally.reject();
        }
    }
}

impl<S: Sample> Encoder for TemporalContrastEncoder<S> {
    type Sample = S;
    type Output = Spike;

    #[inline]
    fn encode(&mut self, sample: S) -> Spike {
        if !self.tally.is_primed() || !sample.is_finite() {
            self.prime(sample);
            return Spike::None;
        }
        let previous = core::mem::replace(&mut self.previous, sample);
        sample.step(previous, self.threshold)
    }

    /// The last sample stays in a register, and whether all were finite is asked once: if not, the
    /// slice is taken again with care.
    #[inline]
    fn encode_slice(&mut self, samples: &[S], spikes: &mut [Spike]) -> usize {
        let first = if self.tally.is_primed() { 0 } else { encode_first(self, samples, spikes) };
        let samples = samples.get(first..).unwrap_or_default();
        let spikes = spikes.get_mut(first..).unwrap_or_default();

        let mut previous = self.previous;
        let mut taint = S::ZERO;
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            taint = taint.taint(sample);
            *spike = sample.step(previous, self.threshold);
            previous = sample;
        }
        if taint.is_finite() {
            self.previous = previous;
        } else {
            encode_each(self, samples, spikes);
        }
        first + samples.len().min(spikes.len())
    }

    /// The last sample.
    fn keyframe(&self) -> Option<S> {
        self.tally.is_primed().then_some(self.previous)
    }

    fn reset(&mut self) {
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}
