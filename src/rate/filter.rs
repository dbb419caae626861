//! The filters of the rate codes.

use crate::curve::{exp, sin_pi};
use crate::error::{LARGEST_STEP, checked, finite, positive};
use crate::sample::for_each_sample;
use crate::{ConfigError, Sample};

/// `F` filter taps, 1 to 4096, kept in flash and shared by any number of encoders and decoders.
///
/// They take `8 F + 4` bytes in `f32`: each is there twice, so that a window that wraps meets them in
/// one run of memory.
///
/// A filter of length zero does not compile:
///
/// ```compile_fail
/// # use spikewire::rate::{Shape, Scale, Taps};
/// static NONE: Taps<f32, 0> = Taps::<f32, _>::triangular(1.0);
/// # let _ = &NONE;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(transparent, bound = "S: serde::Serialize")
)]
pub struct Taps<S, const F: usize> {
    /// Twice in a row, so that they can be read from any tap on and all around.
    #[cfg_attr(feature = "serde", serde(serialize_with = "once"))]
    twice: [[S; F]; 2],
    /// The sum of the magnitudes, saturating.
    #[cfg_attr(feature = "serde", serde(skip))]
    magnitude: S,
}

/// Taps without their repetition.
#[cfg(feature = "serde")]
fn once<T: serde::Serialize, S: serde::Serializer, const F: usize>(
    [taps, _]: &[[T; F]; 2],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    crate::serial::array(taps, serializer)
}

/// The shape of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape {
    /// As MATLAB's `triang(n)`.
    Triangular,
    /// `sin²(pi (k + 1) / (n + 1))`: Hann without the zeros at its ends.
    Hann,
    /// As MATLAB's `gausswin(n, alpha)`: `exp(-½ (alpha (2k - n + 1) / (n - 1))²)`.
    Gaussian {
        /// The reciprocal of the width; MATLAB takes 2.5 unless told.
        alpha: f64,
    },
}

/// What a shape is scaled to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Scale<S> {
    /// The value where the shape is 1.
    Peak(S),
    /// The sum over all taps.
    Sum(S),
}

impl Shape {
    /// Tap `k` of `n`, with 1 at the top of the shape.
    pub const fn at(self, k: usize, n: usize) -> f64 {
        let (position, length) = (k as f64, n as f64);
        match self {
            Self::Triangular => {
                let from_end = if 2 * k < n { position } else { length - 1.0 - position };
                if n % 2 == 1 {
                    2.0 * (from_end + 1.0) / (length + 1.0)
                } else {
                    (2.0 * from_end + 1.0) / length
                }
            }
            Self::Hann => {
                let root = sin_pi((position + 1.0) / (length + 1.0));
                root * root
            }
            Self::Gaussian { .. } if n == 1 => 1.0,
            Self::Gaussian { alpha } => {
                let u = alpha * (2.0 * position - length + 1.0) / (length - 1.0);
                exp(-u * u / 2.0)
            }
        }
    }

    const fn factor(self, n: usize, is_sum: bool, target: f64) -> f64 {
        if !is_sum {
            return target;
        }
        let mut sum = 0.0;
        let mut k = 0;
        while k < n {
            sum += self.at(k, n);
            k += 1;
        }
        target / sum
    }

    const fn check(self) -> Result<(), ConfigError> {
        match self {
            Self::Gaussian { alpha } => positive("alpha", alpha),
            Self::Triangular | Self::Hann => Ok(()),
        }
    }
}

/// What must hold for taps that sum up to `magnitude`, where `largest` is what the type allows.
const fn check_magnitude(magnitude: f64, largest: f64, is_wide: bool) -> Result<(), ConfigError> {
    if magnitude == 0.0 {
        Err(ConfigError::AllZero { parameter: "filter taps" })
    } else if is_wide && magnitude > largest {
        Err(ConfigError::OutOfRange {
            parameter: "sum of the filter taps' magnitudes",
            value: magnitude as f32,
            min: 0.0,
            max: largest as f32,
        })
    } else {
        Ok(())
    }
}

impl<S, const F: usize> Taps<S, F> {
    const SHAPE: () = assert!(F >= 1 && F <= 4096, "a filter takes 1 to 4096 taps");

    /// Sixteen bits widen to 32 when summed; wider types must hold the sum themselves.
    const IS_WIDE: bool = size_of::<S>() > 2;

