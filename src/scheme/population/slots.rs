//! Gaussian receptive fields with sub-timesteps: the stronger the response, the earlier the spike.

use core::ops::RangeInclusive;

use super::Held;
use super::SlotSpikes;
use super::fields::{Fields, ReceptiveFields};
use super::methods::{centred, encode_in_place};
use crate::error::{tri, unwrap, within};
use crate::num::{Distance, Tally};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme, Start};

/// Gaussian receptive fields whose neurons fire in one of `N` sub-timesteps of a sample, its slots.
///
/// `M` neurons with even centres `mu` respond by `r = exp(-(x - mu)² / (2 sigma²))`, where
/// `sigma = (max - min) / (beta (M - 2))`. The level `k` of a response is `N r`, rounded half up. A level
/// fires in slot `N - k`; a level below the floor is silent. Each level has a largest distance from the centre, so
/// that a table of `N` distances replaces the exponential.
///
/// - **M:** 3 to 1024. **N:** 2 to 256. **Beta:** above 0; the paper takes 1.5.
/// - **Floor:** 1 to `N`; 1 unless set by [`with_floor`](Self::with_floor).
/// - **Latency:** 0 samples. How long a slot lasts is up to the caller.
///   **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes
///   `4 M + 4 N + 32` bytes of flash in `f32`.
/// - **Work:** only neurons that respond, and one more at either end, are visited; no exponential.
/// - **Exactness:** `f32` compares the distance to the rounded centre, rounded once, with the rounded table;
///   fixed point compares exact distances to the unrounded centre.
/// - **Range:** a value so far outside the range that no level reaches the floor fires no neuron.
/// - **Error:** at most the mean of the distances within which the neurons' levels are reached, weighted by these
///   levels.
/// - **Decoder:** the mean of the centres weighted by their levels, `N - slot`; if no neuron fired, the previous
///   value. One division a sample. Fixed point gives the exact mean, rounded to the
///   nearest, halves upwards.
///
/// Source: Bohté et al. 2002; paper, section II-A.
///
/// ```
/// use spikewire::{Scheme, population::Slots};
///
/// static TILT: Slots<f32, 4, 100> = Slots::new(0.0..=1.0, 1.5);
///
/// let spikes = TILT.encoder().encode(0.1);
/// assert!(spikes.iter().eq([(0, 42), (1, 10), (2, 85)]));
/// assert!((TILT.decoder().decode(spikes) - 0.1).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct Slots<S: Sample, const M: usize, const N: usize> {
    fields: ReceptiveFields<S, M, N>,
    floor: u16,
}

impl<S: Sample, const M: usize, const N: usize> Slots<S, M, N> {
    /// Fields over a range, with every level from 1 firing. The smaller `beta`, the wider the fields. For constants,
    /// where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, beta: f32) -> Self {
        unwrap(Self::try_new(range, beta))
    }

    /// Fields over a range, with every level from 1 firing. The smaller `beta`, the wider the fields.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or the sample type is too coarse to tell the
    /// centres apart; `beta` is not above 0.
    pub const fn try_new(range: RangeInclusive<S>, beta: f32) -> Result<Self, ConfigError> {
        Ok(Self { fields: tri!(ReceptiveFields::try_new(&range, beta)), floor: 1 })
    }

    /// Sets the lowest level that fires; 1 by default. For constants, where a bad floor fails the build.
    ///
    /// # Panics
    /// Panics if the floor is not within 1 to `N`.
    #[must_use]
    pub const fn with_floor(self, floor: u16) -> Self {
        unwrap(self.try_with_floor(floor))
    }

    /// Sets the lowest level that fires; 1 by default.
    ///
    /// # Errors
    /// Returns an error if the floor is not within 1 to `N`.
    pub const fn try_with_floor(self, floor: u16) -> Result<Self, ConfigError> {
        tri!(within("floor", floor as f64, 1.0, N as f32));
        Ok(Self { floor, ..self })
    }

    /// The centres, lowest first, rounded to the sample type.
    pub const fn centres(&self) -> &[S; M] {
        self.fields.centres()
    }

    /// Writes the spikes of a finite sample into `spikes`, which must be empty.
    #[inline]
    fn fire(&self, sample: S, spikes: &mut SlotSpikes<M, N>) {
        if self.fields.fields().is_near(sample) {
            self.fire_near(sample, spikes);
        } else {
            self.fire_anywhere::<S::Reach>(sample, spikes);
        }
    }

    /// Writes the spikes of a sample whose distances fit `S::Short`.
    #[inline(never)] // one copy, with the registers to itself
    fn fire_near(&self, sample: S, spikes: &mut SlotSpikes<M, N>) {
        let fields = self.fields.fields();
        if !fields.fire_from::<S::Short, M, N>(self.floor, sample, fields.first(sample), spikes) {
            self.fire_anywhere::<S::Short>(sample, spikes);
        }
    }

    /// Writes the spikes of any finite sample: where the first neuron does not fire, tries those after it.
    #[cold]
    #[inline(never)]
    fn fire_anywhere<D: Distance<S>>(&self, sample: S, spikes: &mut SlotSpikes<M, N>) {
        self.fields.fields().fire::<D, M, N>(self.floor, sample, spikes);
    }
}

