//! Rank order coding whose number of neurons and spikes is chosen at run time.

use core::ops::RangeInclusive;

use alloc::vec;
use alloc::vec::Vec;

use super::dynamic::{LEVELS, NEURONS, check_neurons};
use super::methods::{begin, centred};
use super::rank_order::{Ranks, middles};
use super::{Held, SlotSpikes, SlotsState};
use crate::error::within;
use crate::scheme::cells::number_by_search;
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme};

use super::centres::even;

/// [`population::RankOrder`](crate::population::RankOrder) with any number of neurons, up to `M`, and of spikes a
/// sample.
#[derive(Clone, Debug, PartialEq)]
pub struct RankOrder<S: Sample, const M: usize = NEURONS> {
    centres: Vec<S>,
    /// `edges[i]` is the largest value that belongs to neuron `i`; the last neuron has none.
    edges: Vec<S>,
    min: S,
    max: S,
    spikes: usize,
}

impl<S: Sample, const M: usize> RankOrder<S, M> {
    /// The user's own centres, strictly rising.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` centres; the spikes a sample are not 1 to as many, at most 256;
    /// otherwise as for [`population::RankOrder`](crate::population::RankOrder::try_new).
    pub fn try_new(spikes: usize, centres: &[S]) -> Result<Self, ConfigError> {
        let end = |centre: Option<&S>| centre.copied().unwrap_or(S::ZERO);
        Self::over(spikes, centres.to_vec(), end(centres.first()), end(centres.last()))
    }

    /// Even centres over a range, half a spacing beyond it at either end.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` neurons; the spikes a sample are not 1 to as many, at most 256;
    /// otherwise as for [`population::RankOrder`](crate::population::RankOrder::try_linear).
    pub fn try_linear(
        neurons: usize,
        spikes: usize,
        range: &RangeInclusive<S>,
    ) -> Result<Self, ConfigError> {
        check_neurons(neurons, M)?;
        let (mut centres, mut edges) = (vec![S::ZERO; neurons], vec![S::ZERO; neurons]);
        even(range, &mut centres, &mut edges)?;
        Self::over(spikes, centres, *range.start(), *range.end())
    }

    fn over(spikes: usize, centres: Vec<S>, min: S, max: S) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        let most = centres.len().min(LEVELS);
        within("spikes a sample", spikes as f64, 1.0, most as f32)?;
        let mut edges = centres.clone();
        middles(&centres, &mut edges)?;
        edges.pop();
        Ok(Self { centres, edges, min, max, spikes })
    }

    /// The centres, lowest first, rounded to the sample type.
    pub fn centres(&self) -> &[S] {
        &self.centres
    }

    begin!(SlotsState);

    fn ranks(&self) -> Ranks<'_, S> {
        Ranks { centres: &self.centres, min: self.min, max: self.max }
    }
}

impl<S: Sample, const M: usize> Scheme for RankOrder<S, M> {
    type Sample = S;
    type Code = SlotSpikes<M, LEVELS>;
    type Output = SlotSpikes<M, LEVELS>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.ranks().fingerprint(self.spikes)
    }

    fn encode(&self, state: &mut SlotsState, sample: S) -> SlotSpikes<M, LEVELS> {
        let mut spikes = SlotSpikes::EMPTY;
        if !sample.is_finite() {
            state.tally.reject();
            return spikes;
        }
        let sample = self.ranks().within(sample);
        let winner = number_by_search(&self.edges, sample) - 1;
        let mut order = vec![0; self.spikes];
        spikes.first = self.ranks().order(sample, winner, &mut order);
        spikes.length = self.spikes as u16;
        for (rank, neuron) in (0..=u8::MAX).zip(order) {
            if let Some(slot) = spikes.slots.get_mut(usize::from(neuron - spikes.first)) {
                *slot = rank;
            }
        }
        spikes
    }

    fn decode(&self, state: &mut Held<S>, spikes: SlotSpikes<M, LEVELS>) -> S {
        state.or_hold(self.ranks().value(spikes.first(), spikes.slots()))
    }

    centred!(SlotsState);

    fn slots(&self) -> usize {
        self.spikes
    }
}
