//! The low-pass of first order.

use super::design::{check, first_order};
use super::{Filter, Filtered};
use crate::error::{tri, unwrap};
use crate::num::Recursive;
use crate::{ConfigError, Fingerprint, Sample, Scheme};

/// A low-pass of first order: the output follows the samples by a part of what it lacks.
///
/// - **Response:** one pole, as Betaflight's PT1 and PX4's alpha filter, but with -3 dB exactly at the corner.
/// - **Corner:** 0.001 to 0.49 of the rate.
/// - **Delay:** at DC `1 / gain - 1` samples: 3.1 ms with 40 Hz at 500 samples a second.
/// - **Memory:** 8 bytes; a state 4 in `f32`, 8 in fixed point.
/// - **Work:** in `f32` one product and two sums a sample.
///
/// # Operations
/// `output += gain * (x - output)`. `f32` rounds each operation once. Fixed point has a gain of 29 fraction bits, and
/// `y` is the output's nearest sample, halves upwards. With 16 bits the output has 40 fraction bits more than a sample,
/// and is rounded down to 11 of them before `x - output`. With 32 bits it has 24, to which the product is rounded down.
///
/// ```
/// use spikewire::filter::{Filter, FirstOrder};
///
/// const BARO: FirstOrder<i16> = FirstOrder::low_pass(2.0, 50.0);
/// let mut state = FirstOrder::<i16>::START;
/// let outputs = [100, 200, 200, 200, 200].map(|sample| BARO.filter(&mut state, sample));
/// assert_eq!(outputs, [100, 122, 139, 153, 163]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder<S: Sample> {
    gain: S::Coefficient,
    rate: f32,
}

impl<S: Sample> FirstOrder<S> {
    /// A low-pass with this corner, of samples at this rate, both in Hz. For constants, where a bad corner fails the
    /// build.
    ///
    /// # Panics
    /// Panics if the rate is not above 0, or the corner is not within 0.001 to 0.49 of it.
    pub const fn low_pass(corner: f32, rate: f32) -> Self {
        unwrap(Self::try_low_pass(corner, rate))
    }

    /// A low-pass with this corner, of samples at this rate, both in Hz.
    ///
    /// # Errors
    /// Returns an error if the rate is not above 0, or the corner is not within 0.001 to 0.49 of it.
    pub const fn try_low_pass(corner: f32, rate: f32) -> Result<Self, ConfigError> {
        tri!(check("corner", corner, rate));
        Ok(Self { gain: first_order::<S>(corner, rate), rate })
    }

    /// A scheme that encodes what this filter lets through.
    #[must_use]
    pub const fn before<P: Scheme<Sample = S>>(self, scheme: P) -> Filtered<Self, P> {
        Filtered::new(self, scheme)
    }
}

#[cfg(feature = "serde")]
impl<S: Sample> serde::Serialize for FirstOrder<S> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        use serde::ser::SerializeStruct;
        let mut fields = serializer.serialize_struct("FirstOrder", 1)?;
        fields.serialize_field("gain", &S::value(self.gain))?;
        fields.end()
    }
}

#[cfg(feature = "defmt")]
impl<S: Sample> defmt::Format for FirstOrder<S> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "FirstOrder {{ gain: {} }}", S::value(self.gain));
    }
}

/// The state of a [`FirstOrder`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
pub struct FirstOrderState<S: Sample>(<S as Recursive>::First);

impl<S: Sample> Filter for FirstOrder<S> {
    type Sample = S;
    type State = FirstOrderState<S>;

    const START: FirstOrderState<S> = FirstOrderState(<S as Recursive>::FIRST);

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("FirstOrder").double(S::value(self.gain))
    }

    #[inline]
    fn filter(&self, state: &mut FirstOrderState<S>, sample: S) -> S {
        sample.first(self.gain, &mut state.0)
    }

    #[inline]
    fn filter_slice(
        &self,
        state: &mut FirstOrderState<S>,
        samples: &[S],
        outputs: &mut [S],
    ) -> usize {
        S::first_slice(self.gain, &mut state.0, samples, outputs);
        samples.len().min(outputs.len())
    }

    fn rate(&self) -> Option<f32> {
        Some(self.rate)
    }

    fn delay(&self) -> f32 {
        (1.0 / S::value(self.gain) - 1.0) as f32
    }
}
