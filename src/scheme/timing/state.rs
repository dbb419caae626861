//! The state of the timing codes' encoders.

use crate::Sample;
use crate::num::Tally;

/// The state of a timing code's encoder: the count of rejected samples. 4 bytes.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TimingState {
    pub(super) tally: Tally,
}

impl TimingState {
    pub(super) const START: Self = Self { tally: Tally::NONE };

    /// Returns a finite sample; counts any other as rejected.
    #[inline]
    pub(super) fn accept<S: Sample>(&mut self, sample: S) -> Option<S> {
        if sample.is_finite() {
            Some(sample)
        } else {
            self.tally.reject();
            None
        }
    }
}
