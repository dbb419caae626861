//! Non-linear receptive fields with sub-timesteps: the stronger the response, the earlier the spike.

use core::ops::RangeInclusive;

use super::fields::level_radius;
use super::methods::{centred, encode_in_place};
use super::nonlinear::{companded, crossings, own_widths, spacings};
use super::{Held, NeuronSlots, SlotsState};
use crate::error::{offset, positive, tri, unwrap, within};
use crate::num::{scale, to_f64, widths, within_widths};
use crate::scheme::cells::count_preceding;
use crate::{ConfigError, Fingerprint, Recovery, Sample, SampleKind, Scheme, Start};

/// Non-linear Gaussian receptive fields whose neurons fire in one of `N` sub-timesteps of a sample, its slots.
///
/// `M` neurons with any centres `mu` and widths `sigma` respond by `r = exp(-(x - mu)² / (2 sigma²))`. The level
/// `k` of a response is `N r`, rounded half up. A level fires in slot `N - k`; a level below the floor is silent. A
/// level is reached within `sqrt(2 ln(N / (k - 1/2)))` widths of the centre, so that a table of `N` such distances,
/// for all neurons, replaces the exponential.
///
/// - **M:** 3 to 1024. **N:** 2 to 256. **Floor:** 1 to `N`; 1 [by default](Self::with_floor).
/// - **Centres and widths:** as for the [winner](super::Gaussian::with_widths), and refused where that refuses them.
///   In `f32` centres lie within 10³¹ of 0, and widths within 1.2e-38 to 3.4e38.
/// - **Latency:** 0 samples, within which the slots last as long as the caller makes them.
///   **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes `12 M + 4 N + 4` bytes of flash in `f32`.
/// - **Work:** a subtraction and a comparison a neuron, and for each one that responds a multiplication and a search
///   among `N` levels; no exponential.
/// - **Exactness:** `f32` rounds the distance and its product with `1 / sigma` once each. Fixed point compares
///   `|x - mu|`, exact, times `2³² / sigma`, rounded to a whole number, with whole numbers. Of a field wider than 2²⁴
///   units in the last place this rounding keeps fewer than 8 significant bits.
/// - **Range:** a value so far from all centres that no neuron reaches the floor fires none.
/// - **Decoder:** the mean of the centres weighted by their levels, `N - slot`; where no neuron fired, the value
///   before. One division a sample. Fixed point gives the exact mean, rounded to the nearest, halves upwards.
/// - **Error:** at most the mean of the distances within which the neurons' levels are reached, weighted by these
///   levels.
///
/// Source: Bohté et al. 2002; ITU-T G.711 (µ-law), for the companding.
///
/// ```
/// use spikewire::{Scheme, population::NonLinearSlots};
///
/// static ERROR: NonLinearSlots<i16, 5, 10> = NonLinearSlots::spaced([0, 10, 30, 70, 150], 1.5);
///
/// let spikes = ERROR.encoder().encode(100);
/// assert!(spikes.iter().eq([(3, 2), (4, 4)]));
/// assert_eq!(ERROR.decoder().decode(spikes), 104);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct NonLinearSlots<S: Sample, const M: usize, const N: usize> {
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array::serialize"))]
    centres: [S; M],
    floor: u16,
    /// `1 / sigma` of each neuron.
    #[cfg_attr(feature = "serde", serde(skip))]
    scales: [S::Scale; M],
    /// The largest distance with a level of at least the floor, for each neuron.
    #[cfg_attr(feature = "serde", serde(skip))]
    reaches: [u32; M],
    /// `radii[slot]` is how many widths a level of at least `N - slot` reaches. They rise.
    #[cfg_attr(feature = "serde", serde(skip))]
    radii: [S::Widths; N],
}

/// Leaves out the tables.
#[cfg(feature = "defmt")]
impl<S: Sample + defmt::Format, const M: usize, const N: usize> defmt::Format
    for NonLinearSlots<S, M, N>
{
    fn format(&self, f: defmt::Formatter<'_>) {
        let Self { centres, floor, .. } = self;
        defmt::write!(f, "NonLinearSlots {{ centres: {}, floor: {} }}", centres, floor);
    }
}

impl<S: Sample, const M: usize, const N: usize> NonLinearSlots<S, M, N> {
    const SHAPE: () = {
        assert!(M >= 3 && M <= 1024, "a population takes 3 to 1024 neurons");
        assert!(N >= 2 && N <= 256, "a response has 2 to 256 levels");
    };

