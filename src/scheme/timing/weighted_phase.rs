//! Weighted phase: a spike weighs half as much as one in the slot before, so that the slots are binary digits.

use core::ops::RangeInclusive;

use super::{PhaseBits, TimingState};
use crate::error::{range as check_range, tri, unwrap, within};
use crate::num::to_f64;
use crate::scheme::held::{Held, hold_value};
use crate::{ConfigError, Fingerprint, Recovery, Sample, SampleKind, Scheme, Start};

/// Weighted phase: the `K` slots of a sample are the binary digits of its place in the range, the highest first.
///
/// The place is `⌊2^K (x - min) / R⌋`, with `R = max - min`, or all ones from `max` on. A spike in slot `t` weighs
/// `2^-(t+1)`.
///
/// - **Range:** `min < max`; in `f32` `max - min` is at most `f32::MAX / 2`. **K:** 2 to 16, of which
///   [`with_slots`](Self::with_slots) may use fewer.
/// - **Latency:** 0 samples. **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes 12 bytes of flash
///   in `f32`.
/// - **Work:** in `f32` a division, and where the quotient falls on a cell's very edge a comparison and an addition a slot; in fixed
///   point a comparison and an addition a slot. No table.
/// - **Exactness:** fixed point is exact; `f32` rounds `x - min` and `R` once each.
/// - **Decoder:** the middle of the values with these digits. `f32` rounds `min + R (2q + 1) 2^-(K+1)` after each
///   operation.
/// - **Error:** `R / 2^(K+1)` within the range, in fixed point up to 1 unit of the last place more; none where
///   `2^K` exceeds `R` in units of the last place.
/// - **Silence** is a value: the lowest. A sample that is not finite has no spike, either.
///
/// Source: Kim et al., *Deep neural networks with weighted spikes*, 2018.
///
/// ```
/// use spikewire::{Code, Scheme, timing::WeightedPhase};
///
/// const LIGHT: WeightedPhase<i16, 4> = WeightedPhase::new(0..=999);
///
/// let spikes = LIGHT.encoder().encode(700);
/// assert!(spikes.firings().map(|firing| firing.slot).eq([0, 2, 3])); // 1011
/// assert_eq!(LIGHT.decoder().decode(spikes), 718);
/// ```
///
/// More than 16 slots do not compile:
///
/// ```compile_fail
/// # use spikewire::timing::WeightedPhase;
/// const LONG: WeightedPhase<i16, 17> = WeightedPhase::new(0..=999);
/// # let _ = LONG;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct WeightedPhase<S, const K: usize> {
    min: S,
    max: S,
    slots: u8,
}

impl<S: Sample, const K: usize> WeightedPhase<S, K> {
    const SHAPE: () = assert!(K >= 2 && K <= 16, "a sample has 2 to 16 digits");

    /// A scheme for a range, with `K` slots. For constants, where a bad range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>) -> Self {
        unwrap(Self::try_new(range))
    }

    /// A scheme for a range, with `K` slots.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite or do not rise; in `f32` `max - min` is more than `f32::MAX / 2`.
    pub const fn try_new(range: RangeInclusive<S>) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let (min, max) = (to_f64(*range.start()), to_f64(*range.end()));
        tri!(check_range(min, max));
        if matches!(S::KIND, SampleKind::F32) {
            tri!(within("max - min", max - min, 0.0, f32::MAX / 2.0));
        }
        Ok(Self { min: *range.start(), max: *range.end(), slots: K as u8 })
    }

    /// Uses this many slots instead of `K`. For constants, where a bad number fails the build.
    ///
    /// # Panics
    /// Panics if the number is not within 2 to `K`.
    #[must_use]
    pub const fn with_slots(self, slots: u8) -> Self {
        unwrap(self.try_with_slots(slots))
    }

    /// Uses this many slots instead of `K`.
    ///
    /// # Errors
    /// Returns an error if the number is not within 2 to `K`.
    pub const fn try_with_slots(self, slots: u8) -> Result<Self, ConfigError> {
        tri!(within("slots", slots as f64, 2.0, K as f32));
        Ok(Self { slots, ..self })
    }

    /// How many of the lowest digits of a code are unused.
    #[inline]
    fn unused(&self) -> u32 {
        (K as u32).wrapping_sub(self.slots.into()) & 15
    }
}

impl<S: Sample, const K: usize> Start for WeightedPhase<S, K> {
    const START: TimingState = TimingState::START;
}

impl<S: Sample, const K: usize> Scheme for WeightedPhase<S, K> {
    type Sample = S;
    type Code = PhaseBits<K>;
    type Output = PhaseBits<K>;
    type EncoderState = TimingState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    /// Every code gives a value by itself, also one without a spike.
    const RECOVERY: Recovery = Recovery::Samples(1);

    fn fingerprint(&self) -> Fingerprint {
        let Self { min, max, slots } = *self;
        Fingerprint::new("WeightedPhase").sample(min).sample(max).number(slots.into())
    }

    #[inline]
    fn encode(&self, state: &mut TimingState, sample: S) -> PhaseBits<K> {
        let Some(sample) = state.accept(sample) else { return PhaseBits::SILENT };
        // All digits that there is room for: a loop of constant length.
        let digits = sample.digits(self.min, self.max, K as u32);
        PhaseBits::new((digits >> self.unused() << self.unused()) as u16)
    }

    /// The value of a sample without a spike.
    fn decoder_state(&self) -> Held<S> {
        Held::at(S::of_digits(0, self.slots.into(), self.min, self.max))
    }

    #[inline]
    fn decode(&self, state: &mut Held<S>, bits: PhaseBits<K>) -> S {
        let digits = u32::from(bits.digits()) >> self.unused();
        state.or_hold(Some(S::of_digits(digits, self.slots.into(), self.min, self.max)))
    }

    hold_value!(TimingState);

    fn slots(&self) -> usize {
        self.slots.into()
    }
}
