//! Integrate and fire: spikes of two directions whose sum follows the integral of the signal.

use core::hint::black_box;

use crate::error::{offset, step, tri, unwrap, within};
use crate::num::{Tally, Total, to_f64};
use crate::scheme::codec::encode_each;
use crate::scheme::temporal::with_most;
use crate::temporal::Steps;
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Start};

/// Integrate and fire (IF), and with [`leaky`](Self::leaky) leaky integrate and fire (LIF): a potential adds up the
/// signal, and fires when it reaches the threshold.
///
/// `V += x - reference`. Then, with at most `K` spikes: while `V >= threshold`: a spike up, and `V -= threshold`; while
/// `V <= -threshold`: a spike down, and `V += threshold`. `V` starts at 0. Leaky: before the sample is added,
/// `V -= V / 2^k`, in fixed point rounded towards 0. The `n` spikes of a sample have one polarity and fire in the
/// sub-timesteps `0..n` of `K`. The decoder is a leaky potential itself: `U -= U / 2^k`, `U += n threshold`, and the
/// value is `reference + U / 2^k`, in fixed point rounded to the nearest, halves upwards.
///
/// - **Threshold:** above 0, in the samples' unit times a sample; up to 10³¹ in `f32`. **Power `k`:** 1 to 15: the value
///   is a mean over about `2^k` samples. **Reference:** 0 by default. **K:** 1 to 127.
/// - **Latency:** 0 samples; the mean is that of the past. **Memory:** 8 bytes a channel in `f32` and of 16 bits, 16 of
///   32-bit fixed point; 4 and 8 to decode.
/// - **Work:** a sum, two comparisons, and one a spike.
/// - **Exactness:** `f32` rounds every sum once; fixed point is exact. In `f32` a sample with which the potential is not
///   finite counts as not finite itself; potentials in fixed point saturate, those of 16 bits at
///   2³¹ units, those of 32 bits at 2⁶².
/// - **Error:** while `|x - reference| <= K threshold`, IF keeps `Σ(x - reference) = threshold Σn + V`, `|V| < threshold`:
///   a gyroscope's angle never drifts. A decoded value is near the same leaky mean of the samples: within
///   `2 threshold / 2^k + 3` (IF), `threshold / 2^k + 3` (LIF), where the 3 are units of fixed point, from rounding.
/// - **Silence:** LIF does not fire for a signal that stays below about `threshold / 2^k`.
///
/// Source: Lazar and Tóth, *Perfect recovery and sensitivity analysis of time encoded bandlimited signals*, 2004; Moser
/// and Lunglmayr, *Quantization in spiking neural networks*, 2023.
///
/// ```
/// use spikewire::{Scheme, rate::IntegrateAndFire};
///
/// const ROLL: IntegrateAndFire<i16, 4> = IntegrateAndFire::new(10, 3);
/// let mut encoder = ROLL.encoder();
/// let spikes = [12, 12, -30, 45].map(|x| encoder.encode(x).count());
/// assert_eq!(spikes, [1, 1, -2, 3]); // 39 in 4 samples: 3 spikes up in sum, and 9 are left
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IntegrateAndFire<S, const K: usize = 1> {
    threshold: S,
    reference: S,
    power: u8,
    is_leaky: bool,
    most: i8,
}

/// The longest mean, as a power of two.
const MOST_POWER: u8 = 15;

impl<S: Sample, const K: usize> IntegrateAndFire<S, K> {
    const SHAPE: () = assert!(K >= 1 && K <= 127, "a sample has 1 to 127 spikes at most");

