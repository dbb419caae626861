//! Filters of second order: low-pass and notch.

use super::design::{BUTTERWORTH, Numerator, check, check_q, section};
use super::{Filter, Filtered};
use crate::error::{tri, unwrap};
use crate::num::{Recursive, Section};
use crate::{ConfigError, Fingerprint, Sample, Scheme};

/// A low-pass or a notch of second order.
///
/// - **Response:** that of Robert Bristow-Johnson's cookbook, as Betaflight's; PX4's low-pass is the same. -3 dB at the
///   corner of a low-pass by Butterworth, `20 log q` with another `q`; 0 at the centre of a notch, which is some
///   `centre / q` wide between -3 dB and -3 dB.
/// - **Corner or centre:** 0.001 to 0.49 of the rate. **q:** 0.1 to 100.
/// - **Delay:** at DC `1 / (2 q tan(pi corner / rate))` samples: 5.5 ms with 40 Hz by Butterworth at 500 samples a second.
/// - **Memory:** 16 bytes; a state 8 in `f32`, 16 in 16 bits, 24 in 32 bits.
/// - **Work:** in `f32` three products and five sums a sample.
/// - **Saturation:** fixed point overshoots up to the ends of the type, and goes on from there.
///
/// # Operations
/// `gain`, `damping` and `tap` are the filter's three coefficients, each rounded once from all its digits. `f32` keeps
/// a level and a slope, and rounds each operation, from left to right:
///
/// ```text
/// error  = x - level                       output = level + tap * change
/// change = gain * error - damping * slope  slope += change; level += slope
/// ```
///
/// Fixed point has coefficients of 29 fraction bits, and keeps two samples, a slope and an output, which has 11 fraction
/// bits more than a sample of 16 bits, and 24 more than one of 32. `floor` rounds down to the output's last place:
///
/// ```text
/// error   = x[i-1] - output
/// bend    = x[i] - 2 x[i-1] + x[i-2]
/// slope  += gain * error + tap * bend - damping * floor(slope)
/// output += floor(slope)                   y = the nearest sample, halves upwards
/// ```
///
/// With 16 bits `slope` has 29 bits more than the output, so that no bit of a product is lost. With 32 bits each of the
/// three products is rounded down to the output's last place. If the output would not round to a sample of the type,
/// it becomes the last that does, and the slope what the output changed by.
///
/// ```
/// use spikewire::filter::{Biquad, Filter};
///
/// const HOVER: Biquad<f32> = Biquad::notch(250.0, 1000.0, 2.0);
/// let mut state = Biquad::<f32>::START;
/// let mut output = 0.0;
/// for sample in [1.0, 3.0, 1.0, -1.0].repeat(20) {
///     output = HOVER.filter(&mut state, sample); // a mean of 1, and a line of 250 Hz
/// }
/// assert!((output - 1.0).abs() < 0.01);
/// assert_eq!(Biquad::<f32>::try_low_pass(500.0, 1000.0).unwrap_err().to_string(),
///     "corner 500 must lie in 1..=490");
/// ```
///
/// A corner above half of the rate does not compile:
///
/// ```compile_fail
/// # use spikewire::filter::Biquad;
/// const ROLL: Biquad<f32> = Biquad::low_pass(300.0, 500.0);
/// # let _ = ROLL;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad<S: Sample> {
    section: Section<S::Coefficient>,
    rate: f32,
}

impl<S: Sample> Biquad<S> {
    /// A low-pass with this corner, of samples at this rate, both in Hz: Butterworth's, flat up to the corner. For
    /// constants, where a bad corner fails the build.
    ///
    /// # Panics
    /// Panics if the rate is not above 0, or the corner is not within 0.001 to 0.49 of it.
    pub const fn low_pass(corner: f32, rate: f32) -> Self {
        Self::low_pass_with_q(corner, rate, BUTTERWORTH)
    }

    /// A low-pass with this corner, of samples at this rate, both in Hz: Butterworth's, flat up to the corner.
    ///
    /// # Errors
    /// Returns an error if the rate is not above 0, or the corner is not within 0.001 to 0.49 of it.
    pub const fn try_low_pass(corner: f32, rate: f32) -> Result<Self, ConfigError> {
        Self::try_low_pass_with_q(corner, rate, BUTTERWORTH)
    }

