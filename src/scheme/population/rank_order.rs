//! Rank order coding: the order in which the nearest neurons fire gives the value.

use core::ops::RangeInclusive;

use super::centres::{Centres, even, halfway_edges};
use super::methods::{centred, encode_in_place};
use super::{Held, SlotSpikes, SlotsState};
use crate::error::{offset, tri, unwrap};
use crate::num::{from_f64, to_f64};
use crate::{ConfigError, Fingerprint, Recovery, Sample, SampleKind, Scheme, Start};

/// Rank order coding: the `K` neurons of `M` whose centres are nearest fire one after the other, the nearest first.
///
/// The neuron of rank `j` fires in slot `j` of `K`. As fields of equal width respond by distance alone, the neurons that
/// fired are neighbours at any time: the next one is the neighbour above them if the value is above the middle
/// `h = (mu[l] + mu[r]) / 2` of the two neighbours, and else, or halfway, the one below. The decoder follows these
/// decisions and gives the middle of the values that agree with all of them.
///
/// - **M:** 3 to 1024 neurons. **K:** 1 to `M`, at most 256, spikes a sample.
/// - **Centres:** strictly rising: [even](Self::linear) or the [user's own](Self::new), within 10³¹ of 0 in `f32`.
///   **Range:** that of even centres, or from the first to the last of the user's; values outside are taken as its
///   ends.
/// - **Latency:** 0 samples, within which the slots last as long as the caller makes them.
///   **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes `10 M + 16` bytes of flash in `f32`.
/// - **Work:** a search for the nearest centre, as in [`Position`](super::Position), and `K - 1` comparisons; no sort.
/// - **Exactness:** middles are rounded down in fixed point, and to the nearest in `f32`. Encoder and decoder know
///   centres as rounded to the sample type.
/// - **Decoder:** it takes the spikes up to the first that contradicts those before it, and gives a value after any
///   number of them; where the first spike is missing, the value before.
/// - **Error:** at most half the length of the interval of values with these spikes, and one step of fixed point. With
///   even centres, `D` apart, and `K` of 2 or more it is `D / 4` and a step.
///
/// Source: Thorpe and Gautrais, *Rank order coding*, 1998.
///
/// ```
/// use spikewire::{Scheme, population::RankOrder};
///
/// const ERROR: RankOrder<i16, 5, 3> = RankOrder::new([0, 10, 30, 70, 150]);
///
/// let spikes = ERROR.encoder().encode(37);
/// assert!(spikes.iter().eq([(1, 1), (2, 0), (3, 2)])); // neurons 2, 1, 3
/// assert_eq!(ERROR.decoder().decode(spikes), 38);
/// ```
///
/// More spikes than neurons do not compile:
///
/// ```compile_fail
/// # use spikewire::population::RankOrder;
/// const ERROR: RankOrder<i16, 5, 6> = RankOrder::new([0, 10, 30, 70, 150]);
/// # let _ = &ERROR;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct RankOrder<S: Sample, const M: usize, const K: usize> {
    centres: Centres<S, M>,
    min: S,
    max: S,
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const M: usize, const K: usize> RankOrder<S, M, K> {
    const SHAPE: () = {
        let () = Centres::<S, M>::SHAPE;
        assert!(K >= 1 && K <= M && K <= 256, "a sample has 1 to M spikes, at most 256");
    };

    /// The user's own centres, strictly rising. For constants, where bad centres fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(centres: [S; M]) -> Self {
        unwrap(Self::try_new(centres))
    }

    /// The user's own centres, strictly rising.
    ///
    /// # Errors
    /// Returns an error if a centre is not finite, or does not exceed the one before, or is so close to it that two
    /// middles are alike; in `f32` it is more than 10³¹ from 0.
    pub const fn try_new(centres: [S; M]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        Self::over(centres, centres[0], centres[M - 1])
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type. For constants, where a bad
    /// range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_linear`](Self::try_linear) returns an error.
    pub const fn linear(range: RangeInclusive<S>) -> Self {
        unwrap(Self::try_linear(range))
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or the sample type is too coarse to tell the
    /// centres apart; in `f32` an outermost centre is more than 10³¹ from 0.
    pub const fn try_linear(range: RangeInclusive<S>) -> Result<Self, ConfigError> {
        let mut centres = [S::ZERO; M];
        let mut edges = [S::ZERO; M];
        tri!(even(&range, &mut centres, &mut edges));
        Self::over(centres, *range.start(), *range.end())
    }

    const fn over(centres: [S; M], min: S, max: S) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut edges = centres;
        tri!(middles(&centres, &mut edges));
        Ok(Self { centres: Centres::new(centres, edges, M), min, max })
    }

    /// The centres, lowest first, rounded to the sample type.
    pub const fn centres(&self) -> &[S; M] {
        self.centres.as_array()
    }

    /// The response of a neuron that is more excited the earlier its inputs fire: the sum of their weights, halved
    /// with each rank, `sum u[o[j]] 2^(K - 1 - j)`. At most 48 spikes a sample.
    ///
    /// Source: Thorpe and Gautrais 1998.
    pub fn readout(spikes: &SlotSpikes<M, K>, weights: &[i16; M]) -> i64 {
        const { assert!(K <= 48, "a response has 64 bits") };
        spikes.iter().fold(0, |sum, (neuron, rank)| {
            let weight = weights.get(usize::from(neuron)).copied().unwrap_or_default();
            let doublings = (K as u32).wrapping_sub(1).wrapping_sub(rank.into());
            sum.wrapping_add(i64::from(weight).wrapping_shl(doublings))
        })
    }

    const fn ranks(&self) -> Ranks<'_, S> {
        Ranks { centres: self.centres.as_array(), min: self.min, max: self.max }
    }

    #[inline]
    fn encode_into(&self, state: &mut SlotsState, sample: S, spikes: &mut SlotSpikes<M, K>) {
        if !sample.is_finite() {
            state.tally.reject();
            return;
        }
        let ranks = self.ranks();
        let sample = ranks.within(sample);
        let winner = self.centres.number(sample).wrapping_sub(1);
        let mut order = [0; K];
        spikes.first = ranks.order(sample, winner, &mut order);
        spikes.length = K as u16;
        for (rank, neuron) in (0..).zip(order) {
            if let Some(slot) = spikes.slots.get_mut(usize::from(neuron.wrapping_sub(spikes.first)))
            {
                *slot = rank;
            }
        }
    }
}

