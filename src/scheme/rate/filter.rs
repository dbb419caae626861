//! Filter taps of the rate codes: the user's own, or a triangular, Hann or Gaussian shape.

use crate::error::{LARGEST_STEP, finite, positive, tri, unwrap};
use crate::num::curve::{exp, sin_pi};
use crate::num::{DoubleDouble, from_f64, to_f64, word};
use crate::{ConfigError, Sample, SampleKind};

/// `F` filter taps, 1 to 4096.
///
/// **Memory:** `8 F + 4` bytes in `f32`, in the scheme that owns them: the taps are stored twice in a row, so that
/// every rotation of them is one slice.
///
/// ```
/// use spikewire::rate::Taps;
///
/// const TAPS: Taps<f32, 3> = Taps::triangular(1.0);
/// assert_eq!(TAPS.as_array(), &[0.5, 1.0, 0.5]);
/// ```
///
/// A filter of length zero does not compile:
///
/// ```compile_fail
/// # use spikewire::rate::Taps;
/// const NONE: Taps<f32, 0> = Taps::triangular(1.0);
/// # let _ = &NONE;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(transparent, bound = "S: serde::Serialize")
)]
pub struct Taps<S: Sample, const F: usize> {
    /// The taps twice in a row, so that every rotation of them is one slice.
    #[cfg_attr(feature = "serde", serde(serialize_with = "once"))]
    twice: [[S; F]; 2],
    /// The sum of the magnitudes.
    #[cfg_attr(feature = "serde", serde(skip))]
    magnitude: S::Residual,
}

#[cfg(feature = "defmt")]
impl<S: Sample + defmt::Format, const F: usize> defmt::Format for Taps<S, F> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Taps({})", self.as_array());
    }
}

/// Writes the taps once.
#[cfg(feature = "serde")]
fn once<T: serde::Serialize, S: serde::Serializer, const F: usize>(
    [taps, _]: &[[T; F]; 2],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    crate::serial::array::serialize(taps, serializer)
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
        /// The reciprocal of the width, above 0; MATLAB takes 2.5 by default.
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
        self.height(k, n).settled().nearest()
    }

    const fn height(self, k: usize, n: usize) -> DoubleDouble {
        let (position, length) = (k as f64, n as f64);
        match self {
            Self::Triangular => {
                let from_end =
                    if k.saturating_mul(2) < n { position } else { length - 1.0 - position };
                let (part, parts) = if n % 2 == 1 {
                    (2.0 * (from_end + 1.0), length + 1.0)
                } else {
                    (2.0 * from_end + 1.0, length)
                };
                DoubleDouble::new(part).over_double(parts)
            }
            Self::Hann => {
                let root = sin_pi(k.saturating_add(1), n.saturating_add(1));
                root.times(root)
            }
            Self::Gaussian { .. } if n == 1 => DoubleDouble::ONE,
            Self::Gaussian { alpha } => {
                let from_middle = DoubleDouble::new(2.0 * position - length + 1.0);
                let u = from_middle.over_double(length - 1.0);
                // Beyond this all taps but a middle one are 0.
                let u = u.times(DoubleDouble::new(alpha.min(1e9)));
                exp(u.times(u).scaled(-0.5))
            }
        }
    }

    /// The heights of all taps together.
    const fn total(self, n: usize) -> DoubleDouble {
        // The shapes are symmetrical.
        let mut half = DoubleDouble::ZERO;
        let mut k = 0;
        while k < n / 2 {
            half = half.plus(self.height(k, n));
            k += 1;
        }
        let both = half.scaled(2.0);
        if n % 2 == 1 { both.plus(self.height(n / 2, n)) } else { both }
    }

    const fn check(self) -> Result<(), ConfigError> {
        match self {
            Self::Gaussian { alpha } => positive("alpha", alpha),
            Self::Triangular | Self::Hann => Ok(()),
        }
    }
}

/// The sum of the taps' magnitudes.
///
/// # Errors
/// Returns an error if a tap is not finite, all are 0, or the sum is more than the type holds.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn magnitude<S: Sample>(taps: &[S]) -> Result<S::Residual, ConfigError> {
    let mut magnitude = 0.0;
    let mut k = 0;
    while k < taps.len() {
        let tap = to_f64(taps[k]);
        tri!(finite("filter tap", tap));
        magnitude += tap.abs();
        k += 1;
    }
    tri!(check_magnitude::<S>(magnitude));
    Ok(sum::<S>(magnitude))
}