impl<S: Sample> Fields<'_, S> {
    /// Writes the spikes of a finite sample, with this level and higher ones, into `spikes`, which must be empty.
    #[inline]
    pub(super) fn fire<D: Distance<S>, const M: usize, const N: usize>(
        self,
        floor: u16,
        sample: S,
        spikes: &mut SlotSpikes<M, N>,
    ) {
        let mut first = self.first(sample);
        while !self.fire_from::<D, M, N>(floor, sample, first, spikes)
            && self.is_above(sample, first)
        {
            first = first.wrapping_add(1);
        }
    }

    /// Fires the neurons from `first` on, up to one that does not reach a finite sample; false if none fired.
    #[inline]
    fn fire_from<D: Distance<S>, const M: usize, const N: usize>(
        self,
        floor: u16,
        sample: S,
        first: usize,
        spikes: &mut SlotSpikes<M, N>,
    ) -> bool {
        let reach = self.reach::<D>(floor.into());
        let distances = self.distances::<D>(sample, first);
        let (Some(reach), Some(distances)) = (reach, distances) else { return false };
        let mut length = 0_usize;
        for (slot, distance) in spikes.slots.iter_mut().zip(distances) {
            if distance > reach {
                break;
            }
            *slot = self.slot(distance) as u8;
            length = length.wrapping_add(1);
        }
        if length > 0 {
            spikes.first = first as u16;
            spikes.length = length as u16;
        }
        length > 0
    }
}

/// The state of a [`Slots`] encoder: the count of rejected samples. 4 bytes.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlotsState {
    pub(super) tally: Tally,
}

impl SlotsState {
    pub(super) const START: Self = Self { tally: Tally::NONE };
}

impl<S: Sample, const M: usize, const N: usize> Start for Slots<S, M, N> {
    const START: SlotsState = SlotsState::START;
}

impl<S: Sample, const M: usize, const N: usize> Slots<S, M, N> {
    /// Encodes a sample into `spikes`, which must be empty.
    #[inline]
    fn encode_into(&self, state: &mut SlotsState, sample: S, spikes: &mut SlotSpikes<M, N>) {
        if sample.is_finite() {
            self.fire(sample, spikes);
        } else {
            state.tally.reject();
        }
    }
}

impl<S: Sample, const M: usize, const N: usize> Scheme for Slots<S, M, N> {
    type Sample = S;
    type Code = SlotSpikes<M, N>;
    type Output = SlotSpikes<M, N>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.fields.fields().named("Slots", self.fields.beta()).number(self.floor.into())
    }

    encode_in_place!(SlotsState, SlotSpikes<M, N>);

    fn decode(&self, state: &mut Held<S>, spikes: SlotSpikes<M, N>) -> S {
        let levels = spikes.slots().iter().map(|&slot| (N as u32).wrapping_sub(slot.into()));
        state.or_hold(self.fields.fields().weighted_mean(spikes.first(), levels))
    }

    centred!(SlotsState);
}