    /// Fields with these centres and widths `sigma`. For constants, where bad ones fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(centres: [S; M], widths: [f32; M]) -> Self {
        unwrap(Self::try_new(centres, widths))
    }

    /// Fields with these centres and widths `sigma`, in the samples' unit.
    ///
    /// # Errors
    /// Returns an error if a centre is not finite, or does not exceed the one before; a width is not above 0 and
    /// finite; a field wins where two others meet, or wins nowhere; in `f32` a centre or a width is too large, or a
    /// width too small.
    pub const fn try_new(centres: [S; M], widths: [f32; M]) -> Result<Self, ConfigError> {
        let mut sigmas = [0.0; M];
        tri!(own_widths(&widths, &mut sigmas));
        Self::of(centres, sigmas)
    }

    /// Fields with these centres, each as wide as the distance between its neighbours. For constants, where bad
    /// parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_spaced`](Self::try_spaced) returns an error.
    pub const fn spaced(centres: [S; M], beta: f32) -> Self {
        unwrap(Self::try_spaced(centres, beta))
    }

    /// Fields with these centres, each as wide as the distance between its neighbours:
    /// `sigma[i] = (mu[i+1] - mu[i-1]) / 2 beta`, and the one spacing over `beta` at either end.
    ///
    /// # Errors
    /// Returns an error if a centre is not finite, or does not exceed the one before; `beta` is not above 0 and
    /// finite; a field wins where two others meet.
    pub const fn try_spaced(centres: [S; M], beta: f32) -> Result<Self, ConfigError> {
        tri!(positive("beta", beta as f64));
        let mut sigmas = [0.0; M];
        spaced_widths(&centres, beta, &mut sigmas);
        Self::of(centres, sigmas)
    }

    /// [Companded](super::Gaussian::try_companded) centres, dense in the middle of the range, with fields
    /// [as wide as their spacing](Self::spaced). For constants, where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_companded`](Self::try_companded) returns an error.
    pub const fn companded(range: RangeInclusive<S>, companding: f32, beta: f32) -> Self {
        unwrap(Self::try_companded(range, companding, beta))
    }

    /// [Companded](super::Gaussian::try_companded) centres, dense in the middle of the range, with fields
    /// [as wide as their spacing](Self::try_spaced).
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise; the companding or `beta` is not above 0 and
    /// finite; the sample type is too coarse to tell the centres apart.
    pub const fn try_companded(
        range: RangeInclusive<S>,
        companding: f32,
        beta: f32,
    ) -> Result<Self, ConfigError> {
        let mut centres = [S::ZERO; M];
        tri!(companded(&range, companding, &mut centres));
        Self::try_spaced(centres, beta)
    }

    const fn of(centres: [S; M], sigmas: [f64; M]) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut scales = [scale::<S>(1.0); M];
        let mut radii = [widths::<S>(0.0); N];
        let mut edges = centres;
        tri!(crossings(&centres, &sigmas, &mut edges));
        tri!(tables::<S>(&centres, &sigmas, &mut scales, &mut radii));
        let mut reaches = [0; M];
        reach::<S>(&scales, &radii, 1, &mut reaches);
        Ok(Self { centres, floor: 1, scales, reaches, radii })
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
        let mut reaches = self.reaches;
        reach::<S>(&self.scales, &self.radii, floor as usize, &mut reaches);
        Ok(Self { floor, reaches, ..self })
    }

    /// The centres, lowest first.
    pub const fn centres(&self) -> &[S; M] {
        &self.centres
    }

    const fn fields(&self) -> Fields<'_, S> {
        let Self { centres, scales, reaches, radii, .. } = self;
        Fields { centres, scales, reaches, radii }
    }

    #[inline]
    fn encode_into(&self, state: &mut SlotsState, sample: S, spikes: &mut NeuronSlots<M, N>) {
        if sample.is_finite() {
            self.fields().respond(sample, &mut spikes.slots);
        } else {
            state.tally.reject();
        }
    }
}

/// `sigma` of fields as wide as their spacing.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn spaced_widths<S: Sample>(centres: &[S], beta: f32, sigmas: &mut [f64]) {
    spacings(centres, sigmas);
    let mut i = 0;
    while i < sigmas.len() {
        sigmas[i] /= 2.0 * beta as f64;
        i += 1;
    }
}