/// Checks the sum of the taps' magnitudes. Sums of 16-bit taps have 32 bits, so they always fit; those of wider
/// types must fit the type.
const fn check_magnitude<S: Sample>(magnitude: f64) -> Result<(), ConfigError> {
    let largest = to_f64(from_f64::<S>(LARGEST_STEP as f64));
    if magnitude == 0.0 {
        Err(ConfigError::AllZero { parameter: "filter taps" })
    } else if size_of::<S>() > 2 && magnitude > largest {
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

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const F: usize> Taps<S, F> {
    const SHAPE: () = assert!(F >= 1 && F <= 4096, "a filter takes 1 to 4096 taps");

    /// The user's own taps, of any sign. For constants, where bad taps fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(taps: [S; F]) -> Self {
        unwrap(Self::try_new(taps))
    }

    /// The user's own taps, of any sign.
    ///
    /// # Errors
    /// Returns an error if a tap is not finite, all are 0, or their magnitudes sum up to more than the type holds
    /// (10³¹ in `f32`).
    pub const fn try_new(taps: [S; F]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        Ok(Self { twice: [taps; 2], magnitude: tri!(magnitude(&taps)) })
    }

    /// A shape, scaled and rounded to the sample type. For constants, where a bad scale fails the build.
    ///
    /// # Panics
    /// Panics if [`try_shaped`](Self::try_shaped) returns an error.
    pub const fn shaped(shape: Shape, scale: Scale<S>) -> Self {
        unwrap(Self::try_shaped(shape, scale))
    }

    /// A shape, scaled and rounded to the sample type.
    ///
    /// # Errors
    /// Returns an error if the scale or `alpha` is not above 0 and finite, or the taps are refused by
    /// [`try_new`](Self::try_new).
    pub const fn try_shaped(shape: Shape, scale: Scale<S>) -> Result<Self, ConfigError> {
        let (is_sum, target) = match scale {
            Scale::Peak(peak) => (false, to_f64(peak)),
            Scale::Sum(sum) => (true, to_f64(sum)),
        };
        tri!(shape.check());
        tri!(positive("filter scale", target));
        let target = DoubleDouble::new(target);
        let factor = if is_sum { target.over(shape.total(F)) } else { target };
        let mut taps = [S::ZERO; F];
        let mut k = 0;
        while k < F {
            let tap = shape.height(k, F).times(factor);
            taps[k] = from_f64(tap.settled().rounded());
            k += 1;
        }
        Self::try_new(taps)
    }

    /// [`Shape::Triangular`] with this value where the shape is 1. For constants, where a bad peak fails the
    /// build.
    ///
    /// # Panics
    /// Panics if [`try_triangular`](Self::try_triangular) returns an error.
    pub const fn triangular(peak: S) -> Self {
        unwrap(Self::try_triangular(peak))
    }

    /// [`Shape::Triangular`] with this value where the shape is 1.
    ///
    /// # Errors
    /// Returns an error if [`try_shaped`](Self::try_shaped) does.
    pub const fn try_triangular(peak: S) -> Result<Self, ConfigError> {
        Self::try_shaped(Shape::Triangular, Scale::Peak(peak))
    }

    /// The taps, first to last.
    pub const fn as_array(&self) -> &[S; F] {
        let [taps, _] = &self.twice;
        taps
    }

    /// The taps, rotated so that the first is at index `slot`, which is at most `F`.
    #[inline]
    pub(super) fn starting_at(&self, slot: usize) -> &[S; F] {
        let turned = self.twice.as_flattened().get(F.wrapping_sub(slot)..);
        turned.and_then(<[S]>::first_chunk).unwrap_or(self.as_array())
    }

    /// The sum of the taps' magnitudes.
    #[inline]
    pub(super) const fn magnitude(&self) -> S::Residual {
        self.magnitude
    }
}

/// A sum of taps, as a residual.
const fn sum<S: Sample>(value: f64) -> S::Residual {
    match S::KIND {
        SampleKind::F32 => word((value as f32).to_bits() as u64),
        SampleKind::Fixed16 { fraction } | SampleKind::Fixed32 { fraction } => {
            word((value * (1_u64 << fraction) as f64) as i64 as u64)
        }
    }
}
