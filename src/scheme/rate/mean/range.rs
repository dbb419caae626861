//! The range of values of the codes of a mean, and the weight of a spike that stands for all of it.

use super::averaging::Weight;
use crate::error::{LARGEST_STEP, range, tri, within};
use crate::num::{Total, to_f64};
use crate::{ConfigError, Fingerprint, Sample};

/// A range of values. A sample outside counts as the end that it is beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub(super) struct Range<S> {
    pub(super) min: S,
    pub(super) max: S,
}

impl<S: Sample> Range<S> {
    /// `min < max`, both finite and within 10³¹ of 0 in `f32`.
    pub(super) const fn try_new(min: S, max: S) -> Result<Self, ConfigError> {
        let (low, high) = (to_f64(min), to_f64(max));
        tri!(range(low, high));
        tri!(within("min", low, -LARGEST_STEP, LARGEST_STEP));
        tri!(within("max", high, -LARGEST_STEP, LARGEST_STEP));
        Ok(Self { min, max })
    }

    /// `max - min`.
    #[inline]
    pub(super) fn width(self) -> S::Total {
        self.max.offset_from(self.min)
    }

    /// The name of a scheme, and its range.
    pub(super) fn named(self, name: &str) -> Fingerprint {
        Fingerprint::new(name).sample(self.min).sample(self.max)
    }

    /// The weight of a spike that stands for the whole range.
    #[inline]
    pub(super) fn weight(self) -> Weight<S::Total> {
        let width = self.width();
        Weight { unit: width, doublings: 0, range: width }
    }

    /// How far a sample is above the minimum; `None` if it is not finite.
    #[inline]
    pub(super) fn above_min(self, sample: S) -> Option<S::Total> {
        if sample >= self.min && sample <= self.max {
            Some(sample.offset_from(self.min))
        } else {
            self.at_end(sample)
        }
    }

    /// [`above_min`](Self::above_min) of a sample outside the range, or not finite.
    #[cold]
    fn at_end(self, sample: S) -> Option<S::Total> {
        if !sample.is_finite() {
            None
        } else if sample < self.min {
            Some(S::Total::ZERO)
        } else {
            Some(self.width())
        }
    }
}
