//! The parameters of every rate code with a filter: the taps, and the shift.

use super::Taps;
use crate::error::{offset, tri};
use crate::num::to_f64;
use crate::{ConfigError, Sample};

/// Taps, and the shift that brings the signal's minimum to 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub(super) struct Filtered<S: Sample, const F: usize> {
    pub(super) taps: Taps<S, F>,
    pub(super) shift: S,
}

impl<S: Sample, const F: usize> Filtered<S, F> {
    pub(super) const fn new(taps: Taps<S, F>) -> Self {
        Self { taps, shift: S::ZERO }
    }

    /// Sets the shift, which must be finite, and within ±10³¹ in `f32`.
    pub(super) const fn try_with_shift(self, shift: S) -> Result<Self, ConfigError> {
        tri!(offset("shift", to_f64(shift)));
        Ok(Self { shift, ..self })
    }

    /// `sample - shift`.
    #[inline]
    pub(super) fn residual(&self, sample: S) -> S::Residual {
        sample.residual(self.shift, self.taps.magnitude())
    }
}

/// The methods of taps and shift, for a scheme with a field `filtered`.
macro_rules! with_shift {
    () => {
        /// Sets the shift, the signal's minimum; 0 by default. For constants, where a bad shift fails the build.
        ///
        /// # Panics
        /// Panics if the shift is not finite, or beyond ±10³¹ in `f32`.
        #[must_use]
        pub const fn with_shift(self, shift: S) -> Self {
            unwrap(self.try_with_shift(shift))
        }

        /// Sets the shift, the signal's minimum; 0 by default.
        ///
        /// # Errors
        /// Returns an error if the shift is not finite, or beyond ±10³¹ in `f32`.
        #[allow(clippy::needless_update)] // HSA has no other field
        pub const fn try_with_shift(self, shift: S) -> Result<Self, ConfigError> {
            let filtered = $crate::error::tri!(self.filtered.try_with_shift(shift));
            Ok(Self { filtered, ..self })
        }

        /// The taps of its filter.
        pub const fn taps(&self) -> &Taps<S, F> {
            &self.filtered.taps
        }

        /// The signal's minimum.
        pub const fn shift(&self) -> S {
            self.filtered.shift
        }
    };
}
pub(super) use with_shift;

/// Serializes a scheme as a struct of `taps`, what it has of its own by this name, and `shift`.
#[cfg(feature = "serde")]
macro_rules! serialize_filtered {
    ($Scheme:ident, $name:literal, $field:ident) => {
        impl<S: Sample + serde::Serialize, const F: usize> serde::Serialize for $Scheme<S, F> {
            fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
                let Filtered { taps, shift } = &self.filtered;
                let (name, own) = (stringify!($Scheme), ($name, &self.$field));
                crate::serial::fields(name, ("taps", taps), own, ("shift", shift), serializer)
            }
        }
    };
}
#[cfg(feature = "serde")]
pub(super) use serialize_filtered;
