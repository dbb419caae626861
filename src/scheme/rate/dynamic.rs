//! Rate codes whose filter length is chosen at run time.

use alloc::vec;
use alloc::vec::Vec;

use super::cursor::Cursor;
use super::decoder;
use super::encoder::{Rule, cells, decide_in_order, pairs, subtract};
use super::filter::magnitude;
use super::{Criterion, bsa, bsa_toolbox, hough, threshold_hough};
use crate::error::{offset, ratio, within};
use crate::num::{Nearer, Ratio, Residual, Tally, to_f64};
use crate::{ConfigError, Encoder, Fingerprint, Recovery, Sample, Scheme, Spike};

/// The most taps of a filter.
pub const LONGEST: usize = 4096;

/// Filter taps, 1 to 4096, on the heap.
#[derive(Clone, Debug, PartialEq)]
pub struct Taps<S: Sample> {
    /// The taps twice in a row, so that every rotation of them is one slice.
    twice: Vec<S>,
    magnitude: S::Residual,
}

impl<S: Sample> Taps<S> {
    /// Taps of any sign.
    ///
    /// # Errors
    /// Returns an error if there are none, or more than 4096; a tap is not finite, all are 0, or their magnitudes sum
    /// up to more than the type holds (10³¹ in `f32`).
    pub fn try_new(taps: &[S]) -> Result<Self, ConfigError> {
        within("filter length", taps.len() as f64, 1.0, LONGEST as f32)?;
        Ok(Self { magnitude: magnitude(taps)?, twice: [taps, taps].concat() })
    }

    /// The taps, first to last.
    pub fn as_slice(&self) -> &[S] {
        self.twice.get(self.length()..).unwrap_or_default()
    }

    fn length(&self) -> usize {
        self.twice.len() / 2
    }

    /// The taps, rotated so that the first is at index `slot`.
    fn starting_at(&self, slot: usize) -> &[S] {
        let length = self.length();
        let start = length.saturating_sub(slot);
        self.twice.get(start..start + length).unwrap_or_default()
    }

    /// A filter of one tap that is not 0, from which a rule is built. The rule never reads the tap.
    fn one(&self) -> Result<super::Taps<S, 1>, ConfigError> {
        let tap = self.twice.iter().copied().find(|&tap| tap != S::ZERO);
        super::Taps::try_new([tap.unwrap_or_default()])
    }
}

/// The state of a rate code's encoder: what past spikes have left of the last samples.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct RateState<S: Sample> {
    residuals: Vec<S::Residual>,
    cursor: Cursor,
    tally: Tally,
}

/// The state of a rate code's decoder: what past spikes add to the next values.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct RateDecoderState<S: Sample> {
    /// A ring of sums, of which the one in slot `next` belongs to the next value.
    pending: Vec<S::Residual>,
    next: u16,
}

/// A rate code that looks ahead over a filter of any length; `R` is its rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Rate<S: Sample, R> {
    taps: Taps<S>,
    shift: S,
    /// The rule: the scheme of fixed length, with a single tap that is unused.
    rule: R,
}

/// [`rate::Hough`](crate::rate::Hough) with a filter of any length.
pub type Hough<S> = Rate<S, hough::Hough<S, 1>>;

/// [`rate::ThresholdHough`](crate::rate::ThresholdHough) with a filter of any length.
pub type ThresholdHough<S> = Rate<S, threshold_hough::ThresholdHough<S, 1>>;

/// [`rate::Bsa`](crate::rate::Bsa) with a filter of any length.
pub type Bsa<S> = Rate<S, bsa::Bsa<S, 1>>;

impl<S: Sample> Hough<S> {
    /// A scheme with these taps.
    ///
    /// # Errors
    /// Never returns an error: every filter will do. It returns a `Result` as the other schemes do.
    pub fn try_new(taps: Taps<S>) -> Result<Self, ConfigError> {
        Ok(Self { rule: hough::Hough::new(taps.one()?), taps, shift: S::ZERO })
    }
}

impl<S: Sample> ThresholdHough<S> {
    /// A scheme with these taps and this threshold.
    ///
    /// # Errors
    /// Returns an error if the threshold is negative or not finite.
    pub fn try_new(taps: Taps<S>, threshold: S) -> Result<Self, ConfigError> {
        let rule = threshold_hough::ThresholdHough::try_new(taps.one()?, threshold)?;
        Ok(Self { taps, shift: S::ZERO, rule })
    }

