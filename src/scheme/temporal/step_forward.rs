//! Step forward (SF): a spike when the signal leaves the band around a baseline that follows the signal.

use super::StepState;
use super::band::{Band, follow_baseline};
use super::steps::decode_steps;
use crate::error::{step, tri, unwrap};
use crate::num::{HAS_VECTORS, Tally, groups, groups_mut, to_f64};
use crate::scheme::codec::{encode_each, encode_first};
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Step forward: the baseline starts at the first sample and follows the signal by one threshold with each
/// spike.
///
/// If `x > base + threshold`: [`Spike::Up`] and `base += threshold`; if `x < base - threshold`:
/// [`Spike::Down`] and `base -= threshold`.
///
/// - **Threshold:** above 0, in the samples' unit; up to 10³¹ in `f32`, so that no band reaches infinity.
/// - **Latency:** 0 samples. **Memory:** 8 bytes a channel in `f32`, 4 to decode.
/// - **Exactness:** `f32` rounds `base ± threshold` once; fixed point is exact.
/// - **Error:** while `|x[i] - x[i-1]| <= threshold`, the decoded value stays within the threshold
///   of the signal. It never overshoots.
/// - **Silence:** a constant signal gives no spike once the baseline is within a threshold of it. A larger threshold
///   gives fewer spikes as a rule, but not always: `0, 3, 5, 1` gives two with a threshold of 1, and three with 2.
///
/// Source: paper, section II-C, algorithm 7 (whose second `base + threshold` is a slip for `-`).
///
/// ```
/// use spikewire::{Scheme, Spike, temporal::StepForward};
///
/// const ROLL: StepForward<f32> = StepForward::new(0.25);
/// let mut encoder = ROLL.encoder();
/// let mut decoder = ROLL.decoder();
/// let spikes = [0.0, 0.3, 0.6, 0.6, 0.1].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [Spike::None, Spike::Up, Spike::Up, Spike::None, Spike::Down]);
/// assert_eq!(spikes.map(|s| decoder.decode(s)), [0.0, 0.25, 0.5, 0.5, 0.25]);
/// ```
///
/// A bad threshold does not compile:
///
/// ```compile_fail
/// # use spikewire::temporal::StepForward;
/// const ROLL: StepForward<f32> = StepForward::new(0.0);
/// # let _ = ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StepForward<S> {
    threshold: S,
}

impl<S: Sample> StepForward<S> {
    /// A scheme with this threshold, which is also the decoder's step. For constants, where a bad threshold
    /// fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not above 0, not finite, or above 10³¹.
    pub const fn new(threshold: S) -> Self {
        unwrap(Self::try_new(threshold))
    }

    /// A scheme with this threshold, which is also the decoder's step.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, not finite, or above 10³¹.
    pub const fn try_new(threshold: S) -> Result<Self, ConfigError> {
        tri!(step("threshold", to_f64(threshold)));
        Ok(Self { threshold })
    }

    /// The threshold, in the samples' unit.
    pub const fn threshold(&self) -> S {
        self.threshold
    }

    /// The state of an encoder with this baseline, so that its first sample counts from there instead of becoming the
    /// baseline itself; see [`SendOnDelta::state_at`](super::SendOnDelta::state_at).
    pub const fn state_at(baseline: S) -> StepForwardState<S> {
        match Tally::of_baseline(baseline) {
            Some(tally) => StepForwardState { base: baseline, tally },
            None => Self::START,
        }
    }
}

/// The state of a [`StepForward`] encoder: the baseline. 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepForwardState<S> {
    base: S,
    tally: Tally,
}

/// How many samples are compared with the band at once, if the core has vectors.
const GROUP: usize = 4;

/// After how many samples in a row without a spike the next ones are compared in groups. Where spikes are denser, a
/// processor predicts the branches of single samples better than those of groups.
const QUIET: usize = 8;