    /// A low-pass with this corner, of samples at this rate, both in Hz, and this gain at the corner. Several of
    /// different `q` make a filter of higher order: 0.541 and 1.307 Butterworth's of fourth order. For constants, where
    /// bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if the rate is not above 0, the corner is not within 0.001 to 0.49 of it, or `q` is not within 0.1 to 100.
    pub const fn low_pass_with_q(corner: f32, rate: f32, q: f32) -> Self {
        unwrap(Self::try_low_pass_with_q(corner, rate, q))
    }

    /// A low-pass with this corner, of samples at this rate, both in Hz, and this gain at the corner.
    ///
    /// # Errors
    /// Returns an error if the rate is not above 0, the corner is not within 0.001 to 0.49 of it, or `q` is not within
    /// 0.1 to 100.
    pub const fn try_low_pass_with_q(corner: f32, rate: f32, q: f32) -> Result<Self, ConfigError> {
        Self::designed(Numerator::LowPass, "corner", corner, rate, q)
    }

    /// A notch at this frequency, of samples at this rate, both in Hz; `q` is the centre over the width between -3 dB
    /// and -3 dB. For constants, where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if the rate is not above 0, the centre is not within 0.001 to 0.49 of it, or `q` is not within 0.1 to 100.
    pub const fn notch(centre: f32, rate: f32, q: f32) -> Self {
        unwrap(Self::try_notch(centre, rate, q))
    }

    /// A notch at this frequency, of samples at this rate, both in Hz; `q` is the centre over the width between -3 dB
    /// and -3 dB.
    ///
    /// # Errors
    /// Returns an error if the rate is not above 0, the centre is not within 0.001 to 0.49 of it, or `q` is not within
    /// 0.1 to 100.
    pub const fn try_notch(centre: f32, rate: f32, q: f32) -> Result<Self, ConfigError> {
        Self::designed(Numerator::Notch, "centre", centre, rate, q)
    }

    const fn designed(
        numerator: Numerator,
        name: &'static str,
        corner: f32,
        rate: f32,
        q: f32,
    ) -> Result<Self, ConfigError> {
        tri!(check(name, corner, rate));
        tri!(check_q(q));
        Ok(Self { section: section::<S>(numerator, corner, rate, q), rate })
    }

    /// A scheme that encodes what this filter lets through.
    #[must_use]
    pub const fn before<P: Scheme<Sample = S>>(self, scheme: P) -> Filtered<Self, P> {
        Filtered::new(self, scheme)
    }
}

impl<S: Sample> Biquad<S> {
    /// The coefficients as they are, not as they are stored.
    fn values(&self) -> Section<f64> {
        let Section { gain, damping, tap } = self.section;
        let [gain, damping, tap] = [gain, damping, tap].map(S::value);
        Section { gain, damping, tap }
    }
}

#[cfg(feature = "serde")]
impl<S: Sample> serde::Serialize for Biquad<S> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        self.values().serialize(serializer)
    }
}

#[cfg(feature = "defmt")]
impl<S: Sample> defmt::Format for Biquad<S> {
    fn format(&self, f: defmt::Formatter<'_>) {
        let Section { gain, damping, tap } = self.values();
        defmt::write!(f, "Biquad {{ gain: {}, damping: {}, tap: {} }}", gain, damping, tap);
    }
}

/// The state of a [`Biquad`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct BiquadState<S: Sample>(<S as Recursive>::Second);

impl<S: Sample> Filter for Biquad<S> {
    type Sample = S;
    type State = BiquadState<S>;

    const START: BiquadState<S> = BiquadState(<S as Recursive>::SECOND);

    fn fingerprint(&self) -> Fingerprint {
        let Section { gain, damping, tap } = self.values();
        Fingerprint::new("Biquad").double(gain).double(damping).double(tap)
    }

    #[inline]
    fn filter(&self, state: &mut BiquadState<S>, sample: S) -> S {
        sample.second(self.section, &mut state.0)
    }

    #[inline]
    fn filter_slice(&self, state: &mut BiquadState<S>, samples: &[S], outputs: &mut [S]) -> usize {
        S::second_slice(self.section, &mut state.0, samples, outputs);
        samples.len().min(outputs.len())
    }

    fn rate(&self) -> Option<f32> {
        Some(self.rate)
    }

    fn delay(&self) -> f32 {
        let Section { gain, damping, .. } = self.values();
        (damping / gain) as f32
    }
}
