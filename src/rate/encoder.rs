//! The encoder that the rate codes share: each has its own rule for when the filter fits.

use core::cell::Cell;

use super::cursor::Cursor;
use super::filter::Taps;
use super::residual::Residual;
use crate::sample::Tally;
use crate::{Encoder, Sample, Spike};

/// When a filter fits under the signal. Sealed: only this crate can name it.
pub trait Rule<R: Residual>: Copy {
    /// Whether it is settled early where it goes from the first tap on. If not, whole windows go from
    /// the first slot on in both forms.
    const IN_ORDER: bool;

    /// Whether the sample spikes, given the residuals from it on, each with its tap. `is_whole` is
    /// false where the recording ends within the filter.
    fn fits(&self, pairs: impl Iterator<Item = (R, R)>, is_whole: bool) -> bool;

    /// The same for a whole window from the first slot on; `None` if that order cannot tell.
    fn fits_by_slot(&self, pairs: impl Iterator<Item = (R, R)>) -> Option<bool>;

    /// The rule for windows that the recording cuts, without these taps.
    fn cut(self, _absent: impl Iterator<Item = R>) -> Self {
        self
    }
}

/// The encoder of the rate codes that look ahead over whole filters, with the rule `R` of its scheme.
///
/// `None` until `F` samples have been seen; then the spike of the sample `F - 1` ago.
#[derive(Clone, Copy, Debug)]
pub struct RateEncoder<'a, S: Sample, R, const F: usize> {
    taps: &'a Taps<S, F>,
    shift: S,
    rule: R,
    residuals: [S::Residual; F],
    cursor: Cursor<F>,
    tally: Tally,
}

impl<'a, S: Sample, R: Rule<S::Residual>, const F: usize> RateEncoder<'a, S, R, F> {
    pub(super) fn new(taps: &'a Taps<S, F>, shift: S, rule: R) -> Self {
        let residuals = [S::Residual::ZERO; F];
        Self { taps, shift, rule, residuals, cursor: Cursor::new(F - 1), tally: Tally::default() }
    }

    /// Takes up a sample, and returns the slot of its residual if that completes a window.
    #[inline]
    fn take(&mut self, sample: S) -> Option<usize> {
        if !sample.is_finite() {
            self.tally.reject();
            return None;
        }
        let slot = self.cursor.next();
        *self.residuals.get_mut(slot)? = sample.residual(self.shift, self.taps.magnitude());
        self.cursor.advance().then_some(slot)
    }

    /// Encodes a sample with the residuals where they are.
    #[inline(always)]
    fn encode_one(&mut self, sample: S) -> Option<Spike> {
        let slot = self.take(sample)?;
        let taps = self.taps.starting_at(slot + 1);
        let residuals = cells(&mut self.residuals);
        match self.rule.fits_by_slot(pairs(residuals, taps)) {
            Some(true) => {
                subtract(residuals, taps);
                Some(Spike::Up)
            }
            Some(false) => Some(Spike::None),
            None => self.encode_apart(),
        }
    }

    /// The same, called: the criteria of BSA in fixed point make one loop each, and the compiler would
    /// put each into a loop over samples of its own.
    #[inline(never)]
    fn encode_called(&mut self, sample: S) -> Option<Spike> {
        self.encode_one(sample)
    }

    /// Encodes the first samples, about three filters of them and none that is not finite, and returns
    /// how many. Each must complete a window.
    ///
    /// Residuals lie in one line of memory, four filters long on the stack, where windows do not
    /// wrap: the taps do not turn, and stay in registers.
    #[inline(never)]
    fn encode_line(&mut self, samples: &[S], spikes: &mut [Option<Spike>]) -> usize {
        let taps = *self.taps.as_array();
        let (shift, magnitude, rule) = (self.shift, self.taps.magnitude(), self.rule);
        let mut line = [self.residuals; 4];
        let line = line.as_flattened_mut();
        let oldest = self.cursor.next();
        let windows = cells(line.get_mut(oldest + 1..).unwrap_or_default()).windows(F);
        let mut length = samples.len().min(spikes.len()).min(windows.len());
        let all = spikes.iter_mut().zip(samples).zip(windows);
        for (at, ((spike, &sample), window)) in all.enumerate() {
            if !sample.is_finite() {
                length = at;
                break;
            }
            if let Some(newest) = window.last() {
                newest.set(sample.residual(shift, magnitude));
            }
            let fits = rule.fits(pairs(window, &taps), true);
            if fits {
                subtract(window, &taps);
            }
            *spike = Some(if fits { Spike::Up } else { Spike::None });
        }
        if let Some(last) = line.get(oldest + length..).and_then(<[_]>::first_chunk) {
            self.residuals = *last;
        }
        self.cursor.restart();
        length
    }

