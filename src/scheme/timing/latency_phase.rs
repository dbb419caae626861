//! Latency-phase: a spike's latency gives the value, and its phase in an oscillation the neuron.

use core::ops::RangeInclusive;

use super::{PhaseSpikes, TimingState};
use crate::error::{tri, unwrap, within};
use crate::scheme::cells::{Cuts, Partition};
use crate::scheme::held::{Held, hold_value};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme, Start};

/// Latency-phase: neurons that fire only at the peaks of an oscillation, so that one line may carry them all.
///
/// The latency of a value is `L = W - 1 - cell`, of `W` even cells over the range. The oscillation of neuron `i` has
/// its peaks at the slots `phase + iD` modulo `P`; the neuron fires at the first peak from `L` on. On one line the
/// slot modulo `P` [gives the neuron](Self::neuron_at). All `M` neurons carry the same sample, one spike each. For a
/// channel each, make a scheme with one neuron and a [phase](Self::with_phase) for each channel.
///
/// - **W:** 2 to 256, and **P:** a power of 2, with `W + P - 1` slots a sample, at most 256. **M:** 1 or more.
///   **D:** the peaks' spacing in slots, with `M D` at most `P`.
/// - **Latency:** 0 samples. **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes `10 W + 24` bytes
///   of flash in `f32`.
/// - **Work:** one multiplication, one comparison, and four operations a neuron.
/// - **Exactness:** fixed point compares with exact edges; `f32` with edges computed in double precision and rounded
///   once.
/// - **Decoder:** each spike is possible for `P` latencies; the value is the middle of the cells that are possible for
///   all spikes. `f32` rounds the ends of these cells and their middle once each. Without spikes, or where no cell is
///   possible, the value before holds.
/// - **Error:** within the range `PR/2W` of one neuron, with `R = max - min`, and `DR/2W` of `P/D` neurons; in
///   fixed point up to 1 unit of the last place more.
///
/// Source: Nadasdy, *Information encoding and reconstruction from the phase of action potentials*, 2009; Hu et al.
/// 2013 take the nearest peak, which may lie before the latency.
///
/// ```
/// use spikewire::{Scheme, timing::LatencyPhase};
///
/// const LIGHT: LatencyPhase<i16, 4, 16, 4> = LatencyPhase::new(0..=255, 1);
///
/// let spikes = LIGHT.encoder().encode(100);
/// assert!(spikes.iter().eq([(0, 12), (1, 9), (2, 10), (3, 11)]));
/// assert_eq!(LIGHT.decoder().decode(spikes), 103);
/// assert_eq!(LIGHT.neuron_at(12), Some(0));
/// ```
///
/// A period that is no power of 2 does not compile:
///
/// ```compile_fail
/// # use spikewire::timing::LatencyPhase;
/// const ODD: LatencyPhase<i16, 1, 16, 3> = LatencyPhase::new(0..=255, 1);
/// # let _ = ODD;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct LatencyPhase<S: Sample, const M: usize, const W: usize, const P: usize> {
    /// Each stands for its smallest sample; in `f32` for its lower end.
    cells: Partition<S, W>,
    max: S,
    width: u16,
    period: u16,
    neurons: u16,
    spacing: u16,
    phase: u16,
}

impl<S: Sample, const M: usize, const W: usize, const P: usize> LatencyPhase<S, M, W, P> {
    const SHAPE: () = {
        assert!(P.is_power_of_two(), "a period is a power of 2");
        assert!(W >= 2 && W + P <= 257, "a sample has 2 latencies or more, and at most 256 slots");
        assert!(M >= 1 && M <= P, "a period has a slot for each of 1 neuron or more");
    };

