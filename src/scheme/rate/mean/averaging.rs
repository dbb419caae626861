//! The decoders of a mean: over a window of samples, or as an average in which old samples fade.

use core::fmt::Debug;

use crate::error::{tri, unwrap, within};
use crate::num::{Stored, Total};
use crate::{ConfigError, Fingerprint, Recovery, Sample};

/// How a decoder takes the mean of spikes: [`Window`] or [`Average`]. Sealed.
pub trait Averaging: Copy + Debug + PartialEq + sealed::Averaging {}

pub(super) mod sealed {
    use super::{Debug, Fingerprint, Recovery, Stored, Total, Weight};

    pub trait Averaging {
        /// What the decoder keeps from sample to sample.
        type State<T: Total>: Clone + Debug + Stored;

        const RECOVERY: Recovery;

        /// The description goes on with this mean.
        fn describe(&self, scheme: Fingerprint) -> Fingerprint;

        fn start<T: Total>(&self, weight: &Weight<T>) -> Self::State<T>;

        /// Takes a sample, which had a spike or not, and returns the mean above the minimum.
        fn take<T: Total>(
            &self,
            state: &mut Self::State<T>,
            is_spike: bool,
            weight: &Weight<T>,
        ) -> T;

        /// Goes on from a known mean; a window, which cannot, starts again.
        fn resync<T: Total>(&self, state: &mut Self::State<T>, mean: T, weight: &Weight<T>);
    }
}

/// The state of the decoder of a mean.
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent, bound = ""))]
#[allow(private_bounds)] // sums are the crate's own
pub struct MeanState<S: Sample, A: Averaging>(pub(super) A::State<S::Total>);

impl<S: Sample, A: Averaging> Clone for MeanState<S, A> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<S: Sample, A: Averaging> Debug for MeanState<S, A> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("MeanState").field(&self.0).finish()
    }
}

/// The decoding half of a mean code's [`Scheme`](crate::Scheme). The weight of a spike comes from the method `weight`
/// of the scheme, or of its field `$of`.
macro_rules! decode_mean {
    ($($of:ident)?) => {
        fn decoder_state(&self) -> MeanState<S, A> {
            MeanState(self.averaging.start(&self.$($of.)?weight()))
        }

        #[inline]
        fn decode(&self, state: &mut MeanState<S, A>, spike: Spike) -> S {
            let mean = self.averaging.take(&mut state.0, spike == Spike::Up, &self.$($of.)?weight());
            self.range.min.raised(mean)
        }

        /// An average goes on from the value; a window forgets its spikes.
        fn resync(&self, state: &mut MeanState<S, A>, value: S) {
            let mean = self.range.above_min(value).unwrap_or(S::Total::ZERO);
            self.averaging.resync(&mut state.0, mean, &self.$($of.)?weight());
        }
    };
}
pub(super) use decode_mean;

/// The weight of a spike: `unit * 2^g`, where `g` counts the spikes right before it, up to `doublings`.
#[derive(Clone, Copy, Debug)]
pub struct Weight<T> {
    pub(super) unit: T,
    pub(super) doublings: u8,
    /// The width of the range: an average starts in its middle.
    pub(super) range: T,
}

/// How many spikes came right before, up to the doublings: the `g` of [`Weight`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Gain(pub(super) u8);

impl Gain {
    pub(super) const NONE: Self = Self(0);

    /// Counts a sample's spike; a sample without one sets the count to 0.
    #[inline]
    pub(super) fn take(&mut self, is_spike: bool, doublings: u8) {
        self.0 = if is_spike { self.0.saturating_add(1).min(doublings) } else { 0 };
    }
}

/// The mean over the last `2^w` samples, `2^w <= 32 WORDS`.
///
/// It starts as if there had been no spike: at the minimum. Integers are rounded to the nearest, halves upwards.
///
/// - **Memory:** `4 WORDS + 8` bytes a channel.
/// - **After a loss:** exact again after `32 WORDS + 32` samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Window<const WORDS: usize = 1> {
    power: u8,
}

impl<const WORDS: usize> Window<WORDS> {
    const MOST: u32 = {
        assert!(WORDS >= 1 && WORDS <= 128, "a window has 1 to 4096 samples");
        32 * WORDS as u32
    };

    /// A window of the last `2^power` samples. For constants, where a bad number fails the build.
    ///
    /// # Panics
    /// Panics if `2^power` is more than `32 WORDS`.
    pub const fn new(power: u8) -> Self {
        unwrap(Self::try_new(power))
    }

    /// A window of the last `2^power` samples.
    ///
    /// # Errors
    /// Returns an error if `2^power` is more than `32 WORDS`.
    pub const fn try_new(power: u8) -> Result<Self, ConfigError> {
        tri!(within("power of the window", power as f64, 0.0, Self::MOST.ilog2() as f32));
        Ok(Self { power })
    }