    /// The largest error at which a sample spikes, in the samples' unit.
    pub fn threshold(&self) -> S {
        self.rule.threshold()
    }
}

impl<S: Sample> Bsa<S> {
    /// A scheme with these taps and this criterion.
    ///
    /// # Errors
    /// Returns an error if the threshold is out of its range, or not finite.
    pub fn try_new(taps: Taps<S>, criterion: Criterion<S>) -> Result<Self, ConfigError> {
        let rule = bsa::Bsa::try_new(taps.one()?, criterion)?;
        Ok(Self { taps, shift: S::ZERO, rule })
    }

    /// How it compares the two errors.
    pub fn criterion(&self) -> Criterion<S> {
        self.rule.criterion()
    }
}

/// The methods that [`Rate`] and [`BsaToolbox`] share: taps, shift and encoder.
macro_rules! filtered {
    () => {
        /// Sets the shift, the signal's minimum; 0 by default.
        ///
        /// # Errors
        /// Returns an error if the shift is not finite, or beyond ±10³¹ in `f32`.
        pub fn try_with_shift(self, shift: S) -> Result<Self, ConfigError> {
            offset("shift", to_f64(shift))?;
            Ok(Self { shift, ..self })
        }

        /// The taps of its filter.
        pub fn taps(&self) -> &Taps<S> {
            &self.taps
        }

        /// The signal's minimum.
        pub fn shift(&self) -> S {
            self.shift
        }

        /// An encoder in its initial state.
        pub fn encoder(&self) -> Encoder<'_, Self> {
            Encoder::with_state(self, self.state())
        }
    };
}

/// The methods of [`Scheme`] that [`Rate`] and [`BsaToolbox`] share; with the state of the encoder.
macro_rules! filtering {
    ($State:ty) => {
        fn fits(&self, state: &$State) -> bool {
            let length = self.taps.length();
            state.residuals.len() == length && state.cursor.fits(length)
        }

        fn rejected(state: &$State) -> u32 {
            state.tally.rejected()
        }

        fn recovery(&self) -> Recovery {
            Recovery::Samples(self.taps.length())
        }

        fn decoder_state(&self) -> RateDecoderState<S> {
            RateDecoderState { pending: vec![S::Residual::ZERO; self.taps.length()], next: 0 }
        }

        fn decode(&self, state: &mut RateDecoderState<S>, spike: Spike) -> S {
            let taps = |slot| self.taps.starting_at(slot);
            let RateDecoderState { pending, next } = state;
            self.shift.restore(decoder::decode(pending, next, taps, spike))
        }

        fn fits_decoder(&self, state: &RateDecoderState<S>) -> bool {
            let length = self.taps.length();
            state.pending.len() == length && usize::from(state.next) < length
        }

        /// Forgets past spikes. The value is unused, since the values of a rate code come from spikes alone.
        fn resync(&self, state: &mut RateDecoderState<S>, _: S) {
            *state = self.decoder_state();
        }
    };
}

#[allow(private_bounds)] // the rules are the crate's own
impl<S: Sample, R: Rule<S, 1>> Rate<S, R> {
    filtered!();

    /// The state of an encoder before its first sample.
    pub fn state(&self) -> RateState<S> {
        let length = self.taps.length();
        RateState {
            residuals: vec![S::Residual::ZERO; length],
            cursor: Cursor::new(length - 1),
            tally: Tally::NONE,
        }
    }

    /// The spike of the oldest residual, decided from the first tap on. At the end of a recording the window is
    /// shorter than the filter.
    fn decide_in_order(&self, state: &mut RateState<S>) -> Option<Spike> {
        let Taps { magnitude, .. } = self.taps;
        let (oldest, missing) = (state.cursor.oldest(self.taps.length()), state.cursor.missing());
        let residuals = cells(&mut state.residuals);
        decide_in_order(&self.rule, self.taps.as_slice(), magnitude, residuals, oldest, missing)
    }
}

#[allow(private_bounds)] // the rules are the crate's own
impl<S: Sample, R: Rule<S, 1>> Scheme for Rate<S, R> {
    type Sample = S;
    type Code = Spike;
    type Output = Option<Spike>;
    type EncoderState = RateState<S>;
    type DecoderState = RateDecoderState<S>;

    const LATENCY: usize = LONGEST - 1;
    const RECOVERY: Recovery = Recovery::Samples(LONGEST);

    fn fingerprint(&self) -> Fingerprint {
        self.rule.fingerprint().samples(self.taps.as_slice()).sample(self.shift)
    }

