//! Population codes whose number of neurons is chosen at run time.

use core::ops::RangeInclusive;

use alloc::vec;
use alloc::vec::Vec;

use super::centres::{even, gaussian_spaced, halfway_edges};
use super::fields::{Fields, tables};
use super::methods::{begin, centred};
use super::nonlinear::{companded, crossings, own_widths, spacings};
use super::{Neuron, PositionState, SlotSpikes, SlotsState};
use crate::error::{positive, within};
use crate::num::{DoubleDouble, EvenBins, reach};
use crate::scheme::cells::number_by_search;
use crate::scheme::held::Held;
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme};

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
    /// Returns an error if there are not 3 to `M` centres; a centre is not finite, or does not exceed the one before.
    pub fn try_new(centres: &[S]) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        let mut edges = centres.to_vec();
        halfway_edges(centres, &mut edges)?;
        Ok(Self::of(centres.to_vec(), edges))
    }

    /// Even centres over a range, half a spacing beyond it at either end.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` neurons; the ends are not finite, or do not rise, or the sample
    /// type is too coarse to tell the centres apart.
    pub fn try_linear(neurons: usize, range: &RangeInclusive<S>) -> Result<Self, ConfigError> {
        check_neurons(neurons, M)?;
        let (mut centres, mut edges) = (vec![S::ZERO; neurons], vec![S::ZERO; neurons]);
        even(range, &mut centres, &mut edges)?;
        Ok(Self::of(centres, edges))
    }

    /// Centres over a range spaced as the quantiles of a normal distribution.
    ///
    /// # Errors
    /// Returns an error if [`try_linear`](Self::try_linear) does.
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
    /// Returns an error if there are not 3 to `M` centres and as many widths; otherwise as for
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
    /// Returns an error if there are not 3 to `M` centres; otherwise as for
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
    /// Returns an error if there are not 3 to `M` neurons; otherwise as for
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

    begin!(PositionState);
}

impl<S: Sample, const M: usize> Scheme for Position<S, M> {
    type Sample = S;
    type Code = Option<Neuron<M>>;
    type Output = Option<Neuron<M>>;
    type EncoderState = PositionState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new("Position").samples(&self.centres).samples(&self.edges)
    }

    fn encode(&self, state: &mut PositionState, sample: S) -> Option<Neuron<M>> {
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        Neuron::counted(number_by_search(&self.edges, sample) as u16)
    }

    /// The centre of the neuron; if none fired, the previous value.
    fn decode(&self, state: &mut Held<S>, neuron: Option<Neuron<M>>) -> S {
        let centre = neuron.and_then(|neuron| self.centres.get(usize::from(neuron.index())));
        state.or_hold(centre.copied())
    }

    centred!(PositionState);
}

/// Receptive fields of any number of neurons and levels.
#[derive(Clone, Debug, PartialEq)]
struct Tables<S: Sample> {
    centres: Vec<S>,
    min: S,
    max: S,
    beta: f32,
    bins: EvenBins,
    near: [S; 2],
    reaches: Vec<S::Reach>,
}

impl<S: Sample> Tables<S> {
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
        let (bins, near) = tables::<S>(neurons, range, beta, &mut reaches);
        Ok(Self { centres, min: *range.start(), max: *range.end(), beta, bins, near, reaches })
    }

    fn fields(&self) -> Fields<'_, S> {
        let Self { centres, min, max, bins, near, reaches, .. } = self;
        Fields { centres, reaches, min: *min, max: *max, bins: *bins, near: *near }
    }
}

/// [`population::Slots`](crate::population::Slots) with any number of neurons, up to `M`, and 2 to 256 slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Slots<S: Sample, const M: usize = NEURONS> {
    fields: Tables<S>,
    floor: u16,
}

impl<S: Sample, const M: usize> Slots<S, M> {
    /// Receptive fields over a range, with every level from 1 firing. The smaller `beta`, the wider the fields.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` neurons or not 2 to 256 slots; the ends are not finite, or do not
    /// rise, or the sample type is too coarse to tell the centres apart; `beta` is not above 0.
    pub fn try_new(
        neurons: usize,
        slots: usize,
        range: &RangeInclusive<S>,
        beta: f32,
    ) -> Result<Self, ConfigError> {
        Ok(Self { fields: Tables::try_new::<M>(neurons, slots, range, beta)?, floor: 1 })
    }