    /// The spike of the oldest residual, in order and with what is there of the window.
    #[cold]
    #[inline(never)]
    fn encode_apart(&mut self) -> Option<Spike> {
        let length = F.saturating_sub(self.cursor.missing());
        let (late, early) = cells(&mut self.residuals).split_at_checked(self.cursor.oldest())?;
        let (taps, absent) = self.taps.as_array().split_at_checked(length)?;
        let (first, rest) = taps.split_at_checked(early.len().min(length))?;
        let rule = self.rule.cut(absent.iter().map(|tap| tap.widen()));
        if !rule.fits(pairs(early, first).chain(pairs(late, rest)), length == F) {
            return Some(Spike::None);
        }
        for (residual, tap) in early.iter().zip(first).chain(late.iter().zip(rest)) {
            residual.set(residual.get().minus(tap.widen()));
        }
        Some(Spike::Up)
    }
}

/// Residuals, each with the tap beside it.
#[inline(always)]
fn pairs<S: Sample>(
    residuals: &[Cell<S::Residual>],
    taps: &[S],
) -> impl Iterator<Item = (S::Residual, S::Residual)> {
    residuals.iter().zip(taps).map(|(residual, tap)| (residual.get(), tap.widen()))
}

/// Residuals, for windows that overlap.
#[inline]
pub(super) fn cells<R>(residuals: &mut [R]) -> &[Cell<R>] {
    Cell::from_mut(residuals).as_slice_of_cells()
}

/// Subtracts from every residual the tap beside it.
#[inline(always)]
pub(super) fn subtract<S: Sample>(residuals: &[Cell<S::Residual>], taps: &[S]) {
    for (residual, tap) in residuals.iter().zip(taps) {
        residual.set(residual.get().minus(tap.widen()));
    }
}

impl<S: Sample, R: Rule<S::Residual>, const F: usize> Encoder for RateEncoder<'_, S, R, F> {
    type Sample = S;
    type Output = Option<Spike>;

    #[inline]
    fn encode(&mut self, sample: S) -> Option<Spike> {
        self.encode_one(sample)
    }

    #[inline]
    fn encode_slice(&mut self, samples: &[S], spikes: &mut [Option<Spike>]) -> usize {
        let length = samples.len().min(spikes.len());
        if !R::IN_ORDER {
            for (spike, &sample) in spikes.iter_mut().zip(samples) {
                *spike = if S::Residual::IS_EXACT {
                    self.encode_called(sample)
                } else {
                    self.encode_one(sample)
                };
            }
            return length;
        }
        let mut done = 0;
        while let (Some(samples), Some(spikes)) = (samples.get(done..), spikes.get_mut(done..))
            && let (Some(&sample), Some(_)) = (samples.first(), spikes.first())
        {
            let encoded =
                if self.cursor.missing() == 0 { self.encode_line(samples, spikes) } else { 0 };
            if encoded == 0 {
                self.take(sample);
                if let Some(spike) = spikes.first_mut() {
                    *spike = None;
                }
                done += 1;
            }
            done += encoded;
        }
        length
    }

    fn finish_next(&mut self) -> Option<Spike> {
        if self.cursor.missing() + 1 >= F {
            return None;
        }
        self.cursor.pop();
        self.encode_apart()
    }

    fn reset(&mut self) {
        self.cursor = Cursor::new(F - 1);
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}
