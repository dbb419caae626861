//! Population codes whose number of neurons is chosen at run time.

use core::ops::RangeInclusive;

use alloc::vec;
use alloc::vec::Vec;

use super::centres::{even, gaussian_spaced, halfway_edges};
use super::fields::tables;
use super::nonlinear::{companded, crossings, own_widths, spacings};
use super::{Neuron, PositionState, SlotSpikes, SlotsState};
use crate::error::{positive, within};
use crate::num::{Distance, DoubleDouble, EvenBins, reach};
use crate::scheme::cells::{count_preceding, number_by_search};
use crate::scheme::held::Held;
use crate::{ConfigError, Encoder, Recovery, Sample, Scheme};

/// The most neurons of a population.
pub const NEURONS: usize = 1024;

/// The most levels of a response, which is also the most slots of a sample.
pub const LEVELS: usize = 256;

/// Checks that there are 3 to `most` neurons, and no more than [`NEURONS`].
pub(super) fn check_neurons(neurons: usize, most: usize) -> Result<(), ConfigError> {
    within("neurons", neurons as f64, 3.0, most.min(NEURONS) as f32)
}

/// Checks that there is a width for each neuron.
pub(super) fn check_widths(neurons: usize, widths: &[f32]) -> Result<(), ConfigError> {
    let neurons = neurons as f32;
    within("number of widths", widths.len() as f64, neurons, neurons)
}

/// [`population::Position`](crate::population::Position) with any number of neurons, up to `M`.
#[derive(Clone, Debug, PartialEq)]
pub struct Position<S: Sample, const M: usize = NEURONS> {
    centres: Vec<S>,
    /// `edges[i]` is the largest value that belongs to neuron `i`; the last neuron has none.
    edges: Vec<S>,
}

impl<S: Sample, const M: usize> Position<S, M> {
    /// The user's own centres, strictly rising.
    ///
    /// # Errors
    /// There are not 3 to `M` centres; a centre is not finite, or does not exceed the one before.
    pub fn try_new(centres: &[S]) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        let mut edges = centres.to_vec();
        halfway_edges(centres, &mut edges)?;
        Ok(Self::of(centres.to_vec(), edges))
    }

    /// Even centres over a range, half a spacing beyond it at either end.
    ///
    /// # Errors
    /// There are not 3 to `M` neurons; the ends are not finite, or do not rise, or the sample type is too
    /// coarse to tell the centres apart.
    pub fn try_linear(neurons: usize, range: &RangeInclusive<S>) -> Result<Self, ConfigError> {
        check_neurons(neurons, M)?;
        let (mut centres, mut edges) = (vec![S::ZERO; neurons], vec![S::ZERO; neurons]);
        even(range, &mut centres, &mut edges)?;
        Ok(Self::of(centres, edges))
    }

    /// Centres over a range spaced as the quantiles of a normal distribution.
    ///
    /// # Errors
    /// As for [`try_linear`](Self::try_linear).
    pub fn try_gaussian_spaced(
        neurons: usize,
        range: &RangeInclusive<S>,
    ) -> Result<Self, ConfigError> {
        check_neurons(neurons, M)?;
        let mut centres = vec![S::ZERO; neurons];
        gaussian_spaced(range, &mut centres)?;
        Self::try_new(&centres)
    }

    /// Receptive fields with these centres and widths `sigma`, of which the strongest response fires.
    ///
    /// # Errors
    /// There are not 3 to `M` centres and as many widths; otherwise as for
    /// [`population::Position`](crate::population::Position::try_with_widths).
    pub fn try_with_widths(centres: &[S], widths: &[f32]) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        check_widths(centres.len(), widths)?;
        let mut sigmas = vec![0.0; widths.len()];
        own_widths(widths, &mut sigmas)?;
        Self::of_fields(centres, &sigmas)
    }

    /// Receptive fields with these centres, each as wide as the distance between its neighbours.
    ///
    /// # Errors
    /// There are not 3 to `M` centres; otherwise as for
    /// [`population::Position`](crate::population::Position::try_spaced).
    pub fn try_spaced(centres: &[S]) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        let mut sigmas = vec![0.0; centres.len()];
        spacings(centres, &mut sigmas);
        Self::of_fields(centres, &sigmas)
    }

    /// Companded centres, dense in the middle of the range, with fields as wide as their spacing.
    ///
    /// # Errors
    /// There are not 3 to `M` neurons; otherwise as for
    /// [`population::Position`](crate::population::Position::try_companded).
    pub fn try_companded(
        neurons: usize,
        range: &RangeInclusive<S>,
        companding: f32,
    ) -> Result<Self, ConfigError> {
        check_neurons(neurons, M)?;
        let mut centres = vec![S::ZERO; neurons];
        companded(range, companding, &mut centres)?;
        Self::try_spaced(&centres)
    }

    fn of_fields(centres: &[S], widths: &[f64]) -> Result<Self, ConfigError> {
        let mut edges = centres.to_vec();
        crossings(centres, widths, &mut edges)?;
        Ok(Self::of(centres.to_vec(), edges))
    }

    fn of(centres: Vec<S>, mut edges: Vec<S>) -> Self {
        edges.pop();
        Self { centres, edges }
    }

    /// The centres, lowest first, rounded to the sample type.
    pub fn centres(&self) -> &[S] {
        &self.centres
    }

    /// The state of an encoder before its first sample.
    pub fn state(&self) -> PositionState {
        PositionState::START
    }

    /// An encoder in its initial state.
    pub fn encoder(&self) -> Encoder<'_, Self> {
        Encoder::with_state(self, self.state())
    }
}