    /// A scheme with this threshold, which decodes to a mean over about `2^power` samples. For constants, where bad
    /// parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(threshold: S, power: u8) -> Self {
        unwrap(Self::try_new(threshold, power))
    }

    /// A scheme with this threshold, which decodes to a mean over about `2^power` samples.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0, not finite, or above 10³¹; the power is not within 1 to 15.
    pub const fn try_new(threshold: S, power: u8) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        tri!(step("threshold", to_f64(threshold)));
        tri!(within("power of the mean", power as f64, 1.0, MOST_POWER as f32));
        Ok(Self { threshold, reference: S::ZERO, power, is_leaky: false, most: K as i8 })
    }

    /// Makes the potential leak: LIF.
    #[must_use]
    pub const fn leaky(self) -> Self {
        Self { is_leaky: true, ..self }
    }

    /// Sets the reference, the value without spikes; 0 by default. For constants, where a bad value fails the build.
    ///
    /// # Panics
    /// Panics if the reference is not within 10³¹ of 0.
    #[must_use]
    pub const fn with_reference(self, reference: S) -> Self {
        unwrap(self.try_with_reference(reference))
    }

    /// Sets the reference, the value without spikes; 0 by default.
    ///
    /// # Errors
    /// Returns an error if the reference is not within 10³¹ of 0.
    pub const fn try_with_reference(self, reference: S) -> Result<Self, ConfigError> {
        tri!(offset("reference", to_f64(reference)));
        Ok(Self { reference, ..self })
    }

    with_most!();

    /// The threshold, in the samples' unit times a sample.
    pub const fn threshold(&self) -> S {
        self.threshold
    }

    /// The reference, the value without spikes.
    pub const fn reference(&self) -> S {
        self.reference
    }

    /// The power `k` of the leak and of the decoder's mean, which is over about `2^k` samples.
    pub const fn power(&self) -> u8 {
        self.power
    }

    /// Whether the potential leaks.
    pub const fn is_leaky(&self) -> bool {
        self.is_leaky
    }

    #[inline]
    fn unit(&self) -> S::Total {
        self.threshold.offset_from(S::ZERO)
    }

    /// Adds a sample to a potential, and fires. Returns the potential that is left, and the number of spikes, negative if
    /// they go down. Without spikes it is finite.
    #[inline]
    fn advance(&self, mut potential: S::Total, sample: S) -> (S::Total, i32) {
        if self.is_leaky {
            potential = potential.leaked(self.power);
        }
        potential = potential.plus(sample.offset_from(self.reference));
        let (threshold, most) = (self.unit(), i32::from(self.most));
        let lowest = S::Total::ZERO.minus(threshold);
        let mut steps = 0_i32;
        // Only a potential that may not fire any more can be beyond the threshold, and need the cap.
        if potential >= threshold {
            loop {
                stay_rolled();
                potential = potential.minus(threshold);
                steps = steps.wrapping_add(1);
                if steps >= most {
                    return (potential.capped(), steps);
                }
                if potential < threshold {
                    return (potential, steps);
                }
            }
        }
        if potential > lowest {
            return (potential, 0);
        }
        loop {
            stay_rolled();
            potential = potential.plus(threshold);
            steps = steps.wrapping_sub(1);
            if steps <= most.wrapping_neg() {
                return (potential.capped(), steps);
            }
            if potential > lowest {
                return (potential, steps);
            }
        }
    }
}

/// Keeps the compiler from unrolling the loop it is in. On a Cortex-M0, the only core without atomic exchange, the loop
/// would take more instructions.
#[inline]
fn stay_rolled() {
    if cfg!(target_has_atomic = "32") {
        black_box(());
    }
}

/// The state of an [`IntegrateAndFire`] encoder: the potential. 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
#[allow(private_bounds)] // sums are the crate's own
pub struct IntegrateAndFireState<S: Sample> {
    potential: S::Total,
    tally: Tally,
}

/// The state of an [`IntegrateAndFire`] decoder: a leaky potential. 4 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct PotentialState<S: Sample> {
    potential: S::Total,
}

impl<S: Sample, const K: usize> Start for IntegrateAndFire<S, K> {
    const START: IntegrateAndFireState<S> =
        IntegrateAndFireState { potential: S::Total::ZERO, tally: Tally::NONE };
}

impl<S: Sample, const K: usize> Scheme for IntegrateAndFire<S, K> {
    type Sample = S;
    type Code = Steps<K>;
    type Output = Steps<K>;
    type EncoderState = IntegrateAndFireState<S>;
    type DecoderState = PotentialState<S>;

    const LATENCY: usize = 0;
    /// Ten times the longest mean.
    const RECOVERY: Recovery = Recovery::Fading(10 << MOST_POWER);

    fn fingerprint(&self) -> Fingerprint {
        let Self { threshold, reference, power, is_leaky, most } = *self;
        Fingerprint::new("IntegrateAndFire")
            .sample(threshold)
            .sample(reference)
            .number(power.into())
            .number(is_leaky.into())
            .number(most.unsigned_abs().into())
    }

    #[inline]
    fn encode(&self, state: &mut IntegrateAndFireState<S>, sample: S) -> Steps<K> {
        let (potential, steps) = self.advance(state.potential, sample);
        if steps != 0 && !potential.is_finite() {
            state.tally.reject();
            return Steps::within(0);
        }
        state.potential = potential;
        Steps::within(steps as i8)
    }

    /// The potential stays in registers. One that is not finite stays so, and is looked at once, at the end.
    #[inline]
    fn encode_slice(
        &self,
        state: &mut IntegrateAndFireState<S>,
        samples: &[S],
        outputs: &mut [impl Destination<Steps<K>>],
    ) -> usize {
        let mut potential = state.potential;
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            let (left, steps) = self.advance(potential, sample);
            potential = left;
            output.write(Steps::within(steps as i8));
        }
        if potential.is_finite() {
            state.potential = potential;
            samples.len().min(outputs.len())
        } else {
            encode_each(self, state, samples, outputs)
        }
    }

    fn rejected(state: &IntegrateAndFireState<S>) -> u32 {
        state.tally.rejected()
    }

    fn decoder_state(&self) -> PotentialState<S> {
        PotentialState { potential: S::Total::ZERO }
    }

    #[inline]
    fn decode(&self, state: &mut PotentialState<S>, steps: Steps<K>) -> S {
        let step = self.unit().times(steps.count().into());
        state.potential = state.potential.leaked(self.power).plus(step);
        self.reference.raised(state.potential.halved_to_nearest(self.power))
    }

    fn resync(&self, state: &mut PotentialState<S>, value: S) {
        state.potential = value.offset_from(self.reference).doubled(self.power);
    }

    fn slots(&self) -> usize {
        self.most.unsigned_abs().into()
    }
}