    /// The taps, first to last.
    pub const fn as_array(&self) -> &[S; F] {
        let [taps, _] = &self.twice;
        taps
    }

    /// The taps, turned so that the first of them is in place `slot`, which is at most `F`.
    #[inline]
    pub(super) fn starting_at(&self, slot: usize) -> &[S; F] {
        let turned = self.twice.as_flattened().get(F.wrapping_sub(slot)..);
        turned.and_then(<[S]>::first_chunk).unwrap_or(self.as_array())
    }
}

impl<S: Sample, const F: usize> Taps<S, F> {
    /// The user's own taps, of any sign.
    ///
    /// # Errors
    /// A tap is not finite, all are 0, or their magnitudes sum up to more than the type holds
    /// (10³¹ in `f32`).
    pub fn new(taps: [S; F]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut magnitude = 0.0;
        for tap in taps {
            finite("filter tap", tap.to_f64())?;
            magnitude += tap.to_f64().abs();
        }
        let largest = S::from_f64(LARGEST_STEP.into()).to_f64();
        check_magnitude(magnitude, largest, Self::IS_WIDE)?;
        Ok(Self { twice: [taps; 2], magnitude: S::from_f64(magnitude) })
    }

    /// A shape, scaled and rounded to the sample type.
    ///
    /// # Errors
    /// The scale is not above 0 and finite, or as for [`new`](Self::new).
    pub fn shaped(shape: Shape, scale: Scale<S>) -> Result<Self, ConfigError> {
        shape.check()?;
        let (is_sum, target) = match scale {
            Scale::Peak(peak) => (false, peak.to_f64()),
            Scale::Sum(sum) => (true, sum.to_f64()),
        };
        positive("filter scale", target)?;
        let factor = shape.factor(F, is_sum, target);
        Self::new(core::array::from_fn(|k| S::from_f64(shape.at(k, F) * factor)))
    }

    #[inline]
    pub(super) fn magnitude(&self) -> S {
        self.magnitude
    }
}

macro_rules! constants {
    ([$($generics:tt)*] $sample:ty, $to_f64:path, $nearest:path, $floor:path) => {
        // Constants are built by index: there are no iterators in constants.
        #[allow(clippy::indexing_slicing)]
        impl<const F: usize, $($generics)*> Taps<$sample, F> {
            /// For constants: the user's own taps. Bad ones fail the build.
            ///
            /// # Panics
            /// As [`new`](Self::new) fails; at compile time where it initialises a constant.
            pub const fn checked(taps: [$sample; F]) -> Self {
                const { Self::SHAPE };
                let mut magnitude = 0.0;
                let mut k = 0;
                while k < F {
                    let tap = $to_f64(taps[k]);
                    checked!(finite("filter tap", tap));
                    magnitude += tap.abs();
                    k += 1;
                }
                let largest: $sample = $nearest(LARGEST_STEP as f64);
                checked!(check_magnitude(magnitude, $to_f64(largest), Self::IS_WIDE));
                Self { twice: [taps; 2], magnitude: $nearest(magnitude) }
            }

            /// For constants: a shape, scaled and rounded. A bad scale fails the build.
            ///
            /// # Panics
            /// As [`shaped`](Self::shaped) fails; at compile time where it initialises a constant.
            pub const fn checked_shape(shape: Shape, scale: Scale<$sample>) -> Self {
                checked!(shape.check());
                let (is_sum, target) = match scale {
                    Scale::Peak(peak) => (false, $to_f64(peak)),
                    Scale::Sum(sum) => (true, $to_f64(sum)),
                };
                checked!(positive("filter scale", target));
                let factor = shape.factor(F, is_sum, target);
                let mut taps = [$nearest(0.0); F];
                let mut k = 0;
                while k < F {
                    taps[k] = $nearest(shape.at(k, F) * factor);
                    k += 1;
                }
                Self::checked(taps)
            }

            /// For constants: [`Shape::Triangular`] with this value where the shape is 1.
            ///
            /// # Panics
            /// As [`shaped`](Self::shaped) fails; at compile time where it initialises a constant.
            pub const fn triangular(peak: $sample) -> Self {
                Self::checked_shape(Shape::Triangular, Scale::Peak(peak))
            }
        }
    };
}
for_each_sample!(constants);