impl<S: Sample, const M: usize> Scheme for Position<S, M> {
    type Sample = S;
    type Code = Option<Neuron<M>>;
    type Output = Option<Neuron<M>>;
    type EncoderState = PositionState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn encode(&self, state: &mut PositionState, sample: S) -> Option<Neuron<M>> {
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        Neuron::counted(number_by_search(&self.edges, sample) as u16)
    }

    fn rejected(state: &PositionState) -> u32 {
        state.tally.rejected()
    }

    /// The middle centre.
    fn decoder_state(&self) -> Held<S> {
        middle(&self.centres)
    }

    /// The centre of the neuron; if none fired, the previous value.
    fn decode(&self, state: &mut Held<S>, neuron: Option<Neuron<M>>) -> S {
        let centre = neuron.and_then(|neuron| self.centres.get(usize::from(neuron.index())));
        state.or_hold(centre.copied())
    }

    fn held(&self, state: &Held<S>) -> Option<S> {
        Some(state.value())
    }

    fn neurons(&self) -> usize {
        self.centres.len()
    }

    fn resync(&self, state: &mut Held<S>, value: S) {
        *state = Held::at(value);
    }
}

pub(super) fn middle<S: Sample>(centres: &[S]) -> Held<S> {
    Held::at(centres.get(centres.len() / 2).copied().unwrap_or(S::ZERO))
}

/// Receptive fields of any number of neurons and levels.
#[derive(Clone, Debug, PartialEq)]
struct Fields<S: Sample> {
    centres: Vec<S>,
    min: S,
    max: S,
    /// A value in bin `i` is out of reach of the neurons below `i`.
    bins: EvenBins,
    /// `reaches[slot]` is the largest distance at which a neuron fires in this slot or an earlier one.
    reaches: Vec<S::Reach>,
}

impl<S: Sample> Fields<S> {
    fn try_new<const M: usize>(
        neurons: usize,
        levels: usize,
        range: &RangeInclusive<S>,
        beta: f32,
    ) -> Result<Self, ConfigError> {
        positive("beta", beta as f64)?;
        within("slots", levels as f64, 2.0, LEVELS as f32)?;
        let Position { centres, .. } = Position::<S, M>::try_linear(neurons, range)?;
        let mut reaches = vec![reach::<S>(DoubleDouble::ZERO, neurons); levels];
        let (bins, _) = tables::<S>(neurons, range, beta, &mut reaches);
        Ok(Self { centres, min: *range.start(), max: *range.end(), bins, reaches })
    }

    fn is_above(&self, value: S, neuron: usize) -> bool {
        self.centres.get(neuron).is_some_and(|&centre| value > centre)
    }

