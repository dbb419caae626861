//! The position in the ring of residuals over which a rate encoder looks ahead.

/// The position in a ring of `F` residuals: the residual of sample `i` is in slot `i mod F`.
///
/// Residuals stay in their slots, and loops over them run from the first slot to the last: it is the taps that are
/// rotated, so that each lies beside its residual.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Cursor<const F: usize> {
    /// The slot that is written next, which holds the oldest residual.
    next: u16,
    /// How many residuals must come before the next one completes a window.
    missing: u16,
}

impl<const F: usize> Cursor<F> {
    /// An empty ring, whose first window is complete one sample after the look-ahead.
    pub(super) const fn new(look_ahead: usize) -> Self {
        Self { next: 0, missing: look_ahead as u16 }
    }

    /// The slot that is written next. `min` shows the compiler that it is below `F`.
    #[inline]
    pub(super) fn next(self) -> usize {
        (self.next as usize).min(F - 1)
    }

    /// How many residuals must come before the next one completes a window.
    #[inline]
    pub(super) fn missing(self) -> usize {
        self.missing as usize
    }

    /// Whether the position lies in the ring, and at most the whole ring is missing.
    pub(super) fn fits(self) -> bool {
        usize::from(self.next) < F && self.missing() <= F
    }

    /// The slot of the oldest residual.
    pub(super) fn oldest(self) -> usize {
        let slot = self.next() + self.missing();
        if slot < F { slot } else { slot - F }
    }

    /// Goes on from the slot that was written, and returns whether that completed a window.
    #[inline]
    pub(super) fn advance(&mut self) -> bool {
        let next = self.next() + 1;
        self.next = if next < F { next as u16 } else { 0 };
        let is_whole = self.missing == 0;
        if !is_whole {
            self.missing -= 1;
        }
        is_whole
    }

    /// Forgets the oldest residual.
    pub(super) fn pop(&mut self) {
        self.missing += 1;
    }

    /// Starts again from the first slot, which the caller has given the oldest residual.
    #[inline]
    pub(super) fn restart(&mut self) {
        self.next = 0;
    }
}