    /// How many samples the mean is taken over: `2^power`.
    pub const fn samples(&self) -> usize {
        1 << self.power
    }
}

impl<const WORDS: usize> Averaging for Window<WORDS> {}

/// Which of the last samples had a spike, one bit each, and the sum of these spikes' weights.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spikes<const WORDS: usize> {
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    bits: [u32; WORDS],
    /// The place of the oldest bit, which the next one replaces.
    oldest: u16,
    /// The gain of the oldest sample, and that of the next one.
    first: Gain,
    last: Gain,
    /// In units of the smallest weight.
    sum: u32,
}

impl<const WORDS: usize> sealed::Averaging for Window<WORDS> {
    type State<T: Total> = Spikes<WORDS>;

    const RECOVERY: Recovery = Recovery::Samples(32 * WORDS + 32);

    fn describe(&self, scheme: Fingerprint) -> Fingerprint {
        scheme.number(0).number(self.power.into())
    }

    fn start<T: Total>(&self, _: &Weight<T>) -> Spikes<WORDS> {
        Spikes { bits: [0; WORDS], oldest: 0, first: Gain::NONE, last: Gain::NONE, sum: 0 }
    }

    #[inline]
    fn take<T: Total>(&self, state: &mut Spikes<WORDS>, is_spike: bool, weight: &Weight<T>) -> T {
        let place = usize::from(state.oldest);
        let mask = 1_u32.wrapping_shl(place as u32);
        if let Some(word) = state.bits.get_mut(place / 32) {
            let was_spike = *word & mask != 0;
            if was_spike {
                state.sum = state.sum.wrapping_sub(1 << (state.first.0 & 31));
            }
            state.first.take(was_spike, weight.doublings);
            if is_spike {
                state.sum = state.sum.wrapping_add(1 << (state.last.0 & 31));
            }
            state.last.take(is_spike, weight.doublings);
            *word = if is_spike { *word | mask } else { *word & !mask };
        }
        state.oldest = (place as u16).wrapping_add(1)
            & (1_u16.wrapping_shl(self.power.into()).wrapping_sub(1));
        weight.unit.times(state.sum.cast_signed()).halved_to_nearest(self.power)
    }

    fn resync<T: Total>(&self, state: &mut Spikes<WORDS>, _: T, weight: &Weight<T>) {
        *state = self.start(weight);
    }
}

/// An average over about the last `2^k` samples, of which the older count less: `z = z - (z >> k) + weight`.
///
/// It starts in the middle of the range. Integers are rounded down.
///
/// - **Memory:** 8 bytes a channel in `f32`.
/// - **After a loss:** its error fades, by a factor of 20 in `3 * 2^k` samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Average {
    power: u8,
}

impl Average {
    const MOST: u8 = 15;

    /// An average over about the last `2^power` samples. For constants, where a bad number fails the build.
    ///
    /// # Panics
    /// Panics if the power is not within 1 to 15.
    pub const fn new(power: u8) -> Self {
        unwrap(Self::try_new(power))
    }

    /// An average over about the last `2^power` samples.
    ///
    /// # Errors
    /// Returns an error if the power is not within 1 to 15.
    pub const fn try_new(power: u8) -> Result<Self, ConfigError> {
        tri!(within("power of the average", power as f64, 1.0, Self::MOST as f32));
        Ok(Self { power })
    }
}

impl Averaging for Average {}

/// The average, times `2^k`.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Faded<T> {
    sum: T,
    gain: Gain,
}

impl sealed::Averaging for Average {
    type State<T: Total> = Faded<T>;

    /// Ten times the longest average.
    const RECOVERY: Recovery = Recovery::Fading(10 << Self::MOST);

    fn describe(&self, scheme: Fingerprint) -> Fingerprint {
        scheme.number(1).number(self.power.into())
    }

    fn start<T: Total>(&self, weight: &Weight<T>) -> Faded<T> {
        Faded { sum: weight.range.doubled(self.power.wrapping_sub(1)), gain: Gain::NONE }
    }

    #[inline]
    fn take<T: Total>(&self, state: &mut Faded<T>, is_spike: bool, weight: &Weight<T>) -> T {
        let mut sum = state.sum.minus(state.sum.halved(self.power));
        if is_spike {
            sum = sum.plus(weight.unit.doubled(state.gain.0));
        }
        state.gain.take(is_spike, weight.doublings);
        state.sum = sum;
        sum.halved(self.power)
    }

    fn resync<T: Total>(&self, state: &mut Faded<T>, mean: T, _: &Weight<T>) {
        *state = Faded { sum: mean.doubled(self.power), gain: Gain::NONE };
    }
}
