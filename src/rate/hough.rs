//! Hough spiker (HSA): a spike where the whole filter fits under the signal.

use super::decoder::RateDecoder;
use super::encoder::{RateEncoder, Rule};
use super::filter::Taps;
use super::residual::Residual;
use crate::error::offset;
use crate::{ConfigError, Sample, Scheme};

/// The Hough spike algorithm.
///
/// With `r = x - shift`: a spike at `i` if `r[i+j] >= h[j]` for all `j`; then `r[i+j] -= h[j]`.
/// At the end of a recording a window that is cut never spikes.
///
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 16` bytes an encoder in `f32`, and `16 F` of
///   stack for slices; the taps are in flash, shared.
/// - **Exactness:** `f32` rounds `x - shift` and each subtraction once; fixed point is exact within
///   the range of [`rate`](crate::rate).
/// - **Error:** up to rounding, the decoded value never exceeds the signal. It stays at the shift
///   where the signal is too low or too short for the filter.
///
/// Source: paper, section II-B, algorithm 3.
///
/// ```
/// use spikewire::{Encoder, Scheme, Spike, rate::{Hough, Taps}};
///
/// static TAPS: Taps<f32, 3> = Taps::<f32, _>::triangular(1.0); // 0.5, 1, 0.5
/// const LIFT: Hough<f32, 3> = Hough::new(&TAPS);
///
/// let mut encoder = LIFT.encoder();
/// let spikes = [0.6, 1.2, 0.7, 0.0].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [None, None, Some(Spike::Up), Some(Spike::None)]);
/// assert_eq!(LIFT.latency(), 2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Hough<'a, S, const F: usize> {
    taps: &'a Taps<S, F>,
    shift: S,
}

impl<'a, S: Sample, const F: usize> Hough<'a, S, F> {
    /// A scheme for signals whose minimum is 0.
    pub const fn new(taps: &'a Taps<S, F>) -> Self {
        Self { taps, shift: S::ZERO }
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

impl<'a, S: Sample, const F: usize> Scheme for Hough<'a, S, F> {
    type Sample = S;
    type Encoder = RateEncoder<'a, S, HoughRule, F>;
    type Decoder = RateDecoder<'a, S, F>;

    const LATENCY: usize = F - 1;

    fn encoder(self) -> Self::Encoder {
        RateEncoder::new(self.taps, self.shift, HoughRule)
    }

    fn decoder(self) -> Self::Decoder {
        RateDecoder::new(self.taps, self.shift)
    }
}

/// Every residual reaches its tap.
#[derive(Clone, Copy, Debug)]
pub struct HoughRule;

impl<R: Residual> Rule<R> for HoughRule {
    const IN_ORDER: bool = true;

    #[inline(always)]
    fn fits(&self, mut pairs: impl Iterator<Item = (R, R)>, is_whole: bool) -> bool {
        pairs.all(|(residual, tap)| residual >= tap) && is_whole
    }

    #[inline(always)]
    fn fits_by_slot(&self, pairs: impl Iterator<Item = (R, R)>) -> Option<bool> {
        Some(self.fits(pairs, true))
    }
}
