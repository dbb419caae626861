//! The position in the ring of residuals over which a rate encoder looks ahead.

/// The position in a ring of residuals, as many as there are taps: of `F`, the residual of sample `i` is in slot `i mod F`.
///
/// Residuals stay in their slots, and loops over them run from the first slot to the last: it is the taps that are
/// rotated, so that each lies beside its residual.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Cursor {
    /// The slot that is written next, which holds the oldest residual.
    next: u16,
    /// How many residuals must come before the next one completes a window.
    missing: u16,
}

impl Cursor {
    /// An empty ring, whose first window is complete one sample after the look-ahead.
    pub(super) const fn new(look_ahead: usize) -> Self {
        Self { next: 0, missing: look_ahead as u16 }
    }

    /// The slot that is written next. `min` shows the compiler that it is below the length.
    #[inline]
    pub(super) fn next(self, length: usize) -> usize {
        usize::from(self.next).min(length.wrapping_sub(1))
    }

    /// How many residuals must come before the next one completes a window.
    #[inline]
    pub(super) fn missing(self) -> usize {
        usize::from(self.missing)
    }

    /// Whether the position lies in the ring, and at most the whole ring is missing.
    pub(super) fn fits(self, length: usize) -> bool {
        usize::from(self.next) < length && self.missing() <= length
    }

    /// The slot of the oldest residual.
    #[inline]
    pub(super) fn oldest(self, length: usize) -> usize {
        let slot = self.next(length).wrapping_add(self.missing());
        if slot < length { slot } else { slot.wrapping_sub(length) }
    }

    /// Goes on from the slot that was written, and returns whether that completed a window.
    #[inline]
    pub(super) fn advance(&mut self, length: usize) -> bool {
        let next = self.next(length).wrapping_add(1);
        self.next = if next < length { next as u16 } else { 0 };
        let is_whole = self.missing == 0;
        if !is_whole {
            self.missing = self.missing.wrapping_sub(1);
        }
        is_whole
    }

    /// Forgets the oldest residual, and returns whether there was one: at most `most` may be missing.
    pub(super) fn pop(&mut self, most: usize) -> bool {
        let is_left = self.missing() < most;
        if is_left {
            self.missing = self.missing.wrapping_add(1);
        }
        is_left
    }

    /// Starts again from the first slot, which the caller has given the oldest residual.
    #[inline]
    pub(super) fn restart(&mut self) {
        self.next = 0;
    }
}
