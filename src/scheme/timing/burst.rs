//! Burst coding: the larger the value, the more spikes, and the closer together.

use core::ops::RangeInclusive;

use super::{BurstSpikes, TimingState};
use crate::error::{tri, unwrap, within};
use crate::num::to_f64;
use crate::scheme::cells::{Cuts, Partition, Side, count_preceding};
use crate::scheme::held::{Held, hold_value};
use crate::{ConfigError, Fingerprint, Recovery, Sample, Scheme, Start};

/// Burst coding: every sample is a burst, whose spike count and interval give the value.
///
/// With `p = x - min` and `R = max - min`, a burst has `⌈pS/R⌉` spikes, up to `S`, in the slots `0, T, 2T, …`, where
/// `T = longest - ⌊(longest - shortest) p/R⌋`.
///
/// - **N:** 2 to 256 slots a sample, enough for all bursts. **S:** 1 to `N`, at most 255. **Intervals:** 1 slot or
///   more.
/// - **Latency:** 0 samples. **Memory:** 4 bytes a channel, 4 to decode in `f32`; the scheme takes `13 N + 16` bytes
///   of flash in `f32`.
/// - **Work:** one multiplication and two comparisons; three table look-ups to decode, or where the sample
///   type is coarse also `log2 N` comparisons.
/// - **Exactness:** fixed point compares with exact edges; `f32` with edges computed in double precision and rounded
///   once.
/// - **Decoder:** the middle of the values with this count and interval. No spike is the minimum; a burst that no
///   value has changes nothing.
/// - **Error:** half a cell, so at most `R/2S` within the range; in fixed point up to 1 unit of the last place more.
/// - **Silence** is a value: the minimum. A sample that is not finite has no spike, either.
///
/// Source: Guo et al., *Neural coding in spiking neural networks*, 2021.
///
/// ```
/// use spikewire::{Code, Scheme, timing::Burst};
///
/// const LIGHT: Burst<i16, 19> = Burst::new(0..=255, 5, 2..=10);
///
/// let burst = LIGHT.encoder().encode(100);
/// assert_eq!((burst.count(), burst.interval()), (2, 7));
/// assert_eq!(LIGHT.decoder().decode(burst), 99);
/// ```
///
/// Too few slots do not compile:
///
/// ```compile_fail
/// # use spikewire::timing::Burst;
/// const SHORT: Burst<i16, 16> = Burst::new(0..=255, 5, 2..=10);
/// # let _ = SHORT;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(bound = "S: serde::Serialize"))]
pub struct Burst<S: Sample, const N: usize> {
    /// The cells above the minimum.
    cells: Partition<S, N>,
    /// Count and interval of each cell.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::serial::array::serialize"))]
    bursts: [[u8; 2]; N],
    /// The first cell of each count, from 1.
    #[cfg_attr(feature = "serde", serde(skip))]
    firsts: [u8; N],
    /// How many cells there are.
    count: u16,
    min: S,
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const N: usize> Burst<S, N> {
    const SHAPE: () = assert!(N >= 2 && N <= 256, "a sample has 2 to 256 slots");

    /// Bursts of up to `spikes` spikes, at intervals in slots from the shortest to the longest. For constants, where
    /// bad parameters fail the build.
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(range: RangeInclusive<S>, spikes: u8, intervals: RangeInclusive<u8>) -> Self {
        unwrap(Self::of(&range, spikes, [*intervals.start(), *intervals.end()], N))
    }

    /// Bursts of up to `spikes` spikes, at intervals in slots from the shortest to the longest.
    ///
    /// # Errors
    /// Returns an error if the ends are not finite or do not rise; the number of spikes or an interval is 0, or the
    /// shortest interval exceeds the longest; a burst takes more than `N` slots; or the sample type is too coarse for
    /// so many spikes.
    pub const fn try_new(
        range: RangeInclusive<S>,
        spikes: u8,
        intervals: RangeInclusive<u8>,
    ) -> Result<Self, ConfigError> {
        Self::of(&range, spikes, [*intervals.start(), *intervals.end()], N)
    }

    /// A scheme of this many slots, at most `N`.
    pub(super) const fn of(
        range: &RangeInclusive<S>,
        spikes: u8,
        [shortest, longest]: [u8; 2],
        slots: usize,
    ) -> Result<Self, ConfigError> {
        const { Self::SHAPE };
        tri!(within("spikes", spikes as f64, 1.0, 255.0));
        tri!(within("shortest interval", shortest as f64, 1.0, longest as f32));
        let min = *range.start();
        let whole = tri!(Cuts::<S, N>::new(range, N));
        let (counts, steps) = (spikes as usize, longest.saturating_sub(shortest) as usize);
        let mut cuts = whole.starting_above(to_f64(min));
        let (mut bursts, mut firsts) = ([[1, 0]; N], [0; N]);
        // The largest sample below the cell, and how many edges of counts and of intervals lie there.
        let (mut below, mut passed, mut shorter) = (to_f64(min), 1, steps / max(counts, 1));
        let (mut cell, mut most) = (0, 1);
        loop {
            let by_count = whole.set(0, whole.at(passed, counts), Side::Low);
            let by_interval =
                whole.set(0, whole.at(shorter.saturating_add(1), max(steps, 1)), Side::Up);
            let (at_count, at_interval) = (to_f64(by_count.last(0)), to_f64(by_interval.last(0)));
            let (has_count, has_interval) = (passed < counts, shorter < steps);
            if has_count && at_count <= below {
                passed = passed.saturating_add(1);
                continue;
            }
            if has_interval && at_interval <= below {
                shorter = shorter.saturating_add(1);
                continue;
            }
            let interval = longest.saturating_sub(shorter as u8);
            if cell < N {
                let is_first = cell == 0 || bursts[cell - 1][0] as usize != passed;
                let place = passed.wrapping_sub(1);
                if is_first && place < N {
                    firsts[place] = cell as u8;
                }
                bursts[cell] = if passed > 1 { [passed as u8, interval] } else { [1, 0] };
            }
            let last = passed.saturating_sub(1).saturating_mul(interval as usize);
            most = max(most, last.saturating_add(1));
            if has_count && !(has_interval && at_interval < at_count) {
                cuts = cuts.set(cell, whole.at(passed, counts), Side::Low);
                below = at_count;
            } else if has_interval {
                cuts = cuts.set(cell, whole.at(shorter.saturating_add(1), steps), Side::Up);
                below = at_interval;
            } else {
                break;
            }
            cell = cell.saturating_add(1);
        }
        // Bursts that fit have no more cells than slots.
        let most = if cell < N { most } else { max(most, N + 1) };
        tri!(within("slots of the longest burst", most as f64, 1.0, 256.0));
        tri!(within("slots", slots as f64, most as f32, 256.0));
        let cells = tri!(cuts.counted(cell.saturating_add(1)).partition());
        Ok(Self { cells, bursts, firsts, count: (cell as u16).saturating_add(1), min })
    }

    /// The bursts that values have, the lowest first, and what each decodes to.
    pub fn bursts(&self) -> impl Iterator<Item = (BurstSpikes<N>, S)> {
        let spiking = self.bursts.iter().zip(self.cells.as_array()).take(self.count.into());
        let spiking = spiking.map(|(&burst, &value)| (BurstSpikes::of(burst), value));
        core::iter::once((BurstSpikes::SILENT, self.min)).chain(spiking)
    }

    #[inline]
    fn burst(&self, sample: S) -> BurstSpikes<N> {
        if sample <= self.min {
            return BurstSpikes::SILENT;
        }
        let cell = self.cells.number(sample).wrapping_sub(1);
        self.bursts.get(cell).map_or(BurstSpikes::SILENT, |&burst| BurstSpikes::of(burst))
    }

    #[inline]
    fn value(&self, burst: BurstSpikes<N>) -> Option<S> {
        if burst.count() == 0 {
            return Some(self.min);
        }
        // From cell to cell of a count the interval falls by 1, unless cells are coarse.
        let first = usize::from(*self.firsts.get(usize::from(burst.count()).wrapping_sub(1))?);
        let longest = self.known(first)?.interval();
        let cell = first.wrapping_add(longest.wrapping_sub(burst.interval()).into());
        if self.known(cell) == Some(burst) { self.cells.get(cell) } else { self.searched(burst) }
    }

    /// The burst of a cell, if there is such a cell.
    #[inline]
    fn known(&self, cell: usize) -> Option<BurstSpikes<N>> {
        let known = self.bursts.get(cell).filter(|_| cell < usize::from(self.count));
        known.map(|&burst| BurstSpikes::of(burst))
    }

    /// The value of a burst by binary search, where cells are coarse.
    #[cold]
    #[inline(never)]
    fn searched(&self, burst: BurstSpikes<N>) -> Option<S> {
        let cell = count_preceding(self.count.into(), |cell| {
            self.known(cell).is_some_and(|known| known.rank() < burst.rank())
        });
        self.known(cell).filter(|&known| known == burst).and_then(|_| self.cells.get(cell))
    }
}

const fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

impl<S: Sample, const N: usize> Start for Burst<S, N> {
    const START: TimingState = TimingState::START;
}

impl<S: Sample, const N: usize> Scheme for Burst<S, N> {
    type Sample = S;
    type Code = BurstSpikes<N>;
    type Output = BurstSpikes<N>;
    type EncoderState = TimingState;
    type DecoderState = Held<S>;