/// Sets each edge but the last to the middle of two centres.
///
/// # Errors
/// Returns an error if a centre is not finite, or does not exceed the one before, or is so close to it that two
/// middles are alike; in `f32` it is more than 10³¹ from 0.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn middles<S: Sample>(centres: &[S], edges: &mut [S]) -> Result<(), ConfigError> {
    tri!(halfway_edges(centres, edges));
    let mut i = 0;
    while i < centres.len() {
        if matches!(S::KIND, SampleKind::F32) {
            tri!(offset("centre", to_f64(centres[i])));
            if i + 1 < centres.len() {
                let sum = to_f64(centres[i]) as f32 + to_f64(centres[i + 1]) as f32;
                edges[i] = from_f64((sum * 0.5) as f64);
            }
        }
        if i > 0 && i + 1 < centres.len() && to_f64(edges[i]) <= to_f64(edges[i - 1]) {
            return Err(ConfigError::EmptyCell { cell: i, cells: centres.len() });
        }
        i += 1;
    }
    Ok(())
}

/// Centres and the range that they stand for.
pub(super) struct Ranks<'r, S> {
    pub(super) centres: &'r [S],
    pub(super) min: S,
    pub(super) max: S,
}

impl<S: Sample> Ranks<'_, S> {
    pub(super) fn fingerprint(&self, spikes: usize) -> Fingerprint {
        let centres = Fingerprint::new("RankOrder").samples(self.centres);
        centres.sample(self.min).sample(self.max).number(spikes as u32)
    }

    /// The value of the range that is nearest to a sample.
    #[inline]
    pub(super) fn within(&self, sample: S) -> S {
        if sample < self.min {
            self.min
        } else if sample > self.max {
            self.max
        } else {
            sample
        }
    }

    /// Fills `order` with the neurons in the order in which they fire; returns the lowest of them.
    #[inline]
    pub(super) fn order(&self, sample: S, winner: usize, order: &mut [u16]) -> u16 {
        let (mut lowest, mut above) = (winner, winner.wrapping_add(1));
        let Some((first, others)) = order.split_first_mut() else { return 0 };
        *first = winner as u16;
        for neuron in others {
            let is_above = match (self.below(lowest), self.centres.get(above)) {
                (Some(low), Some(&high)) => sample > low.midway(high),
                (below, _) => below.is_none(),
            };
            if is_above {
                *neuron = above as u16;
                above = above.wrapping_add(1);
            } else {
                lowest = lowest.wrapping_sub(1);
                *neuron = lowest as u16;
            }
        }
        lowest as u16
    }

    /// The centre below a neuron.
    #[inline]
    fn below(&self, neuron: usize) -> Option<S> {
        self.centres.get(neuron.wrapping_sub(1)).copied()
    }

    /// The middle of the values that have these spikes of neighbouring neurons. `first` is the lowest neuron; `ranks`
    /// are the slots from that neuron upwards. `None` if the first spike is missing, or no value has it.
    #[inline]
    pub(super) fn value(&self, first: usize, ranks: &[u8]) -> Option<S> {
        let nearest = ranks.iter().position(|&rank| rank == 0)?;
        let (lower, upper) = ranks.split_at_checked(nearest)?;
        let (mut lower, mut upper) = (lower.iter().rev(), upper.iter().skip(1));
        let mut lowest = first.wrapping_add(nearest);
        let mut above = lowest.wrapping_add(1);

        let whole = Interval { above: None, last: self.max };
        let centre = *self.centres.get(lowest)?;
        let cut = self.below(lowest).map_or(whole, |low| whole.above(low.midway(centre), self.min));
        let cut = self.centres.get(above).map_or(cut, |&high| cut.up_to(centre.midway(high)));
        let mut known = cut.if_any(self.min)?;

        let (mut next_lower, mut next_upper) = (lower.next(), upper.next());
        for rank in 1..=u8::MAX {
            let is_lower = next_lower == Some(&rank);
            if !is_lower && next_upper != Some(&rank) {
                break;
            }
            let middle = match (self.below(lowest), self.centres.get(above)) {
                (Some(low), Some(&high)) => Some(low.midway(high)),
                _ => None,
            };
            let cut = match middle {
                Some(middle) if is_lower => known.up_to(middle),
                Some(middle) => known.above(middle, self.min),
                None => known,
            };
            let Some(cut) = cut.if_any(self.min) else { break };
            known = cut;
            if is_lower {
                lowest = lowest.wrapping_sub(1);
                next_lower = lower.next();
            } else {
                above = above.wrapping_add(1);
                next_upper = upper.next();
            }
        }
        Some(known.middle(self.min))
    }
}

