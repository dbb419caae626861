//! Hough spiker (HSA): a spike where the whole filter fits under the signal.

use super::Taps;
use super::decoder::{RateDecoderState, decode_rate};
use super::encoder::{RateState, Rule, rate_scheme};
use super::filtered::{Filtered, with_shift};
use crate::error::unwrap;
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Spike, Start};

/// The Hough spike algorithm (HSA).
///
/// With the signal `x`, the taps `h` and `r = x - shift`: a spike at `i` if `r[i+j] >= h[j]` for all `j`; then `r[i+j]
/// -= h[j]`. The last `F - 1` samples of a recording, over which the filter does not fit, never spike.
///
/// - **Latency:** `F - 1` samples. **Memory:** `4 F + 8` bytes a channel in `f32`, and `16 F` of residuals on the
///   stack for slices, at most 424 bytes of stack in all with 15 taps on a Cortex-M4F.
/// - **Exactness:** `f32` rounds `x - shift` and each subtraction once; fixed point is exact within
///   the range of [`rate`](crate::rate).
/// - **Error:** up to rounding, the decoded value never exceeds the signal. It stays at the shift
///   where the signal is too low or too short for the filter.
///
/// Source: paper, section II-B, algorithm 3.
///
/// ```
/// use spikewire::{Scheme, Spike, rate::{Hough, Taps}};
///
/// static LIFT: Hough<f32, 3> = Hough::new(Taps::triangular(1.0)); // 0.5, 1, 0.5
///
/// let mut encoder = LIFT.encoder();
/// let spikes = [0.6, 1.2, 0.7, 0.0].map(|x| encoder.encode(x));
/// assert_eq!(spikes, [None, None, Some(Spike::Up), Some(Spike::None)]);
/// assert_eq!(LIFT.latency(), 2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(transparent, bound = "S: serde::Serialize")
)]
pub struct Hough<S: Sample, const F: usize> {
    filtered: Filtered<S, F>,
}

impl<S: Sample, const F: usize> Hough<S, F> {
    /// A scheme with these taps.
    pub const fn new(taps: Taps<S, F>) -> Self {
        Self { filtered: Filtered::new(taps) }
    }

    with_shift!();
}

/// A sample spikes if every residual reaches its tap.
impl<S: Sample, const F: usize> Rule<S, F> for Hough<S, F> {
    const IN_ORDER: bool = true;
    const KEEPS_A_SUM: bool = false;

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("Hough")
    }

    #[inline(always)]
    fn filtered(&self) -> &Filtered<S, F> {
        &self.filtered
    }

    #[inline(always)]
    fn fits(
        &self,
        _: impl FnOnce() -> S::Residual,
        mut pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
        is_whole: bool,
    ) -> bool {
        pairs.all(|(residual, tap)| residual >= tap) && is_whole
    }
}

rate_scheme!(Hough);