    /// The distances of a finite value from this neuron and those after it.
    fn distances(&self, value: S, first: usize) -> impl Iterator<Item = S::Reach> + '_ {
        let centres = self.centres.get(first..).unwrap_or_default();
        centres.iter().zip(first..).map(move |(&centre, neuron)| {
            S::Reach::between(value, centre, neuron, self.centres.len(), self.min, self.max)
        })
    }

    /// The largest distance with at least this level, from 1.
    fn reach(&self, level: usize) -> Option<S::Reach> {
        self.reaches.get(self.reaches.len().wrapping_sub(level)).copied()
    }

    /// The slot at this distance, which is within the reach of level 1: the number of levels minus the level.
    fn slot(&self, distance: S::Reach) -> usize {
        count_preceding(self.reaches.len() - 1, |slot| {
            self.reaches.get(slot).is_some_and(|&reach| distance > reach)
        })
    }

    /// The mean of the centres from `first` on, weighted by their levels; `None` if no neuron has a level.
    fn mean(&self, first: usize, levels: impl Iterator<Item = Option<u32>>) -> Option<S> {
        let mut weighted = S::Weighted::default();
        let mut total = 0;
        let centres = self.centres.get(first..)?;
        for ((level, &centre), neuron) in levels.zip(centres).zip(first..) {
            if let Some(level) = level {
                weighted = S::weigh(weighted, centre, neuron, level);
                total += level;
            }
        }
        (total > 0).then(|| S::mean(weighted, total, self.centres.len(), self.min, self.max))
    }
}

/// [`population::Slots`](crate::population::Slots) with any number of neurons, up to `M`, and 2 to 256 slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Slots<S: Sample, const M: usize = NEURONS> {
    fields: Fields<S>,
    floor: u16,
}

impl<S: Sample, const M: usize> Slots<S, M> {
    /// Receptive fields over a range, with every level from 1 firing. The smaller `beta`, the wider the fields.
    ///
    /// # Errors
    /// There are not 3 to `M` neurons or not 2 to 256 slots; the ends are not finite, or do not rise, or the
    /// sample type is too coarse to tell the centres apart; `beta` is not above 0.
    pub fn try_new(
        neurons: usize,
        slots: usize,
        range: &RangeInclusive<S>,
        beta: f32,
    ) -> Result<Self, ConfigError> {
        Ok(Self { fields: Fields::try_new::<M>(neurons, slots, range, beta)?, floor: 1 })
    }

    /// Sets the lowest level that fires; 1 by default.
    ///
    /// # Errors
    /// The floor is not within 1 to the number of slots.
    pub fn try_with_floor(self, floor: u16) -> Result<Self, ConfigError> {
        within("floor", floor as f64, 1.0, self.fields.reaches.len() as f32)?;
        Ok(Self { floor, ..self })
    }

    /// The centres, lowest first, rounded to the sample type.
    pub fn centres(&self) -> &[S] {
        &self.fields.centres
    }

    /// The state of an encoder before its first sample.
    pub fn state(&self) -> SlotsState {
        SlotsState::START
    }

    /// An encoder in its initial state.
    pub fn encoder(&self) -> Encoder<'_, Self> {
        Encoder::with_state(self, self.state())
    }

    /// Fires the neurons from `first` on, up to one that does not reach a finite sample; false if none fired.
    fn fire_from(&self, sample: S, first: usize, spikes: &mut SlotSpikes<M, LEVELS>) -> bool {
        let Some(reach) = self.fields.reach(self.floor.into()) else { return false };
        let near = self.fields.distances(sample, first).take_while(|&distance| distance <= reach);
        let mut length = 0;
        for (slot, distance) in spikes.slots.iter_mut().zip(near) {
            *slot = self.fields.slot(distance) as u8;
            length += 1;
        }
        if length > 0 {
            spikes.first = first as u16;
            spikes.length = length;
        }
        length > 0
    }
}

impl<S: Sample, const M: usize> Scheme for Slots<S, M> {
    type Sample = S;
    type Code = SlotSpikes<M, LEVELS>;
    type Output = SlotSpikes<M, LEVELS>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn encode(&self, state: &mut SlotsState, sample: S) -> SlotSpikes<M, LEVELS> {
        let mut spikes = SlotSpikes::EMPTY;
        if !sample.is_finite() {
            state.tally.reject();
            return spikes;
        }
        let mut first = sample.bin(self.fields.bins);
        while !self.fire_from(sample, first, &mut spikes) && self.fields.is_above(sample, first) {
            first += 1;
        }
        spikes
    }

    fn rejected(state: &SlotsState) -> u32 {
        state.tally.rejected()
    }

    /// The middle centre.
    fn decoder_state(&self) -> Held<S> {
        middle(&self.fields.centres)
    }

    fn decode(&self, state: &mut Held<S>, spikes: SlotSpikes<M, LEVELS>) -> S {
        let levels = self.fields.reaches.len() as u32;
        let levels = spikes.slots().iter().map(|&slot| levels.checked_sub(slot.into()));
        state.or_hold(self.fields.mean(spikes.first(), levels))
    }

