//! The residuals that a rate encoder looks ahead over.

use super::residual::{Rated, Residual};

/// A ring of at most `F` residuals, oldest first.
///
/// A window is handed out as its two runs of memory, each beside its taps: no index is wrapped
/// within a window, and nothing is moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lookahead<R, const F: usize> {
    ring: [R; F],
    start: u16,
    length: u16,
}

impl<R: Residual, const F: usize> Lookahead<R, F> {
    pub(super) fn new() -> Self {
        Self { ring: [R::ZERO; F], start: 0, length: 0 }
    }

    /// Full of these, oldest first.
    pub(super) fn full(ring: [R; F]) -> Self {
        Self { ring, start: 0, length: F as u16 }
    }

    /// The residuals of a full ring, oldest first.
    #[inline]
    pub(super) fn in_order(&self) -> [R; F] {
        let mut line = self.ring;
        line.rotate_left((self.start as usize).min(F));
        line
    }

    /// How many it takes until it is full.
    #[inline]
    pub(super) fn room(&self) -> usize {
        F.saturating_sub(self.length as usize)
    }

    #[inline]
    pub(super) fn is_full(&self) -> bool {
        self.length as usize == F
    }

    pub(super) fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Adds the newest; forgets the oldest if full.
    #[inline]
    pub(super) fn push(&mut self, residual: R) {
        let end = self.start as usize + self.length as usize;
        if let Some(slot) = self.ring.get_mut(if end < F { end } else { end - F }) {
            *slot = residual;
        }
        if self.is_full() {
            self.advance();
        } else {
            self.length += 1;
        }
    }

    /// Forgets the oldest.
    pub(super) fn pop(&mut self) {
        if !self.is_empty() {
            self.advance();
            self.length -= 1;
        }
    }

    #[inline]
    fn advance(&mut self) {
        self.start += 1;
        if self.start as usize == F {
            self.start = 0;
        }
    }

    /// The window from the oldest residual, beside the taps from the first.
    #[inline]
    pub(super) fn window<'a, S>(&'a self, taps: &'a [S; F]) -> [(&'a [R], &'a [S]); 2] {
        let (late, early) = split(&self.ring, self.start);
        let (first, rest) = split(taps, F as u16 - self.start);
        let length = self.length as usize;
        let early_length = length.saturating_sub(early.len());
        [
            (early.get(..length).unwrap_or(early), first),
            (late.get(..early_length).unwrap_or(late), rest),
        ]
    }

    /// Subtracts the taps from the window.
    #[inline]
    pub(super) fn subtract<S: Rated<Residual = R> + Copy>(&mut self, taps: &[S; F]) {
        let (late, early) = self.ring.split_at_mut_checked(self.start as usize).unwrap_or_default();
        let (first, rest) = split(taps, F as u16 - self.start);
        subtract(early, first);
        subtract(late, rest);
    }

    /// Subtracts the taps from one residual after the oldest on, which leaves the last tap over.
    #[inline]
    pub(super) fn subtract_later<S: Rated<Residual = R> + Copy>(&mut self, taps: &[S; F]) {
        let (late, early) = self.ring.split_at_mut_checked(self.start as usize).unwrap_or_default();
        for (residual, tap) in early.iter_mut().chain(late).skip(1).zip(taps) {
            *residual = residual.minus(tap.widen());
        }
    }
}

/// Subtracts taps from residuals, one by one.
#[inline]
pub(super) fn subtract<R: Residual, S: Rated<Residual = R> + Copy>(
    residuals: &mut [R],
    taps: &[S],
) {
    for (residual, tap) in residuals.iter_mut().zip(taps) {
        *residual = residual.minus(tap.widen());
    }
}

#[inline]
fn split<T>(slice: &[T], at: u16) -> (&[T], &[T]) {
    slice.split_at_checked(at as usize).unwrap_or_default()
}