/// Sets the scale of each neuron, and the radius of each level in widths.
///
/// # Errors
/// Returns an error if a centre is too large for `f32`, or a width too small or too large.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn tables<S: Sample>(
    centres: &[S],
    sigmas: &[f64],
    scales: &mut [S::Scale],
    radii: &mut [S::Widths],
) -> Result<(), ConfigError> {
    let mut i = 0;
    while i < scales.len() {
        if matches!(S::KIND, SampleKind::F32) {
            tri!(offset("centre", to_f64(centres[i])));
            tri!(within("width", sigmas[i], f32::MIN_POSITIVE, f32::MAX));
        }
        scales[i] = scale::<S>(sigmas[i]);
        i += 1;
    }
    let n = radii.len();
    i = 0;
    while i < n {
        radii[i] = widths::<S>(level_radius(n - i, n).rounded());
        i += 1;
    }
    Ok(())
}

/// Sets the largest distance with at least this level, 1 to `N`, for each neuron.
#[allow(clippy::indexing_slicing)] // constants have no iterators
pub(super) const fn reach<S: Sample>(
    scales: &[S::Scale],
    radii: &[S::Widths],
    level: usize,
    reaches: &mut [u32],
) {
    let mut i = 0;
    // Levels count from 1, which the compiler does not know of `level`.
    while i < scales.len() && i < reaches.len() && level >= 1 && level <= radii.len() {
        reaches[i] = within_widths::<S>(radii[radii.len() - level], scales[i]);
        i += 1;
    }
}

/// The tables of the fields: one entry a neuron; of `radii` one a slot.
pub(super) struct Fields<'f, S: Sample> {
    pub(super) centres: &'f [S],
    pub(super) scales: &'f [S::Scale],
    pub(super) reaches: &'f [u32],
    pub(super) radii: &'f [S::Widths],
}

impl<S: Sample> Fields<'_, S> {
    pub(super) fn fingerprint(&self) -> Fingerprint {
        let centres = Fingerprint::new("NonLinearSlots").samples(self.centres);
        let scales = self
            .scales
            .iter()
            .fold(centres.number(self.scales.len() as u32), |description, scale| {
                description.bytes(bytemuck::bytes_of(scale))
            });
        let reaches = self
            .reaches
            .iter()
            .fold(scales.number(self.reaches.len() as u32), |description, &reach| {
                description.number(reach)
            });
        reaches.number(self.radii.len() as u32)
    }

    /// Sets the slot, counted from 1, of each neuron that reaches the floor; the others stay 0.
    #[inline]
    pub(super) fn respond(&self, sample: S, slots: &mut [u16]) {
        let neurons = self.centres.iter().zip(self.scales).zip(self.reaches);
        for (slot, ((&centre, &scale), &reach)) in slots.iter_mut().zip(neurons) {
            let distance = sample.distance(centre);
            if distance <= reach {
                *slot = self.slot(S::in_widths(distance, scale));
            }
        }
    }

    /// The slot, counted from 1, at a distance with a level of at least 1.
    #[inline]
    fn slot(&self, distance: S::Widths) -> u16 {
        let most = self.radii.len().wrapping_sub(1);
        let slot = count_preceding(most, |slot| {
            self.radii.get(slot).is_some_and(|&radius| distance > radius)
        });
        slot.wrapping_add(1) as u16
    }

    /// The mean of the centres, weighted by their levels, or `None` if no neuron fired in a slot of these fields.
    #[inline]
    pub(super) fn mean(&self, slots: &[u16]) -> Option<S> {
        let lowest = *self.centres.first()?;
        let beyond = self.radii.len().wrapping_add(1) as u16;
        let (mut sum, mut total) = (S::Centroid::default(), 0_u32);
        for (&centre, &slot) in self.centres.iter().zip(slots) {
            if slot > 0 && slot < beyond {
                let level = u32::from(beyond.wrapping_sub(slot));
                sum = S::add_centre(sum, centre, lowest, level);
                total = total.wrapping_add(level);
            }
        }
        (total > 0).then(|| S::mean_of(sum, lowest, total))
    }
}

impl<S: Sample, const M: usize, const N: usize> Start for NonLinearSlots<S, M, N> {
    const START: SlotsState = SlotsState::START;
}

impl<S: Sample, const M: usize, const N: usize> Scheme for NonLinearSlots<S, M, N> {
    type Sample = S;
    type Code = NeuronSlots<M, N>;
    type Output = NeuronSlots<M, N>;
    type EncoderState = SlotsState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        self.fields().fingerprint()
    }

    encode_in_place!(SlotsState, NeuronSlots<M, N>);

    fn decode(&self, state: &mut Held<S>, spikes: NeuronSlots<M, N>) -> S {
        state.or_hold(self.fields().mean(&spikes.slots))
    }

    centred!(SlotsState);
}
