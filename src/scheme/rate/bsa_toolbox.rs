//! Ben's spiker (BSA) with the indices of the paper's toolbox, which differ from the published algorithm's.

use super::Taps;
use super::cursor::Cursor;
use super::decoder::{RateDecoderState, decode_rate};
use super::encoder::{cells, subtract};
use super::filtered::{Filtered, with_shift};
use crate::error::{ratio, tri, unwrap};
use crate::num::{Nearer, Ratio, Residual, Tally};
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// Ben's spiker algorithm with the indices behind the paper's tables: the filter is compared one sample later, and
/// subtracted two samples later, than in [`Bsa`](super::Bsa).
///
/// With `r = x - shift`, `e1 = sum |r[i+j+1] - h[j]|` and `e2 = sum |r[i+j]|`: a spike at `i` if
/// `e1 <= e2 * threshold`; then `r[i+j+2] -= h[j]`. The last `F` samples of a recording never spike.
///
/// - **Threshold:** 2⁻¹⁴ to 4 - 2⁻¹⁴; with samples in fixed point it is rounded to a multiple of 2⁻¹⁴.
/// - **Latency:** `F` samples. **Memory:** `4 F + 12` bytes a channel in `f32`.
/// - **Exactness:** that of a multiplicative [`Bsa`](super::Bsa), where the window of `e1` begins at `i + 1`.
///
/// Source: paper, section II-B, algorithm 5.
///
/// ```
/// use spikewire::{Scheme, rate::{BsaToolbox, Taps}};
///
/// static LIFT: BsaToolbox<f32, 9> = BsaToolbox::new(Taps::triangular(1.0), 1.15);
///
/// let mut encoder = LIFT.encoder();
/// let first = (0..).find(|_| encoder.encode(1.0).is_some());
/// assert_eq!(first, Some(LIFT.latency()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BsaToolbox<S: Sample, const F: usize> {
    filtered: Filtered<S, F>,
    ratio: Ratio,
}

impl<S: Sample, const F: usize> BsaToolbox<S, F> {
    /// A scheme with these taps and this threshold. For constants, where a bad threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not within 2⁻¹⁴ to 4 - 2⁻¹⁴.
    pub const fn new(taps: Taps<S, F>, threshold: f32) -> Self {
        unwrap(Self::try_new(taps, threshold))
    }

    /// A scheme with these taps and this threshold.
    ///
    /// # Errors
    /// Returns an error if the threshold is not within 2⁻¹⁴ to 4 - 2⁻¹⁴.
    pub const fn try_new(taps: Taps<S, F>, threshold: f32) -> Result<Self, ConfigError> {
        tri!(ratio("threshold", threshold));
        Ok(Self { filtered: Filtered::new(taps), ratio: Ratio::new(threshold) })
    }

    with_shift!();

    /// The threshold: the factor of `e2`.
    pub const fn threshold(&self) -> f32 {
        self.ratio.factor()
    }

    #[inline(always)]
    fn encode_one(
        &self,
        residuals: &mut [S::Residual; F],
        state: &mut Registers<S::Residual>,
        sample: S,
    ) -> Option<Spike> {
        let taps = &self.filtered.taps;
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        let residual = self.filtered.residual(sample).minus(state.owed);
        state.owed = S::Residual::ZERO;
        let without = without_filter::<S>(residuals);
        let newest = state.cursor.next(F);
        *residuals.get_mut(newest)? = residual;
        if !state.cursor.advance(F) {
            return None;
        }
        let with = with_filter(residuals, taps.starting_at(newest + 1));
        if !S::Residual::at_most(with, without, self.ratio) {
            return Some(Spike::None);
        }
        // The first tap belongs to the residual after the oldest, so that the last one belongs to the next sample.
        let oldest = state.cursor.next(F);
        let kept = residuals.get(oldest).copied()?;
        subtract(cells(residuals), taps.starting_at(oldest + 1));
        *residuals.get_mut(oldest)? = kept;
        state.owed = taps.as_array().last()?.widen();
        Some(Spike::Up)
    }
}

