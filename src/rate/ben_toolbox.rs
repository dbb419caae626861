//! Ben's spiker (BSA) with the indices of the paper's toolbox.

use super::cursor::Cursor;
use super::decoder::RateDecoder;
use super::encoder::{cells, subtract};
use super::filter::Taps;
use super::residual::Residual;
use crate::error::{checked, offset, ratio};
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
/// - **Exactness:** as [`Ben`](super::Ben), multiplicative; the window of `e1` begins at `i + 1`.
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
    /// The shift is not finite, or beyond ±10³¹ in `f32`.
    pub fn with_shift(self, shift: S) -> Result<Self, ConfigError> {
        offset("shift", shift.to_f64())?;
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
            state: State::new(),
            residuals: [S::Residual::ZERO; F],
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
    state: State<S::Residual, F>,
    residuals: [S::Residual; F],
}

/// What changes with a sample, besides the residuals: kept in registers over a slice.
#[derive(Clone, Copy, Debug)]
struct State<R, const F: usize> {
    /// The last tap of a spike just emitted, to be taken from the sample to come.
    owed: R,
    cursor: Cursor<F>,
    tally: Tally,
}

impl<R: Residual, const F: usize> State<R, F> {
    fn new() -> Self {
        Self { owed: R::ZERO, cursor: Cursor::new(F), tally: Tally::default() }
    }
}

/// The sum of `|r|` over the window.
#[inline]
fn without_filter<R: Residual>(residuals: &[R]) -> R::Sum {
    residuals.iter().fold(R::no_sum(), |sum, residual| residual.add_distance(R::ZERO, sum))
}

/// The sum of `|r - h|` over the window.
#[inline]
fn with_filter<S: Sample>(residuals: &[S::Residual], taps: &[S]) -> <S::Residual as Residual>::Sum {
    let pairs = residuals.iter().zip(taps);
    pairs
        .fold(S::Residual::no_sum(), |sum, (residual, tap)| residual.add_distance(tap.widen(), sum))
}

impl<S: Sample, const F: usize> BenToolboxEncoder<'_, S, F> {
    #[inline(always)]
    fn encode_one(&mut self, sample: S, state: &mut State<S::Residual, F>) -> Option<Spike> {
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        let residual = sample.residual(self.shift, self.taps.magnitude()).minus(state.owed);
        state.owed = S::Residual::ZERO;
        let without = without_filter(&self.residuals);
        let newest = state.cursor.next();
        *self.residuals.get_mut(newest)? = residual;
        if !state.cursor.advance() {
            return None;
        }
        let with = with_filter(&self.residuals, self.taps.starting_at(newest + 1));
        if !S::Residual::at_most(with, without, self.ratio) {
            return Some(Spike::None);
        }
        // The taps begin one residual after the oldest; the last of them is left over.
        let oldest = state.cursor.next();
        let kept = self.residuals.get(oldest).copied()?;
        subtract(cells(&mut self.residuals), self.taps.starting_at(oldest + 1));
        *self.residuals.get_mut(oldest)? = kept;
        state.owed = self.taps.as_array().last()?.widen();
        Some(Spike::Up)
    }
}

impl<S: Sample, const F: usize> Encoder for BenToolboxEncoder<'_, S, F> {
    type Sample = S;
    type Output = Option<Spike>;

    #[inline]
    fn encode(&mut self, sample: S) -> Option<Spike> {
        let mut state = self.state;
        let spike = self.encode_one(sample, &mut state);
        self.state = state;
        spike
    }

    #[inline]
    fn encode_slice(&mut self, samples: &[S], spikes: &mut [Option<Spike>]) -> usize {
        let mut state = self.state;
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            *spike = self.encode_one(sample, &mut state);
        }
        self.state = state;
        samples.len().min(spikes.len())
    }

    /// The last `F` samples never spike.
    fn finish_next(&mut self) -> Option<Spike> {
        if self.state.cursor.missing() >= F {
            return None;
        }
        self.state.cursor.pop();
        Some(Spike::None)
    }

    fn reset(&mut self) {
        self.state = State::new();
    }

    fn rejected(&self) -> u32 {
        self.state.tally.rejected()
    }
}
