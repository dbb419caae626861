//! Time to first spike: the larger the value, the earlier its spike.

use core::ops::RangeInclusive;

use super::{Slot, TimingState};
use crate::error::{not_rising, range as check_range, tri, unwrap, within};
use crate::num::curve::power;
use crate::num::{DoubleDouble, to_f64};
use crate::scheme::cells::{Cuts, Partition, Side};
use crate::scheme::code::Destination;
use crate::scheme::held::{Held, hold_value};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme, Start};

/// Time to first spike: one spike a sample, in the slot of the value's cell; the highest cell has the first slot.
///
/// - **Cells:** [even points](Self::linear), [logarithmic](Self::logarithmic), or above the
///   [user's edges](Self::new). Below all edges there is no spike.
/// - **N:** 2 to 256 slots a sample, each as long as the caller makes it.
/// - **Latency:** 0 samples. **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes `10 N + 24` bytes
///   of flash in `f32`.
/// - **Work:** one multiplication and two comparisons; where cells are not even, `log2 N` comparisons, and in slices
///   also where there is silence. No exponential, logarithm or division.
/// - **Exactness:** every sample type compares with exact edges, of which `f32` takes the linear ones as computed in
///   double precision.
/// - **Decoder:** the middle of the cell. No spike decodes to the middle of the values below all edges; where
///   there are none, the value before holds. A sample that is not finite has no spike, either.
/// - **Error:** half a cell within the range: `R/(2(N-1))` if linear, with `R = max - min`;
///   `(x - min)(D^(1/N) - 1)/2` if logarithmic, above the lowest edge; in fixed point up to 1 unit of the last place
///   more.
///
/// Source: Thorpe 1990; the linear slots are those of `SpikingJelly` and of snnTorch, the logarithmic ones those of a
/// threshold that decays (Guo et al., *Neural coding in spiking neural networks*, 2021).
///
/// ```
/// use spikewire::{Scheme, timing::FirstSpike};
///
/// const LIGHT: FirstSpike<i16, 8> = FirstSpike::logarithmic(0..=25_500, 256.0);
///
/// let spike = LIGHT.encoder().encode(20_000);
/// assert_eq!(spike.map(|slot| slot.index()), Some(0)); // above half the range
/// assert_eq!(LIGHT.decoder().decode(spike), 19_125);
/// ```
///
/// A single slot does not compile:
///
/// ```compile_fail
/// # use spikewire::timing::FirstSpike;
/// const NONE: FirstSpike<f32, 1> = FirstSpike::linear(-1.0..=1.0);
/// # let _ = NONE;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct FirstSpike<S: Sample, const N: usize> {
    cells: Partition<S, N>,
    silence: Option<Silence<S>>,
    slots: u16,
}

/// The values that have no spike.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
struct Silence<S> {
    /// The largest of them.
    last: S,
    /// What they decode to.
    value: S,
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const N: usize> FirstSpike<S, N> {
    const SHAPE: () = assert!(N >= 2 && N <= 256, "a sample has 2 to 256 slots");

    /// The user's edges of cells, strictly rising, within a range: the slot is the number of edges that the value does
    /// not exceed. For constants, where bad edges fail the build.
    ///
    /// Those of a leaky integrate-and-fire neuron of threshold `θ` at a constant input are `θ/(1 - e^(-(t+1)/τ))`, `t`
    /// from `N-1` down to 0.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, edges: [S; N]) -> Self {
        unwrap(Self::of_own(&range, &edges))
    }

    /// The user's edges of cells, strictly rising, within a range: the slot is the number of edges that the value does
    /// not exceed.
    ///
    /// # Errors
    /// Returns an error if the ends or an edge are not finite or do not rise; or no sample lies between two of them.
    pub const fn try_new(range: RangeInclusive<S>, edges: [S; N]) -> Result<Self, ConfigError> {
        Self::of_own(&range, &edges)
    }