/// The state of a [`BsaToolbox`] encoder. `4 F + 12` bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct BsaToolboxState<S: Sample, const F: usize> {
    registers: Registers<S::Residual>,
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    residuals: [S::Residual; F],
}

/// The state besides the residuals, which a slice keeps in registers.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Registers<R> {
    /// What the last sample's spike still subtracts from the next sample: its last tap, or 0 without a spike.
    owed: R,
    cursor: Cursor,
    tally: Tally,
}

impl<R: Residual> Registers<R> {
    /// The state before the first sample, with this many taps.
    const fn new(length: usize) -> Self {
        Self { owed: R::ZERO, cursor: Cursor::new(length), tally: Tally::NONE }
    }
}

/// The sum of `|r|` over the window.
#[inline]
pub(super) fn without_filter<S: Sample>(residuals: &[S::Residual]) -> <S::Residual as Nearer>::Sum {
    let pairs = residuals.iter().map(|&residual| (residual, S::Residual::ZERO));
    S::Residual::distance(S::SHORT, pairs)
}

/// The sum of `|r - h|` over the window.
#[inline]
pub(super) fn with_filter<S: Sample>(
    residuals: &[S::Residual],
    taps: &[S],
) -> <S::Residual as Nearer>::Sum {
    let pairs = residuals.iter().zip(taps).map(|(&residual, tap)| (residual, tap.widen()));
    S::Residual::distance(S::SHORT, pairs)
}

impl<S: Sample, const F: usize> Start for BsaToolbox<S, F> {
    const START: BsaToolboxState<S, F> =
        BsaToolboxState { registers: Registers::new(F), residuals: [S::Residual::ZERO; F] };
}

impl<S: Sample, const F: usize> Scheme for BsaToolbox<S, F> {
    type Sample = S;
    type Code = Spike;
    type Output = Option<Spike>;
    type EncoderState = BsaToolboxState<S, F>;
    type DecoderState = RateDecoderState<S, F>;

    const LATENCY: usize = F;
    const RECOVERY: Recovery = Recovery::Samples(F);

    fn fingerprint(&self) -> Fingerprint {
        let Filtered { taps, shift } = &self.filtered;
        Fingerprint::new("BsaToolbox")
            .sample(self.ratio.factor())
            .samples(taps.as_array())
            .sample(*shift)
    }

    #[inline]
    fn encode(&self, state: &mut BsaToolboxState<S, F>, sample: S) -> Option<Spike> {
        let mut registers = state.registers;
        let spike = self.encode_one(&mut state.residuals, &mut registers, sample);
        state.registers = registers;
        spike
    }

    #[inline]
    fn encode_slice(
        &self,
        state: &mut BsaToolboxState<S, F>,
        samples: &[S],
        spikes: &mut [impl Destination<Option<Spike>>],
    ) -> usize {
        let mut registers = state.registers;
        for (spike, &sample) in spikes.iter_mut().zip(samples) {
            spike.write(self.encode_one(&mut state.residuals, &mut registers, sample));
        }
        state.registers = registers;
        samples.len().min(spikes.len())
    }

    /// The last `F` samples never spike.
    fn finish_next(&self, state: &mut BsaToolboxState<S, F>) -> Option<Spike> {
        state.registers.cursor.pop(F).then_some(Spike::None)
    }

    fn fits(&self, state: &BsaToolboxState<S, F>) -> bool {
        state.registers.cursor.fits(F)
    }

    fn rejected(state: &BsaToolboxState<S, F>) -> u32 {
        state.registers.tally.rejected()
    }

    decode_rate!();
}

#[cfg(feature = "serde")]
super::filtered::serialize_filtered!(BsaToolbox, "threshold", ratio);