impl<S: Sample> Start for StepForward<S> {
    const START: StepForwardState<S> =
        StepForwardState { base: S::NO_BASELINE, tally: Tally::NONE };
}

impl<S: Sample> Scheme for StepForward<S> {
    type Sample = S;
    type Code = Spike;
    type Output = Spike;
    type EncoderState = StepForwardState<S>;
    type DecoderState = StepState<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Keyframe;

    fn holds_keyframes(&self) -> bool {
        true
    }

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("StepForward").sample(self.threshold)
    }

    #[inline]
    fn encode(&self, state: &mut StepForwardState<S>, sample: S) -> Spike {
        let band = Band::around(state.base, self.threshold);
        let (spike, base) = if band.is_below(sample) {
            (Spike::Up, band.upper())
        } else if band.is_above(sample) {
            (Spike::Down, band.lower())
        } else if state.base != S::NO_BASELINE {
            return Spike::None;
        } else {
            (Spike::None, state.base) // none yet, or a baseline of that very value
        };
        if !sample.is_finite() {
            state.tally.reject();
            Spike::None
        } else if state.tally.is_primed() {
            state.base = base;
            spike
        } else {
            state.base = sample;
            state.tally.prime();
            Spike::None
        }
    }

    /// The band stays in registers, and one check at the end asks whether all samples that left it were finite: if
    /// not, the slice is encoded again, sample by sample.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut StepForwardState<S>,
        samples: &[S],
        spikes: &mut [impl Destination<Spike>],
    ) -> usize {
        let (first, samples, spikes) =
            encode_first(self, state.tally.is_primed(), state, samples, spikes);

        let threshold = self.threshold;
        let mut band = Band::around(state.base, threshold);
        let mut check = S::ZERO;
        let (mut ahead, mut free) = (samples, &mut *spikes);
        while !ahead.is_empty() {
            let (mut last, mut taken) = (0, ahead.len());
            // `enumerate` would check its count for overflow.
            for ((spike, &sample), index) in free.iter_mut().zip(ahead).zip(0..ahead.len()) {
                spike.write(Spike::None);
                if band.is_below(sample) {
                    band = band.raised(threshold);
                    check = check.including(sample);
                    spike.write(Spike::Up);
                    last = index;
                } else if band.is_above(sample) {
                    band = band.lowered(threshold);
                    check = check.including(sample);
                    spike.write(Spike::Down);
                    last = index;
                } else if HAS_VECTORS && index.wrapping_sub(last) == QUIET {
                    taken = index.wrapping_add(1);
                    break;
                }
            }
            ahead = ahead.get(taken..).unwrap_or_default();
            free = free.get_mut(taken..).unwrap_or_default();
            taken = pass_groups(band, ahead, free);
            ahead = ahead.get(taken..).unwrap_or_default();
            free = free.get_mut(taken..).unwrap_or_default();
        }
        if check.is_finite() {
            state.base = band.base();
        } else {
            encode_each(self, state, samples, spikes);
        }
        first + samples.len()
    }

    follow_baseline!(StepForwardState);

    decode_steps!(threshold);
}

/// Writes that the first groups of samples have no spike, as far as they lie within the band, and returns how many
/// samples these are: none on a core without vectors.
#[inline]
fn pass_groups<S: Sample>(
    band: Band<S>,
    samples: &[S],
    spikes: &mut [impl Destination<Spike>],
) -> usize {
    let (groups, _) = groups::<_, GROUP>(samples);
    let (spikes, _) = groups_mut::<_, GROUP>(spikes);
    let quiet = spikes.iter_mut().zip(groups).take_while(|(_, samples)| {
        samples.iter().fold(true, |is_quiet, &sample| is_quiet & band.holds(sample))
    });
    let written =
        quiet.map(|(spikes, _)| spikes.iter_mut().for_each(|spike| spike.write(Spike::None)));
    GROUP.wrapping_mul(written.count())
}
