//! The timing codes: in which slots a sample spikes, and the value that these give back.
//!
//! A code is its spikes, `(neuron, slot)`, by rising neuron and slot. Values outside the range are those at its ends.

use core::ops::RangeInclusive;

use super::line::{Exact, Line, edge, even, points};
use super::{Precise, clamped};

/// The spikes of a sample.
pub type Spikes = Vec<(u16, u16)>;

/// The cell of a value, the edges around it, and the slot of its spike, if it has one.
pub struct Cell<T, F> {
    range: RangeInclusive<T>,
    number: F,
    own: usize,
    ends: [f64; 2],
    slot: Option<u16>,
}

impl<T: Line, F: Fn(T) -> usize> Cell<T, F> {
    /// The spikes.
    pub fn spikes(&self) -> Spikes {
        self.slot.map(|slot| (0, slot)).into_iter().collect()
    }

    /// The middle.
    pub fn value(&self) -> T {
        T::middle(self.range.clone(), &self.number, self.own..=self.own, self.ends)
    }
}

/// Time to first spike, linear: slot `n - 1 - cell` of the cells around `n` points.
pub fn first_spike_linear<T: Line>(x: T, min: T, max: T, n: u32) -> Cell<T, impl Fn(T) -> usize> {
    let number = move |x| points(x, min, max, n);
    let cell = number(clamped(x, min, max)) as u32;
    let low = if cell == 0 { 0 } else { 2 * cell - 1 };
    let high = if cell == n - 1 { 2 * (n - 1) } else { 2 * cell + 1 };
    let ends = [low, high].map(|part| edge(min, max, part, 2 * (n - 1)));
    let slot = Some((n - 1 - cell) as u16);
    Cell { range: min..=max, number, own: cell as usize, ends, slot }
}

/// The thresholds of the logarithmic time to first spike, exactly: `min + R D^(c/n - 1)`.
pub fn log_thresholds<T: Line>(min: T, max: T, n: u32, dynamic_range: f32) -> Vec<f64> {
    let (Exact(low), Exact(high)) = (min.into(), max.into());
    let width = Precise::from(high) - low;
    let fall = |c: u32| Precise::from(dynamic_range).pow(&(Precise::from(n - c) / n));
    (0..n).map(|c| (width.clone() / fall(c) + low).to_f64()).collect()
}

/// Time to first spike above thresholds: slot `n - cell`, and cell 0 is silent.
pub fn first_spike_above<T: Line>(
    x: T,
    min: T,
    max: T,
    thresholds: &[f64],
) -> Cell<T, impl Fn(T) -> usize> {
    let n = thresholds.len();
    let number = |x: T| thresholds.iter().filter(|&&edge| x.beside_real(edge).is_gt()).count();
    let cell = number(clamped(x, min, max));
    let (Exact(low), Exact(high)) = (min.into(), max.into());
    let below = if cell == 0 { low } else { thresholds[cell - 1] };
    let above = thresholds.get(cell).copied().unwrap_or(high);
    let slot = (cell > 0).then_some((n - cell) as u16);
    Cell { range: min..=max, number, own: cell, ends: [below, above], slot }
}

/// Latency-phase: `width` latencies, and neurons whose peaks lie at `phase + i spacing` modulo the period.
#[derive(Clone, Copy, Debug)]
pub struct Oscillation {
    /// How many neurons carry the value.
    pub neurons: u16,
    /// How many latencies there are.
    pub width: u16,
    /// The period in slots.
    pub period: u16,
    /// From one neuron's peak to the next one's.
    pub spacing: u16,
    /// The first neuron's peak.
    pub phase: u16,
}

/// The slots: the first peaks from the latency on.
pub fn latency_phase<T: Line>(x: T, min: T, max: T, of: Oscillation) -> Spikes {
    let latency = of.width - 1 - even(clamped(x, min, max), min, max, of.width.into()) as u16;
    let peak = |neuron| of.phase + neuron * of.spacing;
    let slot = |neuron| {
        let from = latency..latency + of.period;
        from.into_iter()
            .find(|slot| slot % of.period == peak(neuron) % of.period)
            .unwrap_or(u16::MAX)
    };
    (0..of.neurons).map(|neuron| (neuron, slot(neuron))).collect()
}

/// The middle of the cells whose latencies explain every spike, if there are any: in `f32` of their ends as rounded
/// to it.
pub fn latency_phase_decode<T: Line>(
    spikes: &[(u16, u16)],
    min: T,
    max: T,
    of: Oscillation,
    rounded: impl Fn(f64) -> f64,
) -> Option<T> {
    let explains = |latency: &u16| {
        spikes.iter().all(|&(_, slot)| (*latency..latency + of.period).contains(&slot))
    };
    let latencies: Vec<u16> = (0..of.width).filter(explains).collect();
    let (&least, &most) = (latencies.first()?, latencies.last()?);
    let (low, high) = (u32::from(of.width - 1 - most), u32::from(of.width - 1 - least));
    let width = u32::from(of.width);
    let ends = [low, high + 1].map(|part| rounded(edge(min, max, part, width)));
    let number = |x| even(x, min, max, width);
    let is_silent = spikes.is_empty();
    (!is_silent).then(|| T::middle(min..=max, number, low as usize..=high as usize, ends))
}

/// Weighted phase: the digits of the even cell, the highest first.
pub fn weighted_phase(cell: u32, digits: u32) -> Spikes {
    let is_one = |slot: &u32| cell >> (digits - 1 - slot) & 1 == 1;
    (0..digits).filter(is_one).map(|slot| (0, slot as u16)).collect()
}

/// A burst code.
#[derive(Clone, Debug)]
pub struct Bursts {
    /// The most spikes of a sample.
    pub spikes: u32,
    /// Intervals in slots.
    pub intervals: RangeInclusive<u32>,
}

impl Bursts {
    /// How many spikes a value has, and their interval; 0 below two spikes.
    pub fn burst<T: Line>(&self, x: T, min: T, max: T) -> (u32, u32) {
        let x = clamped(x, min, max);
        let exceeds = |k: &u32| x.beside(min, max, *k, self.spikes).is_gt();
        let count = (0..self.spikes).filter(exceeds).count() as u32;
        let steps = self.intervals.end() - self.intervals.start();
        let passed = (1..=steps).filter(|&j| x.beside(min, max, j, steps).is_ge()).count() as u32;
        (count, if count > 1 { self.intervals.end() - passed } else { 0 })
    }

    /// The slots `0, T, 2T, ...`
    pub fn spikes((count, interval): (u32, u32)) -> Spikes {
        (0..count).map(|spike| (0, (spike * interval) as u16)).collect()
    }

    /// The middle of the values that have the burst of this one.
    pub fn middle<T: Line>(&self, x: T, min: T, max: T) -> T {
        let (count, interval) = self.burst(x, min, max);
        // Also where it is -0.
        if count == 0 {
            return min;
        }
        let steps = self.intervals.end() - self.intervals.start();
        let by_count = |count: u32| edge(min, max, count, self.spikes);
        let (mut low, mut high) = (by_count(count - 1), by_count(count));
        if count > 1 && steps > 0 {
            let passed = self.intervals.end() - interval;
            low = low.max(edge(min, max, passed, steps));
            if passed < steps {
                high = high.min(edge(min, max, passed + 1, steps));
            }
        }
        // More spikes, or a shorter interval: by rising value.
        let rank = |x| {
            let (count, interval) = self.burst(x, min, max);
            (count * 256 + 255 - interval) as usize
        };
        let own = rank(x);
        T::middle(min..=max, rank, own..=own, [low, high])
    }
}
