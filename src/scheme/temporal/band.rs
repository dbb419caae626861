//! The band around a baseline: step forward and its relatives emit no spike for samples within.

use crate::Sample;

/// The range in which a sample emits no spike.
#[derive(Clone, Copy)]
pub(super) struct Band<S: Sample> {
    lower: S::Bound,
    base: S::Bound,
    upper: S::Bound,
}

impl<S: Sample> Band<S> {
    #[inline]
    pub(super) fn around(base: S, threshold: S) -> Self {
        Self::at(base.bound(), threshold)
    }

    #[inline]
    fn at(base: S::Bound, threshold: S) -> Self {
        let [lower, upper] = S::bounds(base, threshold);
        Self { lower, base, upper }
    }

    /// The band one threshold higher, which a sample above this one moves it to.
    #[inline]
    pub(super) fn raised(self, threshold: S) -> Self {
        Self::at(self.upper, threshold)
    }

    /// The band one threshold lower, which a sample below this one moves it to.
    #[inline]
    pub(super) fn lowered(self, threshold: S) -> Self {
        Self::at(self.lower, threshold)
    }

    /// The baseline.
    #[inline]
    pub(super) fn base(self) -> S {
        S::of_bound(self.base)
    }

    /// The upper bound, which a sample has passed.
    #[inline]
    pub(super) fn upper(self) -> S {
        S::of_bound(self.upper)
    }

    /// The lower bound, which a sample has passed.
    #[inline]
    pub(super) fn lower(self) -> S {
        S::of_bound(self.lower)
    }

    /// Whether the whole band lies below the sample; false for NaN.
    #[inline]
    pub(super) fn is_below(self, sample: S) -> bool {
        sample.bound() > self.upper
    }

    /// Whether the whole band lies above the sample; also true of NaN.
    #[inline]
    #[expect(clippy::neg_cmp_op_on_partial_ord, reason = "true of NaN")]
    pub(super) fn is_above(self, sample: S) -> bool {
        !(sample.bound() >= self.lower)
    }

    /// Whether the sample is within the band, ends included; false for NaN.
    #[inline]
    pub(super) fn holds(self, sample: S) -> bool {
        sample.bound() <= self.upper && sample.bound() >= self.lower
    }
}

/// The methods of a [`Scheme`](crate::Scheme) that follow from its encoder's baseline, in the field `base`: a sample within
/// the band of one threshold around it has no spike.
macro_rules! follow_baseline {
    ($State:ident) => {
        const HAS_QUIET_BAND: bool = true;

        /// The last sample of the past becomes the baseline. Give the decoder that value by `resync`.
        fn prime(&self, state: &mut $State<S>, past: &[S]) {
            if let Some(base) = state.tally.last_of(past) {
                state.base = base;
            }
        }

        /// The baseline.
        fn keyframe(&self, state: &$State<S>) -> Option<S> {
            state.tally.is_primed().then_some(state.base)
        }

        /// The baseline and the threshold.
        fn quiet_band(&self, state: &$State<S>) -> Option<(S, S)> {
            self.keyframe(state).map(|base| (base, self.threshold))
        }

        fn rejected(state: &$State<S>) -> u32 {
            state.tally.rejected()
        }
    };
}
pub(super) use follow_baseline;
