//! The encoder that the rate codes with a filter share; each code adds its rule for when a sample spikes.

use core::cell::Cell;
use core::hint::black_box;

use super::cursor::Cursor;
use super::filtered::Filtered;
use crate::num::{Residual, Tally};
use crate::{Destination, Fingerprint, Sample, Spike};

/// A rate code's rule for when a sample spikes.
pub(super) trait Rule<S: Sample, const F: usize> {
    /// Whether slices take the pairs in the order of the taps, since the first taps often decide this rule. If false,
    /// single samples and slices both take the pairs in the order of the ring's slots.
    const IN_ORDER: bool;

    /// Whether the rule keeps a sum in a register from tap to tap.
    const KEEPS_A_SUM: bool;

    /// The name of the rule and its own parameters.
    fn fingerprint(&self) -> Fingerprint;

    /// The filter and the shift.
    fn filtered(&self) -> &Filtered<S, F>;

    /// Whether the sample spikes. `pairs` are the residuals from that sample on, each with its tap; `magnitude` is
    /// the sum of these taps' magnitudes; `is_whole` is false where the recording ends within the filter.
    fn fits(
        &self,
        magnitude: impl FnOnce() -> S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
        is_whole: bool,
    ) -> bool;

    /// Whether the sample spikes, with the pairs of a whole window in the order of the slots; `None` if the result
    /// depends on the order.
    #[inline(always)]
    fn fits_by_slot(
        &self,
        magnitude: impl FnOnce() -> S::Residual,
        pairs: impl Iterator<Item = (S::Residual, S::Residual)>,
    ) -> Option<bool> {
        Some(self.fits(magnitude, pairs, true))
    }
}

/// The state of the encoder of a rate code with a filter: what past spikes have left of the last `F` samples.
///
/// `4 F + 8` bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = ""))]
#[repr(C)] // loops over residuals at the very start would take two more instructions a turn
pub struct RateState<S: Sample, const F: usize> {
    cursor: Cursor,
    tally: Tally,
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    residuals: [S::Residual; F],
}

impl<S: Sample, const F: usize> RateState<S, F> {
    pub(super) const START: Self =
        Self { residuals: [S::Residual::ZERO; F], cursor: Cursor::new(F - 1), tally: Tally::NONE };

    pub(super) const fn rejected(&self) -> u32 {
        self.tally.rejected()
    }

    pub(super) fn fits(&self) -> bool {
        self.cursor.fits(F)
    }

    /// Stores the residual of a sample, and returns its slot if that completes a window.
    #[inline]
    fn take(&mut self, filtered: &Filtered<S, F>, sample: S) -> Option<usize> {
        if !sample.is_finite() {
            self.tally.reject();
            return None;
        }
        let slot = self.cursor.next(F);
        *self.residuals.get_mut(slot)? = filtered.residual(sample);
        self.cursor.advance(F).then_some(slot)
    }

    /// Encodes a sample, with the residuals in their ring.
    #[inline(always)]
    pub(super) fn encode(&mut self, rule: &impl Rule<S, F>, sample: S) -> Option<Spike> {
        let slot = self.take(rule.filtered(), sample)?;
        let filtered = rule.filtered();
        let taps = filtered.taps.starting_at(slot + 1);
        let residuals = cells(&mut self.residuals);
        match rule.fits_by_slot(|| filtered.taps.magnitude(), pairs(residuals, taps)) {
            Some(true) => {
                subtract(residuals, taps);
                Some(Spike::Up)
            }
            Some(false) => Some(Spike::None),
            None => self.encode_apart(rule),
        }
    }

    /// [`encode`](Self::encode) as a call. In fixed point each criterion of BSA has its own loop over taps, for each
    /// of which the compiler would repeat the loop over samples: flash that only a laptop can spare.
    #[inline(never)]
    fn encode_called(&mut self, rule: &impl Rule<S, F>, sample: S) -> Option<Spike> {
        self.encode(rule, sample)
    }

