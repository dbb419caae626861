//! The count of rejected samples, and whether a first sample has been seen.

use super::{Sample, to_f64};

/// How many samples were rejected, up to 2³¹-1, and whether a first sample has been seen. Four bytes.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Tally(u32);

impl Tally {
    /// No sample seen and none rejected.
    pub(crate) const NONE: Self = Self(0);

    const PRIMED: u32 = 1;
    const ONE: u32 = 2;

    /// A first sample seen and none rejected; `None` for a baseline that is not finite.
    pub(crate) const fn of_baseline<S: Sample>(baseline: S) -> Option<Self> {
        if to_f64(baseline).is_finite() { Some(Self(Self::PRIMED)) } else { None }
    }

    #[inline]
    pub(crate) fn is_primed(self) -> bool {
        self.0 & Self::PRIMED != 0
    }

    #[inline]
    pub(crate) fn prime(&mut self) {
        self.0 |= Self::PRIMED;
    }

    #[inline]
    pub(crate) fn reject(&mut self) {
        self.0 = self.0.checked_add(Self::ONE).unwrap_or(self.0);
    }

    /// Returns the last of these values, from which an encoder is primed. A value that is not finite is counted
    /// as rejected, and `None` returned.
    pub(crate) fn last_of<S: Sample>(&mut self, past: &[S]) -> Option<S> {
        let last = past.last().copied()?;
        if last.is_finite() {
            self.prime();
            Some(last)
        } else {
            self.reject();
            None
        }
    }

    #[inline]
    pub(crate) const fn rejected(self) -> u32 {
        self.0 / Self::ONE
    }
}
