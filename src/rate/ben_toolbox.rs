//! Ben's spiker (BSA) with the indices of the paper's toolbox.

use super::decoder::RateDecoder;
use super::filter::Taps;
use super::lookahead::Lookahead;
use super::residual::Residual;
use crate::error::{checked, finite, ratio};
use crate::sample::{Tally, for_each_sample};
use crate::{ConfigError, Encoder, Sample, Scheme, Spike};

/// Ben's spiker algorithm as the paper's tables were made with: the filter is compared one sample
/// later and subtracted two samples later than in [`Ben`](super::Ben).
///
/// With `r = x - shift`, `e1 = sum |r[i+j+1] - h[j]|` and `e2 = sum |r[i+j]|`: a spike at `i` if
/// `e1 <= e2 * threshold`; then `r[i+j+2] -= h[j]`. The last `F` samples of a recording never spike.
///
/// - **Threshold:** above 0 and below 4; with samples in fixed point it is rounded to a multiple of
///   2⁻¹⁴.
/// - **Latency:** `F` samples. **Memory:** `4 F + 24` bytes an encoder in `f32`; the taps are in
///   flash, shared.
/// - **Exactness:** as [`Ben`](super::Ben), multiplicative.
///
/// Source: paper, section II-B, algorithm 5.
///
/// ```
/// use spikewire::{Encoder, Scheme, rate::{BenToolbox, Taps}};
///
/// static TAPS: Taps<f32, 9> = Taps::<f32, _>::triangular(1.0);
/// const LIFT: BenToolbox<f32, 9> = BenToolbox::<f32, _>::checked(&TAPS, 1.15);
///
/// let mut encoder = LIFT.encoder();
/// let first = (0..).find(|_| encoder.encode(1.0).is_some());
/// assert_eq!(first, Some(LIFT.latency()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BenToolbox<'a, S, const F: usize> {
    taps: &'a Taps<S, F>,
    threshold: f32,
    shift: S,
}

impl<'a, S: Sample, const F: usize> BenToolbox<'a, S, F> {
    /// A scheme for signals whose minimum is 0.
    ///
    /// # Errors
    /// The threshold is not above 0 and below 4.
    pub fn new(taps: &'a Taps<S, F>, threshold: f32) -> Result<Self, ConfigError> {
        ratio("threshold", threshold)?;
        Ok(Self { taps, threshold, shift: S::ZERO })
    }

    /// The same for signals with this minimum.
    ///
    /// # Errors
    /// The shift is not finite.
    pub fn with_shift(self, shift: S) -> Result<Self, ConfigError> {
        finite("shift", shift.to_f64())?;
        Ok(Self { shift, ..self })
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path) => {
        impl<'a, const F: usize, $($generics)*> BenToolbox<'a, $sample, F> {
            /// For constants: a threshold that is not above 0 and below 4 fails the build.
            ///
            /// # Panics
            /// On such a threshold; at compile time where it initialises a constant.
            pub const fn checked(taps: &'a Taps<$sample, F>, threshold: f32) -> Self {
                checked!(ratio("threshold", threshold));
                Self { taps, threshold, shift: $nearest(0.0) }
            }
        }
    };
}
for_each_sample!(constants);

impl<'a, S: Sample, const F: usize> Scheme for BenToolbox<'a, S, F> {
    type Sample = S;
    type Encoder = BenToolboxEncoder<'a, S, F>;
    type Decoder = RateDecoder<'a, S, F>;

    const LATENCY: usize = F;

    fn encoder(self) -> Self::Encoder {
        BenToolboxEncoder {
            taps: self.taps,
            shift: self.shift,
            ratio: S::Residual::ratio(self.threshold),
            residuals: Lookahead::new(),
            owed: S::Residual::ZERO,
            tally: Tally::default(),
        }
    }

    fn decoder(self) -> Self::Decoder {
        RateDecoder::new(self.taps, self.shift)
    }
}

/// The encoder of [`BenToolbox`].
#[derive(Clone, Copy, Debug)]
pub struct BenToolboxEncoder<'a, S: Sample, const F: usize> {
    taps: &'a Taps<S, F>,
    shift: S,
    ratio: <S::Residual as Residual>::Ratio,
    residuals: Lookahead<S::Residual, F>,
    /// The last tap of a spike just emitted, to be taken from the sample to come.
    owed: S::Residual,
    tally: Tally,
}

impl<S: Sample, const F: usize> BenToolboxEncoder<'_, S, F> {
    /// The sum of `|r|` over the window.
    #[inline]
    fn without_filter(&self) -> <S::Residual as Residual>::Sum {
        let mut sum = S::Residual::no_sum();
        for (residuals, _) in self.residuals.window(self.taps.as_array()) {
            for residual in residuals {
                sum = residual.add_distance(S::Residual::ZERO, sum);
            }
        }
        sum
    }

    /// The sum of `|r - h|` over the window.
    #[inline]
    fn with_filter(&self) -> <S::Residual as Residual>::Sum {
        let mut sum = S::Residual::no_sum();
        for (residuals, taps) in self.residuals.window(self.taps.as_array()) {
            for (residual, tap) in residuals.iter().zip(taps) {
                sum = residual.add_distance(tap.widen(), sum);
            }
        }
        sum
    }

    /// Subtracts the filter from one sample after the window's first on.
    #[inline]
    fn subtract(&mut self) {
        let taps = self.taps.as_array();
        self.residuals.subtract_later(taps);
        self.owed = taps.last().map_or(S::Residual::ZERO, |tap| tap.widen());
    }
}

impl<S: Sample, const F: usize> Encoder for BenToolboxEncoder<'_, S, F> {
    type Sample = S;
    type Output = Option<Spike>;

    #[inline]
    fn encode(&mut self, sample: S) -> Option<Spike> {
        if !sample.is_finite() {
            self.tally.reject();
            return None;
        }
        let residual = sample.residual(self.shift, self.taps.magnitude()).minus(self.owed);
        self.owed = S::Residual::ZERO;
        if !self.residuals.is_full() {
            self.residuals.push(residual);
            return None;
        }
        let without = self.without_filter();
        self.residuals.push(residual);
        if S::Residual::at_most(self.with_filter(), without, self.ratio) {
            self.subtract();
            Some(Spike::Up)
        } else {
            Some(Spike::None)
        }
    }

    /// The last `F` samples never spike.
    fn finish_next(&mut self) -> Option<Spike> {
        if self.residuals.is_empty() {
            return None;
        }
        self.residuals.pop();
        Some(Spike::None)
    }

    fn reset(&mut self) {
        self.residuals = Lookahead::new();
        self.owed = S::Residual::ZERO;
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}