    /// Even points: slot `t` stands for `max - tR/(N-1)`, and each value fires in the slot of the nearest point,
    /// halfway between two in the later. For constants, where a bad range fails the build.
    ///
    /// # Panics
    /// Panics if [`try_linear`](Self::try_linear) returns an error.
    pub const fn linear(range: RangeInclusive<S>) -> Self {
        unwrap(Self::of_points(&range, N))
    }

    /// Even points: slot `t` stands for `max - tR/(N-1)`, and each value fires in the slot of the nearest point,
    /// halfway between two in the later.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite or do not rise; or the sample type is too coarse for so many
    /// slots.
    pub const fn try_linear(range: RangeInclusive<S>) -> Result<Self, ConfigError> {
        Self::of_points(&range, N)
    }

    /// Logarithmic thresholds `min + R D^(c/N - 1)`, `c` from 0 to `N-1`: each slot spans the same ratio. Values up
    /// to the lowest threshold have no spike. For constants, where bad parameters fail the build.
    ///
    /// `D` is the dynamic range, from the maximum to the lowest threshold. A threshold `θ e^(-t/τ)` that decays over
    /// `N` slots has `D = e^(N/τ)`.
    ///
    /// # Panics
    /// Panics if [`try_logarithmic`](Self::try_logarithmic) returns an error.
    pub const fn logarithmic(range: RangeInclusive<S>, dynamic_range: f32) -> Self {
        unwrap(Self::of_logarithms(&range, dynamic_range, N))
    }

    /// Logarithmic thresholds `min + R D^(c/N - 1)`, `c` from 0 to `N-1`: each slot spans the same ratio. Values up
    /// to the lowest threshold have no spike.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite or do not rise; the dynamic range is not above 1 and finite; or
    /// the sample type is too coarse for so many slots.
    pub const fn try_logarithmic(
        range: RangeInclusive<S>,
        dynamic_range: f32,
    ) -> Result<Self, ConfigError> {
        Self::of_logarithms(&range, dynamic_range, N)
    }

    pub(super) const fn of_points(
        range: &RangeInclusive<S>,
        slots: usize,
    ) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let cells = tri!(tri!(Cuts::points(range, slots)).partition());
        Ok(Self { cells, silence: None, slots: slots as u16 })
    }

    pub(super) const fn of_logarithms(
        range: &RangeInclusive<S>,
        dynamic_range: f32,
        slots: usize,
    ) -> Result<Self, ConfigError> {
        let least = 1.0_f32.next_up();
        let (min, max) = (to_f64(*range.start()), to_f64(*range.end()));
        tri!(check_range(min, max));
        tri!(within("dynamic range", dynamic_range as f64, least, f32::MAX));
        let mut edges = [0.0; N];
        let mut c = 0;
        while c < slots && c < N {
            let fall = power(DoubleDouble::new(dynamic_range as f64), slots.wrapping_sub(c), slots);
            let above = DoubleDouble::sum(max, -min).over(fall);
            edges[c] = DoubleDouble::new(min).plus(above).rounded();
            c += 1;
        }
        Self::of_edges(range, &edges, slots)
    }

    /// A scheme of the user's edges, the first `N`.
    pub(super) const fn of_own(range: &RangeInclusive<S>, own: &[S]) -> Result<Self, ConfigError> {
        let mut edges = [0.0; N];
        let mut i = 0;
        while i < own.len() && i < N {
            edges[i] = to_f64(own[i]);
            tri!(crate::error::finite("edge", edges[i]));
            if i > 0 && edges[i] <= edges[i - 1] {
                return Err(not_rising("edges", i, edges[i], edges[i - 1]));
            }
            i += 1;
        }
        Self::of_edges(range, &edges, i)
    }

    /// Cells above the first edge, and silence below.
    const fn of_edges(
        range: &RangeInclusive<S>,
        edges: &[f64; N],
        slots: usize,
    ) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        let mut cuts = tri!(Cuts::<S, N>::new(range, slots));
        let below = cuts.set(0, edges[0], Side::Low);
        let silence = Silence { last: below.last(0), value: below.middle(0) };
        if to_f64(silence.last) < to_f64(*range.start()) {
            return Err(ConfigError::EmptyCell { cell: 0, cells: slots.saturating_add(1) });
        }
        cuts = cuts.starting_above(edges[0]);
        let mut c = 1;
        while c < slots && c < N {
            cuts = cuts.set(c - 1, edges[c], Side::Low);
            c += 1;
        }
        match cuts.partition() {
            Ok(cells) => Ok(Self { cells, silence: Some(silence), slots: slots as u16 }),
            Err(ConfigError::EmptyCell { cell, cells }) => {
                let (cell, cells) = (cell.saturating_add(1), cells.saturating_add(1));
                Err(ConfigError::EmptyCell { cell, cells })
            }
            Err(error) => Err(error),
        }
    }

    /// What each slot decodes to, the last slot first.
    pub const fn values(&self) -> &[S; N] {
        self.cells.as_array()
    }

    /// Whether a finite sample has no spike.
    #[inline]
    fn is_silent(&self, sample: S) -> bool {
        self.silence.is_some_and(|silence| sample <= silence.last)
    }

    /// The slot of the cell with this number.
    #[inline]
    fn slot(&self, number: usize) -> Option<Slot<N>> {
        Slot::counted(self.slots.wrapping_add(1).wrapping_sub(number as u16))
    }

    #[inline]
    fn value(&self, slot: Option<Slot<N>>) -> Option<S> {
        match slot {
            Some(slot) => {
                let cell = usize::from(self.slots)
                    .checked_sub(usize::from(slot.index()).saturating_add(1))?;
                self.cells.get(cell)
            }
            None => self.silence.map(|silence| silence.value),
        }
    }
}