    fn encode(&self, state: &mut RateState<S>, sample: S) -> Option<Spike> {
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        let magnitude = self.taps.magnitude;
        *state.residuals.get_mut(state.cursor.next(self.taps.length()))? =
            sample.residual(self.shift, magnitude);
        if !state.cursor.advance(self.taps.length()) {
            return None;
        }
        if R::IN_ORDER {
            return self.decide_in_order(state);
        }
        let taps = self.taps.starting_at(state.cursor.next(self.taps.length()));
        let residuals = cells(&mut state.residuals);
        if !self.rule.fits(|| magnitude, pairs(residuals, taps), true) {
            return Some(Spike::None);
        }
        subtract(residuals, taps);
        Some(Spike::Up)
    }

    fn finish_next(&self, state: &mut RateState<S>) -> Option<Spike> {
        let is_left = state.cursor.pop(self.taps.length() - 1);
        is_left.then(|| self.decide_in_order(state)).flatten()
    }

    fn latency(&self) -> usize {
        self.taps.length() - 1
    }

    filtering!(RateState<S>);
}

/// [`rate::BsaToolbox`](crate::rate::BsaToolbox) with a filter of any length.
#[derive(Clone, Debug, PartialEq)]
pub struct BsaToolbox<S: Sample> {
    taps: Taps<S>,
    shift: S,
    ratio: Ratio,
}

/// The state of a [`BsaToolbox`] encoder.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct BsaToolboxState<S: Sample> {
    residuals: Vec<S::Residual>,
    cursor: Cursor,
    /// What the last sample's spike still subtracts from the next sample: its last tap, or 0 without a spike.
    owed: S::Residual,
    tally: Tally,
}

impl<S: Sample> BsaToolbox<S> {
    /// A scheme with these taps and this threshold.
    ///
    /// # Errors
    /// Returns an error if the threshold is not within 2⁻¹⁴ to 4 - 2⁻¹⁴.
    pub fn try_new(taps: Taps<S>, threshold: f32) -> Result<Self, ConfigError> {
        ratio("threshold", threshold)?;
        Ok(Self { taps, shift: S::ZERO, ratio: Ratio::new(threshold) })
    }

    filtered!();

    /// The state of an encoder before its first sample.
    pub fn state(&self) -> BsaToolboxState<S> {
        let length = self.taps.length();
        BsaToolboxState {
            residuals: vec![S::Residual::ZERO; length],
            cursor: Cursor::new(length),
            owed: S::Residual::ZERO,
            tally: Tally::NONE,
        }
    }
}

impl<S: Sample> Scheme for BsaToolbox<S> {
    type Sample = S;
    type Code = Spike;
    type Output = Option<Spike>;
    type EncoderState = BsaToolboxState<S>;
    type DecoderState = RateDecoderState<S>;

    const LATENCY: usize = LONGEST;
    const RECOVERY: Recovery = Recovery::Samples(LONGEST);

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("BsaToolbox")
            .sample(self.ratio.factor())
            .samples(self.taps.as_slice())
            .sample(self.shift)
    }

    fn encode(&self, state: &mut BsaToolboxState<S>, sample: S) -> Option<Spike> {
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        let residual = sample.residual(self.shift, self.taps.magnitude).minus(state.owed);
        state.owed = S::Residual::ZERO;
        let without = bsa_toolbox::without_filter::<S>(&state.residuals);
        *state.residuals.get_mut(state.cursor.next(self.taps.length()))? = residual;
        if !state.cursor.advance(self.taps.length()) {
            return None;
        }
        let oldest = state.cursor.next(self.taps.length());
        let with = bsa_toolbox::with_filter(&state.residuals, self.taps.starting_at(oldest));
        if !S::Residual::at_most(with, without, self.ratio) {
            return Some(Spike::None);
        }
        // The first tap belongs to the residual after the oldest, so that the last one belongs to the next sample.
        let kept = state.residuals.get(oldest).copied()?;
        subtract(cells(&mut state.residuals), self.taps.starting_at(oldest + 1));
        *state.residuals.get_mut(oldest)? = kept;
        state.owed = self.taps.as_slice().last()?.widen();
        Some(Spike::Up)
    }

    /// The last samples, as many as there are taps, never spike.
    fn finish_next(&self, state: &mut BsaToolboxState<S>) -> Option<Spike> {
        state.cursor.pop(self.taps.length()).then_some(Spike::None)
    }

    fn latency(&self) -> usize {
        self.taps.length()
    }

    filtering!(BsaToolboxState<S>);
}
