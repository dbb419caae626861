//! How the rate codes encode: each has its own rule for when the filter fits.

use core::cell::Cell;
use core::hint::black_box;

use super::cursor::Cursor;
use super::filtered::Filtered;
use crate::num::{Residual, Tally};
use crate::{Sample, Spike};

/// When a filter fits under the signal.
pub(super) trait Rule<S: Sample, const F: usize> {
    /// Whether it is settled early where it goes from the first tap on. If not, whole windows go from
    /// the first slot on in both forms.
    const IN_ORDER: bool;

    /// Whether it keeps a sum in a register from tap to tap.
    const KEEPS_A_SUM: bool;

    fn filtered(&self) -> &Filtered<S, F>;

    /// Whether the sample spikes, given the residuals from it on, each with its tap. `magnitude` is the sum
    /// of these taps' magnitudes; `is_whole` is false where the recording ends within the filter.
    fn fits(
        &self,
        magnitude: S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
        is_whole: bool,
    ) -> bool;

    /// Whether a whole window spikes, given from the first slot on; `None` if that order cannot tell.
    fn fits_by_slot(
        &self,
        magnitude: S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
    ) -> Option<bool>;
}

/// The state of a rate code's encoder: what the spikes so far have left of the last `F` samples.
///
/// `4 F + 8` bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(C)] // residuals not at the beginning, or loops over them take two more instructions a turn
pub struct RateState<S: Sample, const F: usize> {
    cursor: Cursor<F>,
    tally: Tally,
    residuals: [S::Residual; F],
}

impl<S: Sample, const F: usize> RateState<S, F> {
    pub(super) const START: Self =
        Self { residuals: [S::Residual::ZERO; F], cursor: Cursor::new(F - 1), tally: Tally::NONE };

    pub(super) const fn rejected(&self) -> u32 {
        self.tally.rejected()
    }

    /// Takes up a sample, and returns the slot of its residual if that completes a window.
    #[inline]
    fn take(&mut self, filtered: &Filtered<S, F>, sample: S) -> Option<usize> {
        if !sample.is_finite() {
            self.tally.reject();
            return None;
        }
        let slot = self.cursor.next();
        *self.residuals.get_mut(slot)? = filtered.residual(sample);
        self.cursor.advance().then_some(slot)
    }

    /// Encodes a sample with the residuals where they are.
    #[inline(always)]
    pub(super) fn encode(&mut self, rule: &impl Rule<S, F>, sample: S) -> Option<Spike> {
        let slot = self.take(rule.filtered(), sample)?;
        let filtered = rule.filtered();
        let taps = filtered.taps.starting_at(slot + 1);
        let residuals = cells(&mut self.residuals);
        match rule.fits_by_slot(filtered.taps.magnitude(), pairs(residuals, taps)) {
            Some(true) => {
                subtract(residuals, taps);
                Some(Spike::Up)
            }
            Some(false) => Some(Spike::None),
            None => self.encode_apart(rule),
        }
    }

    /// [`encode`](Self::encode), called: the criteria of BSA in fixed point make one loop each, and the
    /// compiler would put each into a loop over samples of its own.
    #[inline(never)]
    fn encode_called(&mut self, rule: &impl Rule<S, F>, sample: S) -> Option<Spike> {
        self.encode(rule, sample)
    }

    #[inline(always)]
    pub(super) fn encode_slice<R: Rule<S, F>>(
        &mut self,
        rule: &R,
        samples: &[S],
        spikes: &mut [Option<Spike>],
    ) -> usize {
        let length = samples.len().min(spikes.len());
        if !R::IN_ORDER {
            for (spike, &sample) in spikes.iter_mut().zip(samples) {
                *spike = if S::Residual::IS_EXACT {
                    self.encode_called(rule, sample)
                } else {
                    self.encode(rule, sample)
                };
            }
            return length;
        }
        let mut done = 0;
        while let (Some(samples), Some(spikes)) = (samples.get(done..), spikes.get_mut(done..))
            && let (Some(&sample), Some(_)) = (samples.first(), spikes.first())
        {
            let encoded = if self.cursor.missing() == 0 {
                self.encode_line(rule, samples, spikes)
            } else {
                0
            };
            if encoded == 0 {
                self.take(rule.filtered(), sample);
                if let Some(spike) = spikes.first_mut() {
                    *spike = None;
                }
                done = done.wrapping_add(1);
            }
            done = done.wrapping_add(encoded);
        }
        length
    }