impl<S: Sample, const N: usize> Start for FirstSpike<S, N> {
    const START: TimingState = TimingState::START;
}

impl<S: Sample, const N: usize> Scheme for FirstSpike<S, N> {
    type Sample = S;
    type Code = Option<Slot<N>>;
    type Output = Option<Slot<N>>;
    type EncoderState = TimingState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    /// That of even points. Where silence has a value, [`recovery`](Self::recovery) is after one sample.
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        let cells = self.cells.named("FirstSpike", self.slots.into());
        match self.silence {
            Some(Silence { last, value }) => cells.number(1).sample(last).sample(value),
            None => cells.number(0),
        }
    }

    #[inline]
    fn encode(&self, state: &mut TimingState, sample: S) -> Option<Slot<N>> {
        let sample = state.accept(sample).filter(|&sample| !self.is_silent(sample))?;
        self.slot(self.cells.number(sample))
    }

    /// Even cells without silence by their bins, all others by search: one loop of either, and no more code.
    fn encode_slice(
        &self,
        state: &mut TimingState,
        samples: &[S],
        outputs: &mut [impl Destination<Option<Slot<N>>>],
    ) -> usize {
        let count = samples.len().min(outputs.len());
        if self.silence.is_none() && self.cells.has_bins() {
            // Encodes as if all were finite; if one was not, the slice is encoded again.
            let mut check = S::ZERO;
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                check = check.including(sample);
                output.write(self.slot(self.cells.by_bin(sample)));
            }
            if check.is_finite() {
                return count;
            }
        }
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            let sample = state.accept(sample).filter(|&sample| !self.is_silent(sample));
            output.write(sample.and_then(|sample| self.slot(self.cells.by_search(sample))));
        }
        count
    }

    /// The value of a sample without a spike; if there is none, the middle of the middle cell.
    fn decoder_state(&self) -> Held<S> {
        let middle = || self.cells.get(usize::from(self.slots / 2));
        Held::at(self.value(None).or_else(middle).unwrap_or(S::ZERO))
    }

    #[inline]
    fn decode(&self, state: &mut Held<S>, slot: Option<Slot<N>>) -> S {
        state.or_hold(self.value(slot))
    }

    hold_value!(TimingState);

    fn recovery(&self) -> Recovery {
        if self.silence.is_some() { Recovery::Samples(1) } else { Recovery::Spike }
    }

    fn slots(&self) -> usize {
        self.slots.into()
    }
}