    /// Neurons whose peaks are `spacing` slots apart. For constants, where bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, spacing: u16) -> Self {
        unwrap(Self::try_new(range, spacing))
    }

    /// Neurons whose peaks are `spacing` slots apart.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite or do not rise; the sample type is too coarse for so many cells;
    /// or the spacing is 0, or `M` times the spacing exceeds the period.
    pub const fn try_new(range: RangeInclusive<S>, spacing: u16) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        Self::of(&range, M, W, P, spacing)
    }

    /// A scheme of this many neurons, latencies and slots a period, at most `M`, `W` and `P`.
    pub(super) const fn of(
        range: &RangeInclusive<S>,
        neurons: usize,
        width: usize,
        period: usize,
        spacing: u16,
    ) -> Result<Self, ConfigError> {
        let most = (period / if neurons > 0 { neurons } else { 1 }) as f32;
        tri!(within("spacing", spacing as f64, 1.0, most));
        let cuts = tri!(Cuts::<S, W>::even(range, width));
        let cells = tri!(cuts.partition_of(cuts.firsts()));
        let (width, period, neurons) = (width as u16, period as u16, neurons as u16);
        Ok(Self { cells, max: *range.end(), width, period, neurons, spacing, phase: 0 })
    }

    /// Sets the phase, the slot below the period in which neuron 0 peaks; 0 by default. For constants, where a bad
    /// phase fails the build.
    ///
    /// # Panics
    /// Panics if the phase is not below the period.
    #[must_use]
    pub const fn with_phase(self, phase: u16) -> Self {
        unwrap(self.try_with_phase(phase))
    }

    /// Sets the phase, the slot below the period in which neuron 0 peaks; 0 by default.
    ///
    /// # Errors
    /// Returns an error if the phase is not below the period.
    pub const fn try_with_phase(self, phase: u16) -> Result<Self, ConfigError> {
        tri!(within("phase", phase as f64, 0.0, self.period.saturating_sub(1) as f32));
        Ok(Self { phase, ..self })
    }

    /// The neuron that peaks in a slot, if there is one: whose spike it is, where all share one line.
    pub fn neuron_at(&self, slot: u16) -> Option<u16> {
        let mask = self.period.wrapping_sub(1);
        let since = slot.wrapping_sub(self.phase) & mask;
        (0..self.neurons).find(|neuron| neuron.wrapping_mul(self.spacing) & mask == since)
    }

    /// The smallest sample of each cell, the lowest first; in `f32` the lower end.
    pub const fn starts(&self) -> &[S; W] {
        self.cells.as_array()
    }

    /// The slots in which the neurons fire for a finite sample.
    #[inline]
    fn slots(&self, sample: S) -> impl Iterator<Item = u16> {
        let mask = self.period.wrapping_sub(1);
        let latency = self.width.wrapping_sub(self.cells.number(sample) as u16);
        let (mut peak, spacing) = (self.phase, self.spacing);
        (0..self.neurons).map(move |_| {
            let wait = peak.wrapping_sub(latency) & mask;
            peak = peak.wrapping_add(spacing);
            latency.wrapping_add(wait)
        })
    }

    /// The middle of the cells that are possible for all spikes.
    #[inline]
    fn value(&self, spikes: &PhaseSpikes<M, W, P>) -> Option<S> {
        let (earliest, latest) = spikes.ends()?;
        let longest = self.width.wrapping_sub(1);
        let (least, most) = (latest.saturating_sub(self.period), earliest.min(longest));
        if least > most {
            return None;
        }
        let cell = |latency: u16| usize::from(longest.wrapping_sub(latency));
        let first = self.cells.get(cell(most))?;
        let above = if least > 0 { self.cells.get(cell(least).saturating_add(1)) } else { None };
        Some(first.middle(above.map_or(self.max, S::before)))
    }
}

impl<S: Sample, const M: usize, const W: usize, const P: usize> Start for LatencyPhase<S, M, W, P> {
    const START: TimingState = TimingState::START;
}

impl<S: Sample, const M: usize, const W: usize, const P: usize> Scheme
    for LatencyPhase<S, M, W, P>
{
    type Sample = S;
    type Code = PhaseSpikes<M, W, P>;
    type Output = PhaseSpikes<M, W, P>;
    type EncoderState = TimingState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    const RECOVERY: Recovery = Recovery::Spike;

    fn fingerprint(&self) -> Fingerprint {
        let lowest = self.cells.as_array().get(..self.width.into()).unwrap_or_default();
        let numbers = [self.width, self.period, self.neurons, self.spacing, self.phase];
        let cells = Fingerprint::new("LatencyPhase").samples(lowest).sample(self.max);
        numbers.iter().fold(cells, |description, &number| description.number(number.into()))
    }

    #[inline]
    fn encode(&self, state: &mut TimingState, sample: S) -> PhaseSpikes<M, W, P> {
        match state.accept(sample) {
            Some(sample) => PhaseSpikes::of(self.slots(sample)),
            None => PhaseSpikes::SILENT,
        }
    }

    /// The lower end of the middle cell.
    fn decoder_state(&self) -> Held<S> {
        Held::at(self.cells.get(usize::from(self.width / 2)).unwrap_or(S::ZERO))
    }

    #[inline]
    fn decode(&self, state: &mut Held<S>, spikes: PhaseSpikes<M, W, P>) -> S {
        state.or_hold(self.value(&spikes))
    }

    hold_value!(TimingState);

    fn neurons(&self) -> usize {
        self.neurons.into()
    }

    fn slots(&self) -> usize {
        usize::from(self.width).wrapping_add(self.period.into()).saturating_sub(1)
    }
}
