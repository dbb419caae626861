//! Non-linear receptive fields whose number of neurons and slots is chosen at run time.

use core::ops::RangeInclusive;

use alloc::vec;
use alloc::vec::Vec;

use super::dynamic::{LEVELS, NEURONS, check_neurons, check_widths};
use super::methods::{begin, centred};
use super::nonlinear::{companded, crossings, own_widths};
use super::nonlinear_slots::{Fields, reach, spaced_widths, tables};
use super::{Held, NeuronSlots, SlotsState};
use crate::error::{positive, within};
use crate::num::{scale, widths};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme};

/// [`population::NonLinearSlots`](crate::population::NonLinearSlots) with any number of neurons, up to `M`, and of
/// slots.
#[derive(Clone, Debug, PartialEq)]
pub struct NonLinearSlots<S: Sample, const M: usize = NEURONS> {
    centres: Vec<S>,
    scales: Vec<S::Scale>,
    reaches: Vec<u32>,
    radii: Vec<S::Widths>,
}

impl<S: Sample, const M: usize> NonLinearSlots<S, M> {
    /// Fields with these centres and widths `sigma`.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` centres and as many widths, or not 2 to 256 slots; otherwise as for
    /// [`population::NonLinearSlots`](crate::population::NonLinearSlots::try_new).
    pub fn try_new(slots: usize, centres: &[S], widths: &[f32]) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        check_widths(centres.len(), widths)?;
        let mut sigmas = vec![0.0; widths.len()];
        own_widths(widths, &mut sigmas)?;
        Self::of(slots, centres, &sigmas)
    }

    /// Fields with these centres, each as wide as the distance between its neighbours; the smaller `beta`, the
    /// wider.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` centres, or not 2 to 256 slots; otherwise as for
    /// [`population::NonLinearSlots`](crate::population::NonLinearSlots::try_spaced).
    pub fn try_spaced(slots: usize, centres: &[S], beta: f32) -> Result<Self, ConfigError> {
        check_neurons(centres.len(), M)?;
        positive("beta", beta.into())?;
        let mut sigmas = vec![0.0; centres.len()];
        spaced_widths(centres, beta, &mut sigmas);
        Self::of(slots, centres, &sigmas)
    }

    /// Companded centres, dense in the middle of the range, with fields as wide as their spacing.
    ///
    /// # Errors
    /// Returns an error if there are not 3 to `M` neurons, or not 2 to 256 slots; otherwise as for
    /// [`population::NonLinearSlots`](crate::population::NonLinearSlots::try_companded).
    pub fn try_companded(
        neurons: usize,
        slots: usize,
        range: &RangeInclusive<S>,
        companding: f32,
        beta: f32,
    ) -> Result<Self, ConfigError> {
        check_neurons(neurons, M)?;
        let mut centres = vec![S::ZERO; neurons];
        companded(range, companding, &mut centres)?;
        Self::try_spaced(slots, &centres, beta)
    }

    fn of(slots: usize, centres: &[S], sigmas: &[f64]) -> Result<Self, ConfigError> {
        within("slots", slots as f64, 2.0, LEVELS as f32)?;
        crossings(centres, sigmas, &mut centres.to_vec())?;
        let (mut scales, mut radii) =
            (vec![scale::<S>(1.0); centres.len()], vec![widths::<S>(0.0); slots]);
        tables::<S>(centres, sigmas, &mut scales, &mut radii)?;
        let fields =
            Self { reaches: vec![0; centres.len()], centres: centres.to_vec(), scales, radii };
        fields.try_with_floor(1)
    }

    /// Sets the lowest level that fires; 1 by default.
    ///
    /// # Errors
    /// Returns an error if the floor is not within 1 to the number of slots.
    pub fn try_with_floor(mut self, floor: u16) -> Result<Self, ConfigError> {
        within("floor", floor.into(), 1.0, self.radii.len() as f32)?;
        reach::<S>(&self.scales, &self.radii, floor.into(), &mut self.reaches);
        Ok(self)
    }

    /// The centres, lowest first.
    pub fn centres(&self) -> &[S] {
        &self.centres
    }

    begin!(SlotsState);

    fn fields(&self) -> Fields<'_, S> {
        let Self { centres, scales, reaches, radii } = self;
        Fields { centres, scales, reaches, radii }
    }
}

impl<S: Sample, const M: usize> Scheme for NonLinearSlots<S, M> {
    type Sample = S;
    type Code = NeuronSlots<M, LEVELS>;
    type Output = NeuronSlots<M, LEVELS>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.fields().fingerprint()
    }

    fn encode(&self, state: &mut SlotsState, sample: S) -> NeuronSlots<M, LEVELS> {
        let mut spikes = NeuronSlots::EMPTY;
        if sample.is_finite() {
            self.fields().respond(sample, &mut spikes.slots);
        } else {
            state.tally.reject();
        }
        spikes
    }

    fn decode(&self, state: &mut Held<S>, spikes: NeuronSlots<M, LEVELS>) -> S {
        state.or_hold(self.fields().mean(&spikes.slots))
    }

    centred!(SlotsState);

    fn slots(&self) -> usize {
        self.radii.len()
    }
}