    fn held(&self, state: &Held<S>) -> Option<S> {
        Some(state.value())
    }

    fn slots(&self) -> usize {
        self.fields.reaches.len()
    }

    fn neurons(&self) -> usize {
        self.fields.centres.len()
    }

    fn resync(&self, state: &mut Held<S>, value: S) {
        *state = Held::at(value);
    }
}

#[cfg(feature = "rand")]
pub use random::Probabilistic;

#[cfg(feature = "rand")]
mod random {
    use core::marker::PhantomData;
    use core::ops::RangeInclusive;

    use rand_core::Rng;

    use super::{Fields, NEURONS, middle};
    use crate::population::{FiredNeurons, Held, ProbabilisticState};
    use crate::{ConfigError, Encoder, Recovery, Sample, Scheme};

    /// [`population::Probabilistic`](crate::population::Probabilistic) with any number of neurons, up to
    /// `M`.
    #[derive(Debug)]
    pub struct Probabilistic<S: Sample, G, const M: usize = NEURONS> {
        fields: Fields<S>,
        generator: PhantomData<fn() -> G>,
    }

    impl<S: Sample, G: Rng, const M: usize> Probabilistic<S, G, M> {
        /// The number of probabilities.
        const LEVELS: usize = super::LEVELS;

        /// Receptive fields over a range, with responses rounded to 256 probabilities. The smaller `beta`, the
        /// wider the fields.
        ///
        /// # Errors
        /// There are not 3 to `M` neurons; the ends are not finite, or do not rise, or the sample type is
        /// too coarse to tell the centres apart; `beta` is not above 0.
        pub fn try_new(
            neurons: usize,
            range: &RangeInclusive<S>,
            beta: f32,
        ) -> Result<Self, ConfigError> {
            let fields = Fields::try_new::<M>(neurons, Self::LEVELS, range, beta)?;
            Ok(Self { fields, generator: PhantomData })
        }

        /// The centres, lowest first, rounded to the sample type.
        pub fn centres(&self) -> &[S] {
            &self.fields.centres
        }

        /// The state of an encoder that draws from this generator.
        pub fn state(generator: G) -> ProbabilisticState<G> {
            ProbabilisticState::new(generator)
        }

        /// An encoder that draws from this generator.
        pub fn encoder(&self, generator: G) -> Encoder<'_, Self> {
            Encoder::with_state(self, Self::state(generator))
        }
    }

    impl<S: Sample, G: Rng, const M: usize> Scheme for Probabilistic<S, G, M> {
        type Sample = S;
        type Code = FiredNeurons<M>;
        type Output = FiredNeurons<M>;
        type EncoderState = ProbabilisticState<G>;
        type DecoderState = Held<S>;

        const LATENCY: usize = 0;
        const RECOVERY: Recovery = Recovery::Spike;

        fn encode(&self, state: &mut ProbabilisticState<G>, sample: S) -> FiredNeurons<M> {
            let mut neurons = FiredNeurons::EMPTY;
            if !sample.is_finite() {
                state.tally.reject();
                return neurons;
            }
            let fields = &self.fields;
            let first = sample.bin(fields.bins);
            let Some(reach) = fields.reach(1) else { return neurons };
            let fired = neurons.fired.iter_mut().enumerate().skip(first);
            for ((neuron, fired), distance) in fired.zip(fields.distances(sample, first)) {
                if distance <= reach {
                    let draw = state.generator.next_u32() >> (32 - Self::LEVELS.ilog2());
                    *fired = fields.reach(draw as usize + 1).is_some_and(|reach| distance <= reach);
                } else if !fields.is_above(sample, neuron) {
                    break;
                }
            }
            neurons
        }

        fn rejected(state: &ProbabilisticState<G>) -> u32 {
            state.tally.rejected()
        }

        /// The middle centre.
        fn decoder_state(&self) -> Held<S> {
            middle(&self.fields.centres)
        }

        fn decode(&self, state: &mut Held<S>, neurons: FiredNeurons<M>) -> S {
            let levels = neurons.fired.iter().map(|&fired| fired.then_some(1));
            state.or_hold(self.fields.mean(0, levels))
        }

        fn held(&self, state: &Held<S>) -> Option<S> {
            Some(state.value())
        }

        fn neurons(&self) -> usize {
            self.fields.centres.len()
        }

        fn resync(&self, state: &mut Held<S>, value: S) {
            *state = Held::at(value);
        }
    }
}
