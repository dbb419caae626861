//! The band around a baseline: step forward and its relatives emit no spike for samples within.

use crate::Sample;

/// The range in which a sample emits no spike.
#[derive(Clone, Copy)]
pub(super) struct Band<S> {
    pub(super) lower: S,
    pub(super) base: S,
    pub(super) upper: S,
}

impl<S: Sample> Band<S> {
    #[inline]
    pub(super) fn around(base: S, threshold: S) -> Self {
        Self { lower: base.minus(threshold), base, upper: base.plus(threshold) }
    }

    /// Whether the whole band lies above the sample; also true of NaN.
    #[inline]
    #[expect(clippy::neg_cmp_op_on_partial_ord, reason = "true of NaN")]
    pub(super) fn is_above(self, sample: S) -> bool {
        !(sample >= self.lower)
    }

    /// Whether the sample is within the band, ends included; false for NaN.
    #[inline]
    pub(super) fn holds(self, sample: S) -> bool {
        sample <= self.upper && sample >= self.lower
    }
}