/// The values above one value and up to another.
#[derive(Clone, Copy)]
struct Interval<S> {
    /// `None` if the interval begins with the minimum.
    above: Option<S>,
    last: S,
}

impl<S: Sample> Interval<S> {
    /// The interval without the values up to this one.
    #[inline]
    fn above(self, value: S, min: S) -> Self {
        let is_higher = value >= self.above.unwrap_or(min);
        Self { above: if is_higher { Some(value) } else { self.above }, ..self }
    }

    /// The interval without the values above this one.
    #[inline]
    fn up_to(self, value: S) -> Self {
        Self { last: if value < self.last { value } else { self.last }, ..self }
    }

    /// The interval; `None` if it is empty.
    #[inline]
    fn if_any(self, min: S) -> Option<Self> {
        let has_any = self.above.map_or(min <= self.last, |above| above < self.last);
        has_any.then_some(self)
    }

    #[inline]
    fn middle(self, min: S) -> S {
        self.above.map_or(min, S::next).midway(self.last)
    }
}

impl<S: Sample, const M: usize, const K: usize> Start for RankOrder<S, M, K> {
    const START: SlotsState = SlotsState::START;
}

impl<S: Sample, const M: usize, const K: usize> Scheme for RankOrder<S, M, K> {
    type Sample = S;
    type Code = SlotSpikes<M, K>;
    type Output = SlotSpikes<M, K>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.ranks().fingerprint(K)
    }

    encode_in_place!(SlotsState, SlotSpikes<M, K>);

    fn decode(&self, state: &mut Held<S>, spikes: SlotSpikes<M, K>) -> S {
        state.or_hold(self.ranks().value(spikes.first(), spikes.slots()))
    }

    centred!(SlotsState);
}