    /// Encodes the first samples, about three filters of them and none that is not finite, and returns
    /// how many. Each must complete a window.
    ///
    /// Residuals lie in one line of memory, four filters long on the stack, where windows do not
    /// wrap: the taps do not turn, and stay in registers.
    #[inline(never)]
    fn encode_line<R: Rule<S, F>>(
        &mut self,
        rule: &R,
        samples: &[S],
        spikes: &mut [Option<Spike>],
    ) -> usize {
        let filtered = rule.filtered();
        let taps = *filtered.taps.as_array();
        let (shift, magnitude) = (filtered.shift, filtered.taps.magnitude());
        let mut line = [self.residuals; 4];
        let line = line.as_flattened_mut();
        let oldest = self.cursor.next();
        let (newest, windows) = {
            let line = cells(line);
            let after = line.get(oldest + 1..).unwrap_or_default();
            (line.get(oldest + F..).unwrap_or_default(), after.windows(F))
        };
        let mut length = samples.len().min(spikes.len()).min(newest.len());
        // A Cortex-M0, which alone has no atomic exchange, has too few registers for it to pay for every rule.
        let takes_ahead =
            S::Residual::IS_EXACT && (R::KEEPS_A_SUM || cfg!(target_has_atomic = "32"));
        if takes_ahead {
            // In a loop of its own, as the limits of a residual take registers that the next one needs.
            for (residual, &sample) in newest.iter().zip(samples).take(length) {
                residual.set(sample.residual(shift, magnitude));
                black_box(()); // or the compiler would write out four turns
            }
        }
        let all = spikes.iter_mut().zip(samples).zip(windows);
        for (at, ((spike, &sample), window)) in all.enumerate() {
            if !sample.is_finite() {
                length = at;
                break;
            }
            if !takes_ahead && let Some(newest) = window.last() {
                newest.set(sample.residual(shift, magnitude));
            }
            let fits = rule.fits(magnitude, pairs(window, &taps), true);
            if fits {
                subtract(window, &taps);
            }
            *spike = Some(if fits { Spike::Up } else { Spike::None });
        }
        if let Some(last) = line.get(oldest.wrapping_add(length)..).and_then(<[_]>::first_chunk) {
            self.residuals = *last;
        }
        self.cursor.restart();
        length
    }

    /// The spike of the oldest residual, in order and with what is there of the window.
    #[cold]
    #[inline(never)]
    fn encode_apart(&mut self, rule: &impl Rule<S, F>) -> Option<Spike> {
        let taps = &rule.filtered().taps;
        let (oldest, missing) = (self.cursor.oldest(), self.cursor.missing());
        let residuals = cells(&mut self.residuals);
        decide_in_order(rule, taps.as_array(), taps.magnitude(), residuals, oldest, missing)
    }

    pub(super) fn finish_next(&mut self, rule: &impl Rule<S, F>) -> Option<Spike> {
        if self.cursor.missing() + 1 >= F {
            return None;
        }
        self.cursor.pop();
        self.encode_apart(rule)
    }
}

/// The spike of the residual in the slot `oldest`, first tap first, and with all but the last `missing` taps where
/// the recording ends within the filter.
#[inline(always)]
pub(super) fn decide_in_order<S: Sample, const F: usize>(
    rule: &impl Rule<S, F>,
    taps: &[S],
    magnitude: S::Residual,
    residuals: &[Cell<S::Residual>],
    oldest: usize,
    missing: usize,
) -> Option<Spike> {
    let (late, early) = residuals.split_at_checked(oldest)?;
    let length = taps.len().saturating_sub(missing);
    let (taps, absent) = taps.split_at_checked(length)?;
    let (first, rest) = taps.split_at_checked(early.len().min(length))?;
    let magnitude = absent.iter().fold(magnitude, |magnitude, tap| {
        let tap = tap.widen();
        if tap < S::Residual::ZERO { magnitude.plus(tap) } else { magnitude.minus(tap) }
    });
    if !rule.fits(magnitude, pairs(early, first).chain(pairs(late, rest)), missing == 0) {
        return Some(Spike::None);
    }
    for (residual, tap) in early.iter().zip(first).chain(late.iter().zip(rest)) {
        residual.set(residual.get().minus(tap.widen()));
    }
    Some(Spike::Up)
}

/// Residuals, each with the tap beside it.
#[inline(always)]
pub(super) fn pairs<S: Sample>(
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

/// The [`Scheme`](crate::Scheme) of a rate code that looks ahead over whole filters: it has a field
/// `filtered`, and this is its rule.
macro_rules! rate_scheme {
    ($scheme:ident) => {
        impl<S: Sample, const F: usize> Start for $scheme<S, F> {
            const START: RateState<S, F> = RateState::START;
        }

        impl<S: Sample, const F: usize> Scheme for $scheme<S, F> {
            type Sample = S;
            type Code = Spike;
            type Output = Option<Spike>;
            type EncoderState = RateState<S, F>;
            type DecoderState = RateDecoderState<S, F>;

            const LATENCY: usize = F - 1;
            const RECOVERY: Recovery = Recovery::Samples(F);

            #[inline]
            fn encode(&self, state: &mut RateState<S, F>, sample: S) -> Option<Spike> {
                state.encode(self, sample)
            }

            #[inline]
            fn encode_slice(
                &self,
                state: &mut RateState<S, F>,
                samples: &[S],
                spikes: &mut [Option<Spike>],
            ) -> usize {
                state.encode_slice(self, samples, spikes)
            }

            fn finish_next(&self, state: &mut RateState<S, F>) -> Option<Spike> {
                state.finish_next(self)
            }

            fn rejected(state: &RateState<S, F>) -> u32 {
                state.rejected()
            }

            decode_rate!();
        }
    };
}
pub(super) use rate_scheme;