    const LATENCY: usize = 0;
    /// Every code gives a value by itself, also one without a spike.
    const RECOVERY: Recovery = Recovery::Samples(1);

    fn fingerprint(&self) -> Fingerprint {
        let cells = self.cells.named("Burst", self.count.into()).sample(self.min);
        let bursts = self.bursts.iter().take(self.count.into()).flatten();
        bursts.fold(cells, |description, &number| description.number(number.into()))
    }

    #[inline]
    fn encode(&self, state: &mut TimingState, sample: S) -> BurstSpikes<N> {
        state.accept(sample).map_or(BurstSpikes::SILENT, |sample| self.burst(sample))
    }

    /// The minimum.
    fn decoder_state(&self) -> Held<S> {
        Held::at(self.min)
    }

    #[inline]
    fn decode(&self, state: &mut Held<S>, burst: BurstSpikes<N>) -> S {
        state.or_hold(self.value(burst))
    }

    hold_value!(TimingState);

    /// The slots of the longest burst.
    fn slots(&self) -> usize {
        let last = |burst: BurstSpikes<N>| {
            u16::from(burst.count()).saturating_sub(1).wrapping_mul(burst.interval().into())
        };
        self.bursts().map(|(burst, _)| usize::from(last(burst)).wrapping_add(1)).max().unwrap_or(1)
    }
}