    #[inline(always)]
    pub(super) fn encode_slice<R: Rule<S, F>>(
        &mut self,
        rule: &R,
        samples: &[S],
        spikes: &mut [impl Destination<Option<Spike>>],
    ) -> usize {
        let length = samples.len().min(spikes.len());
        if !R::IN_ORDER {
            for (spike, &sample) in spikes.iter_mut().zip(samples) {
                spike.write(if S::Residual::IS_EXACT && !crate::num::HAS_VECTORS {
                    self.encode_called(rule, sample)
                } else {
                    self.encode(rule, sample)
                });
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
                    spike.write(None);
                }
                done = done.wrapping_add(1);
            }
            done = done.wrapping_add(encoded);
        }
        length
    }

    /// Encodes up to about three filter lengths of samples, stops before a sample that is not finite, and returns how
    /// many it has encoded. Each of them must complete a window.
    ///
    /// The residuals lie in a line of four filter lengths on the stack, where windows do not wrap: the taps need no
    /// rotation and stay in registers.
    #[inline(never)]
    fn encode_line<R: Rule<S, F>>(
        &mut self,
        rule: &R,
        samples: &[S],
        spikes: &mut [impl Destination<Option<Spike>>],
    ) -> usize {
        let filtered = rule.filtered();
        let taps = *filtered.taps.as_array();
        let (shift, magnitude) = (filtered.shift, filtered.taps.magnitude());
        let mut line = [self.residuals; 4];
        let line = line.as_flattened_mut();
        let oldest = self.cursor.next(F);
        let (newest, windows) = {
            let line = cells(line);
            let after = line.get(oldest + 1..).unwrap_or_default();
            (line.get(oldest + F..).unwrap_or_default(), after.windows(F))
        };
        let mut length = samples.len().min(spikes.len()).min(newest.len());
        // A Cortex-M0, the only core without atomic exchange, has too few registers unless the rule keeps a sum.
        let takes_ahead =
            S::Residual::IS_EXACT && (R::KEEPS_A_SUM || cfg!(target_has_atomic = "32"));
        if takes_ahead {
            // In a loop of its own, as the limits of a residual take registers that the next loop needs.
            for (residual, &sample) in newest.iter().zip(samples).take(length) {
                residual.set(sample.residual(shift, magnitude));
                black_box(()); // keeps the compiler from unrolling the loop
            }
        }
        let windowed = spikes.iter_mut().zip(samples).zip(windows);
        for (at, ((spike, &sample), window)) in windowed.enumerate() {
            if !sample.is_finite() {
                length = at;
                break;
            }
            if !takes_ahead && let Some(newest) = window.last() {
                newest.set(sample.residual(shift, magnitude));
            }
            let fits = rule.fits(|| magnitude, pairs(window, &taps), true);
            if fits {
                subtract(window, &taps);
            }
            spike.write(Some(if fits { Spike::Up } else { Spike::None }));
        }
        if let Some(last) = line.get(oldest.wrapping_add(length)..).and_then(<[_]>::first_chunk) {
            self.residuals = *last;
        }
        self.cursor.restart();
        length
    }

    /// The spike of the oldest residual, decided from the first tap on; see [`decide_in_order`].
    #[cold]
    #[inline(never)]
    fn encode_apart(&mut self, rule: &impl Rule<S, F>) -> Option<Spike> {
        let taps = &rule.filtered().taps;
        let (oldest, missing) = (self.cursor.oldest(F), self.cursor.missing());
        let residuals = cells(&mut self.residuals);
        decide_in_order(rule, taps.as_array(), taps.magnitude(), residuals, oldest, missing)
    }

    pub(super) fn finish_next(&mut self, rule: &impl Rule<S, F>) -> Option<Spike> {
        self.cursor.pop(F - 1).then(|| self.encode_apart(rule)).flatten()
    }
}

/// The spike of the residual in the slot `oldest`, decided from the first tap on. Where the recording ends within the
/// filter, the last `missing` taps are left out.
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
    let magnitude = || {
        absent.iter().fold(magnitude, |magnitude, tap| {
            let tap = tap.widen();
            if tap < S::Residual::ZERO { magnitude.plus(tap) } else { magnitude.minus(tap) }
        })
    };
    if !rule.fits(magnitude, pairs(early, first).chain(pairs(late, rest)), missing == 0) {
        return Some(Spike::None);
    }
    for (residual, tap) in early.iter().zip(first).chain(late.iter().zip(rest)) {
        residual.set(residual.get().minus(tap.widen()));
    }
    Some(Spike::Up)
}

/// Residuals, each with its tap.
#[inline(always)]
pub(super) fn pairs<S: Sample>(
    residuals: &[Cell<S::Residual>],
    taps: &[S],
) -> impl Iterator<Item = (S::Residual, S::Residual)> {
    residuals.iter().zip(taps).map(|(residual, tap)| (residual.get(), tap.widen()))
}

/// Residuals as cells, so that windows that overlap can be written to.
#[inline]
pub(super) fn cells<R>(residuals: &mut [R]) -> &[Cell<R>] {
    Cell::from_mut(residuals).as_slice_of_cells()
}

/// Subtracts its tap from each residual.
#[inline(always)]
pub(super) fn subtract<S: Sample>(residuals: &[Cell<S::Residual>], taps: &[S]) {
    for (residual, tap) in residuals.iter().zip(taps) {
        residual.set(residual.get().minus(tap.widen()));
    }
}

/// Implements [`Scheme`](crate::Scheme) for a rate code that implements [`Rule`] and has a field `filtered`.
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

            fn fingerprint(&self) -> Fingerprint {
                let Filtered { taps, shift } = &self.filtered;
                Rule::fingerprint(self).samples(taps.as_array()).sample(*shift)
            }

            #[inline]
            fn encode(&self, state: &mut RateState<S, F>, sample: S) -> Option<Spike> {
                state.encode(self, sample)
            }

            #[inline]
            fn encode_slice(
                &self,
                state: &mut RateState<S, F>,
                samples: &[S],
                spikes: &mut [impl Destination<Option<Spike>>],
            ) -> usize {
                state.encode_slice(self, samples, spikes)
            }

            fn finish_next(&self, state: &mut RateState<S, F>) -> Option<Spike> {
                state.finish_next(self)
            }

            fn fits(&self, state: &RateState<S, F>) -> bool {
                state.fits()
            }

            fn rejected(state: &RateState<S, F>) -> u32 {
                state.rejected()
            }

            decode_rate!();
        }
    };
}
pub(super) use rate_scheme;