    /// Sets the lowest level that fires; 1 by default.
    ///
    /// # Errors
    /// Returns an error if the floor is not within 1 to the number of slots.
    pub fn try_with_floor(self, floor: u16) -> Result<Self, ConfigError> {
        within("floor", floor as f64, 1.0, self.fields.reaches.len() as f32)?;
        Ok(Self { floor, ..self })
    }

    /// The centres, lowest first, rounded to the sample type.
    pub fn centres(&self) -> &[S] {
        &self.fields.centres
    }

    begin!(SlotsState);
}

impl<S: Sample, const M: usize> Scheme for Slots<S, M> {
    type Sample = S;
    type Code = SlotSpikes<M, LEVELS>;
    type Output = SlotSpikes<M, LEVELS>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.fields.fields().named("Slots", self.fields.beta).number(self.floor.into())
    }

    fn encode(&self, state: &mut SlotsState, sample: S) -> SlotSpikes<M, LEVELS> {
        let mut spikes = SlotSpikes::EMPTY;
        if sample.is_finite() {
            self.fields.fields().fire::<S::Reach, M, LEVELS>(self.floor, sample, &mut spikes);
        } else {
            state.tally.reject();
        }
        spikes
    }

    fn decode(&self, state: &mut Held<S>, spikes: SlotSpikes<M, LEVELS>) -> S {
        let levels = self.fields.reaches.len() as u32;
        let levels = spikes.slots().iter().map(|&slot| levels.saturating_sub(slot.into()));
        state.or_hold(self.fields.fields().weighted_mean(spikes.first(), levels))
    }

    centred!(SlotsState);

    fn slots(&self) -> usize {
        self.fields.reaches.len()
    }
}

#[cfg(feature = "rand-010")]
pub use random::Probabilistic;

#[cfg(feature = "rand-010")]
mod random {
    use core::marker::PhantomData;
    use core::ops::RangeInclusive;

    use rand_core::Rng;

    use super::{LEVELS, NEURONS, Tables, centred};
    use crate::population::{FiredNeurons, Held, ProbabilisticState};
    use crate::{ConfigError, Encoder, Fingerprint, Recovery, Sample, Scheme};

    /// [`population::Probabilistic`](crate::population::Probabilistic) with any number of neurons, up to
    /// `M`.
    #[derive(Debug)]
    pub struct Probabilistic<S: Sample, G, const M: usize = NEURONS> {
        fields: Tables<S>,
        generator: PhantomData<fn() -> G>,
    }

    impl<S: Sample, G: Rng, const M: usize> Probabilistic<S, G, M> {
        /// Receptive fields over a range, with responses rounded to 256 probabilities. The smaller `beta`, the
        /// wider the fields.
        ///
        /// # Errors
        /// Returns an error if there are not 3 to `M` neurons; the ends are not finite, or do not rise, or the sample
        /// type is too coarse to tell the centres apart; `beta` is not above 0.
        pub fn try_new(
            neurons: usize,
            range: &RangeInclusive<S>,
            beta: f32,
        ) -> Result<Self, ConfigError> {
            let fields = Tables::try_new::<M>(neurons, LEVELS, range, beta)?;
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

        fn fingerprint(&self) -> Fingerprint {
            self.fields.fields().named("Probabilistic", self.fields.beta)
        }

        fn encode(&self, state: &mut ProbabilisticState<G>, sample: S) -> FiredNeurons<M> {
            let mut neurons = FiredNeurons::EMPTY;
            if !sample.is_finite() {
                state.tally.reject();
                return neurons;
            }
            self.fields.fields().draw::<S::Reach, M>(&mut state.generator, sample, &mut neurons);
            neurons
        }

        fn decode(&self, state: &mut Held<S>, neurons: FiredNeurons<M>) -> S {
            let count = self.fields.centres.len();
            let levels = neurons.fired.iter().take(count).map(|&fired| u32::from(fired));
            state.or_hold(self.fields.fields().weighted_mean(0, levels))
        }

        centred!(ProbabilisticState<G>);
    }
}
