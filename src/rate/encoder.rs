//! The encoder that the rate codes share: each has its own rule for when the filter fits.

use super::filter::Taps;
use super::lookahead::{Lookahead, subtract};
use super::residual::Rated;
use crate::codec::{all_finite, encode_each};
use crate::sample::Tally;
use crate::{Encoder, Sample, Spike};

/// When a filter fits under the signal. Sealed: only this crate can name it.
pub trait Rule<S: Rated> {
    /// Whether the sample spikes, given the runs of the residuals from it on beside their taps.
    /// `is_whole` is false where the recording ends within the filter.
    fn fits(&self, window: [(&[S::Residual], &[S]); 2], is_whole: bool) -> bool;
}

/// The encoder of the rate codes that look ahead over whole filters, with the rule `R` of its scheme.
///
/// `None` until `F` samples have been seen; then the spike of the sample `F - 1` ago.
#[derive(Clone, Copy, Debug)]
pub struct RateEncoder<'a, S: Sample, R, const F: usize> {
    taps: &'a Taps<S, F>,
    shift: S,
    rule: R,
    residuals: Lookahead<S::Residual, F>,
    tally: Tally,
}

impl<'a, S: Sample, R: Rule<S>, const F: usize> RateEncoder<'a, S, R, F> {
    pub(super) fn new(taps: &'a Taps<S, F>, shift: S, rule: R) -> Self {
        Self { taps, shift, rule, residuals: Lookahead::new(), tally: Tally::default() }
    }

    #[inline]
    fn decide(&mut self) -> Spike {
        let taps = self.taps.as_array();
        if self.rule.fits(self.residuals.window(taps), self.residuals.is_full()) {
            self.residuals.subtract(taps);
            Spike::Up
        } else {
            Spike::None
        }
    }
}

impl<S: Sample, R: Rule<S>, const F: usize> Encoder for RateEncoder<'_, S, R, F> {
    type Sample = S;
    type Output = Option<Spike>;

    #[inline]
    fn encode(&mut self, sample: S) -> Option<Spike> {
        if !sample.is_finite() {
            self.tally.reject();
            return None;
        }
        self.residuals.push(sample.residual(self.shift, self.taps.magnitude()));
        self.residuals.is_full().then(|| self.decide())
    }

    /// Residuals lie in one line of memory, two filters long on the stack, where windows do not wrap.
    /// Whether all samples are finite is asked once; if not, each is taken with care.
    #[inline]
    fn encode_slice(&mut self, samples: &[S], spikes: &mut [Option<Spike>]) -> usize {
        if !all_finite(samples) {
            return encode_each(self, samples, spikes);
        }
        let length = samples.len().min(spikes.len());
        let lead = length.min(self.residuals.room());
        encode_each(self, samples.get(..lead).unwrap_or_default(), spikes);
        if lead == length {
            return length;
        }
        let samples = samples.get(lead..length).unwrap_or_default();
        let spikes = spikes.get_mut(lead..length).unwrap_or_default();
        let taps = self.taps.as_array();
        let mut line = [self.residuals.in_order(); 2];
        let line = line.as_flattened_mut();
        for (samples, spikes) in samples.chunks(F).zip(spikes.chunks_mut(F)) {
            for (start, (spike, &sample)) in (1..).zip(spikes.iter_mut().zip(samples)) {
                let Some(window) = line.get_mut(start..).and_then(<[_]>::first_chunk_mut::<F>)
                else {
                    break;
                };
                if let Some(newest) = window.last_mut() {
                    *newest = sample.residual(self.shift, self.taps.magnitude());
                }
                let fits = self.rule.fits([(window, taps), (&[], &[])], true);
                if fits {
                    subtract(window, taps);
                }
                *spike = Some(if fits { Spike::Up } else { Spike::None });
            }
            line.copy_within(samples.len().., 0);
        }
        if let Some(window) = line.first_chunk() {
            self.residuals = Lookahead::full(*window);
        }
        length
    }

    fn finish_next(&mut self) -> Option<Spike> {
        // The oldest of a full window was decided when its last sample came.
        if self.residuals.is_full() {
            self.residuals.pop();
        }
        if self.residuals.is_empty() {
            return None;
        }
        let spike = self.decide();
        self.residuals.pop();
        Some(spike)
    }

    fn reset(&mut self) {
        self.residuals = Lookahead::new();
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}
