//! Where the residuals are that a rate encoder looks ahead over.

/// A place in a ring of `F` residuals: that of sample `i` stays in slot `i mod F`.
///
/// A residual never moves and no run of memory wraps: it is the taps, twice in a row in flash, that
/// turn until they lie beside their residuals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<const F: usize> {
    /// The slot that is written next: of the oldest residual.
    next: u16,
    /// How many residuals are to come before the next one completes a window.
    missing: u16,
}

impl<const F: usize> Cursor<F> {
    /// For windows that the sample after so many completes.
    pub(super) const fn new(look_ahead: usize) -> Self {
        Self { next: 0, missing: look_ahead as u16 }
    }

    /// The slot that is written next. That it is one, the compiler sees here.
    #[inline]
    pub(super) fn next(self) -> usize {
        (self.next as usize).min(F - 1)
    }

    /// How many residuals are to come before the next one completes a window.
    #[inline]
    pub(super) fn missing(self) -> usize {
        self.missing as usize
    }

    /// The slot of the oldest residual.
    pub(super) fn oldest(self) -> usize {
        let slot = self.next() + self.missing();
        if slot < F { slot } else { slot - F }
    }

    /// Passes the slot that was written, and says whether that completed a window.
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

    /// The oldest residual comes to lie in the first slot.
    #[inline]
    pub(super) fn restart(&mut self) {
        self.next = 0;
    }
}
