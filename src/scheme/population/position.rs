//! Position coding: the neuron whose centre is nearest fires.

use core::ops::RangeInclusive;

use super::Held;
use super::Neuron;
use super::centres::Centres;
use super::methods::centred;
use crate::error::{tri, unwrap};
use crate::num::Tally;
use crate::scheme::codec::decode_copied;
use crate::{ConfigError, Destination, Fingerprint, Recovery, Sample, Scheme, Start};

/// Position coding: every sample fires the one neuron whose centre is nearest.
///
/// - **Centres:** `M`, 3 to 1024: [linear](Self::linear), [Gaussian-spaced](Self::gaussian_spaced) or the
///   [user's own](Self::new). A value halfway between two fires the lower; a value outside the range fires the
///   neuron at that end. With receptive fields of [unequal width](Self::with_widths) it is the strongest response
///   that fires, not the nearest centre.
/// - **Latency:** 0 samples. **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes
///   `10 M + 8` bytes of flash in `f32`.
/// - **Work:** one multiplication finds the bin of a value, one of `2 M` even bins; a table gives the lowest neuron of
///   that bin, and one comparison with an edge decides between it and the next. A binary search takes their place where
///   two edges share a bin, as with Gaussian-spaced centres from about 140 on or the user's own, with more than 256
///   neurons, and for `f32` without a float unit.
/// - **Exactness:** the nearest centre exactly, in every sample type. Linear centres are compared unrounded, and
///   the decoder returns them [rounded](Self::centres) to the sample type. Other centres are compared as rounded.
/// - **Error:** at most half the distance between two centres, inside the centres' range.
///
/// Source: paper, section II-A, algorithm 1.
///
/// ```
/// use spikewire::{Scheme, population::Position};
///
/// const ERROR: Position<f32, 5> = Position::new([-2.0, -0.5, 0.0, 0.5, 2.0]);
///
/// let neuron = ERROR.encoder().encode(0.2);
/// assert_eq!(neuron.map(|n| n.index()), Some(2));
/// assert_eq!(ERROR.decoder().decode(neuron), 0.0);
/// ```
///
/// Fewer than three neurons do not compile:
///
/// ```compile_fail
/// # use spikewire::population::Position;
/// const NONE: Position<f32, 2> = Position::linear(-1.0..=1.0);
/// # let _ = &NONE;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct Position<S: Sample, const M: usize> {
    centres: Centres<S, M>,
}

impl<S: Sample, const M: usize> Position<S, M> {
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
    /// Returns an error if a centre is not finite, or does not exceed the one before.
    pub const fn try_new(centres: [S; M]) -> Result<Self, ConfigError> {
        Self::of(Centres::try_new(centres))
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type. For constants,
    /// where a bad range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_linear`](Self::try_linear) returns an error.
    pub const fn linear(range: RangeInclusive<S>) -> Self {
        unwrap(Self::of(Centres::try_linear(&range)))
    }

    /// Even centres over a range, half a spacing beyond it at either end:
    /// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`, rounded to the sample type.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise, or the sample type is too coarse to tell the
    /// centres apart.
    pub const fn try_linear(range: RangeInclusive<S>) -> Result<Self, ConfigError> {
        Self::of(Centres::try_linear(&range))
    }

    /// Centres over a range spaced as the quantiles of a normal distribution: dense around the middle, for
    /// an error around its set point. For constants, where a bad range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_gaussian_spaced`](Self::try_gaussian_spaced) returns an error.
    pub const fn gaussian_spaced(range: RangeInclusive<S>) -> Self {
        unwrap(Self::of(Centres::try_gaussian_spaced(&range)))
    }

    /// Centres over a range spaced as the quantiles of a normal distribution: dense around the middle, for
    /// an error around its set point.
    ///
    /// # Errors
    /// Returns an error if [`try_linear`](Self::try_linear) does.
    pub const fn try_gaussian_spaced(range: RangeInclusive<S>) -> Result<Self, ConfigError> {
        Self::of(Centres::try_gaussian_spaced(&range))
    }

    const fn of(centres: Result<Centres<S, M>, ConfigError>) -> Result<Self, ConfigError> {
        Ok(Self { centres: tri!(centres) })
    }

    pub(super) const fn of_edges(centres: [S; M], edges: [S; M]) -> Self {
        Self { centres: Centres::new(centres, edges, M) }
    }

    /// The centres, lowest first, rounded to the sample type.
    pub const fn centres(&self) -> &[S; M] {
        self.centres.as_array()
    }

    /// Encodes a slice by binary search. Out of line, so that the usual path stays small.
    #[cold]
    #[inline(never)]
    fn search_each(
        &self,
        state: &mut PositionState,
        samples: &[S],
        outputs: &mut [impl Destination<Option<Neuron<M>>>],
    ) {
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            output.write(if sample.is_finite() {
                Neuron::counted(self.centres.by_search(sample) as u16)
            } else {
                state.tally.reject();
                None
            });
        }
    }

    #[inline]
    fn centre(&self, neuron: Option<Neuron<M>>) -> Option<S> {
        neuron.and_then(|neuron| self.centres.get(usize::from(neuron.index())))
    }
}

/// The state of a [`Position`] encoder: the count of rejected samples. 4 bytes.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PositionState {
    pub(super) tally: Tally,
}

impl PositionState {
    pub(super) const START: Self = Self { tally: Tally::NONE };
}

impl<S: Sample, const M: usize> Start for Position<S, M> {
    const START: PositionState = PositionState::START;
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
        self.centres.named("Position", M)
    }

    #[inline]
    fn encode(&self, state: &mut PositionState, sample: S) -> Option<Neuron<M>> {
        if !sample.is_finite() {
            state.tally.reject();
            return None;
        }
        Neuron::counted(self.centres.number(sample) as u16)
    }

    fn encode_slice(
        &self,
        state: &mut PositionState,
        samples: &[S],
        outputs: &mut [impl Destination<Option<Neuron<M>>>],
    ) -> usize {
        let centres = &self.centres;
        let mut check = S::ZERO;
        if centres.has_bins() {
            // Encodes as if all were finite; if one was not, the slice is encoded again.
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                check = check.including(sample);
                output.write(Neuron::counted(centres.by_bin(sample) as u16));
            }
        }
        if !centres.has_bins() || !check.is_finite() {
            self.search_each(state, samples, outputs);
        }
        samples.len().min(outputs.len())
    }

    /// The centre of the neuron; if none fired, the previous value.
    #[inline]
    fn decode(&self, state: &mut Held<S>, neuron: Option<Neuron<M>>) -> S {
        state.or_hold(self.centre(neuron))
    }

    fn decode_slice(
        &self,
        state: &mut Held<S>,
        neurons: &[impl Copy + Into<Option<Neuron<M>>>],
        values: &mut [S],
    ) -> usize {
        decode_copied(self, state, neurons, values)
    }

    centred!(PositionState);
}
