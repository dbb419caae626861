//! Extremes and sums of `f32` samples, several at a time.

// What is not inlined is compiled for a processor without wide vectors.
#![allow(clippy::inline_always)]

use pulp::{Arch, Simd, WithSimd};
use spikewire::temporal::TemporalContrast;

/// Number of sums that run side by side.
const LANES: usize = 8;

/// Number of samples that are added in one go.
const BLOCK: usize = 128;

/// Extremes of samples, and sums over their differences that do not wait for one another. They are those of the crate's
/// `Calibration` but for the order of the additions.
pub(super) struct Unordered {
    /// The first and the last sample.
    ends: Option<(f32, f32)>,
    seen: u64,
    sums: Sums,
    arch: Arch,
}

#[derive(Default)]
struct Sums {
    min: [f32; LANES],
    max: [f32; LANES],
    magnitudes: [f64; LANES],
    squares: [f64; LANES],
}

impl Sums {
    /// Adds samples, and their distances from the samples before them.
    #[inline(always)]
    fn add(&mut self, samples: &[f32], before: &[f32]) {
        let mut steps = [0.0; BLOCK];
        for ((step, &sample), &before) in steps.iter_mut().zip(samples).zip(before) {
            *step = f64::from(sample) - f64::from(before);
        }
        gather(&mut self.min, samples, |min, x| if x < min { x } else { min });
        gather(&mut self.max, samples, |max, x| if x > max { x } else { max });
        let steps = &steps[..samples.len()];
        gather(&mut self.magnitudes, steps, |sum, x| sum + x.abs());
        gather(&mut self.squares, steps, |sum, x| sum + x * x);
    }
}

/// Joins what has been gathered with more, in loops so small that they become vectors.
#[inline(always)]
fn gather<T: Copy>(gathered: &mut [T; LANES], more: &[T], join: impl Fn(T, T) -> T) {
    let (rows, rest) = more.as_chunks::<LANES>();
    let mut own = *gathered;
    for row in rows {
        for lane in 0..LANES {
            own[lane] = join(own[lane], row[lane]);
        }
    }
    for (own, x) in own.iter_mut().zip(rest) {
        *own = join(*own, *x);
    }
    *gathered = own;
}

/// Returns the extreme of the lanes; `None` if it is 0 of both signs, of which the crate takes the first.
fn agreed(lanes: [f32; LANES], is_beyond: fn(f32, f32) -> bool) -> Option<f32> {
    let extreme = lanes.into_iter().reduce(|own, x| if is_beyond(own, x) { x } else { own })?;
    let is_same = |x: &f32| *x != extreme || x.to_bits() == extreme.to_bits();
    lanes.iter().all(is_same).then_some(extreme)
}

/// Adds samples but for the first.
struct Add<'a> {
    sums: &'a mut Sums,
    samples: &'a [f32],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let later = self.samples.get(1..).unwrap_or_default();
        for (samples, before) in later.chunks(BLOCK).zip(self.samples.chunks(BLOCK)) {
            self.sums.add(samples, before);
        }
    }
}

impl Unordered {
    /// Starts without samples.
    pub(super) fn new() -> Self {
        Self { ends: None, seen: 0, sums: Sums::default(), arch: Arch::new() }
    }

    /// Adds the next samples, which must be finite.
    pub(super) fn observe(&mut self, samples: &[f32]) {
        let &[first, ref later @ ..] = samples else { return };
        let sums = &mut self.sums;
        if self.ends.is_none() {
            (sums.min, sums.max) = ([first; LANES], [first; LANES]);
        }
        let (start, previous) = self.ends.unwrap_or((first, first));
        self.ends = Some((start, later.last().copied().unwrap_or(first)));
        self.seen += samples.len() as u64;
        sums.add(&[first], &[previous]);
        self.arch.dispatch(Add { sums, samples });
    }

    /// Adds the next samples, rounded to `f32`.
    pub(super) fn observe_rounded<T: Copy + Into<f64>>(&mut self, samples: &[T]) {
        for block in samples.chunks(BLOCK) {
            let mut rounded = [0.0; BLOCK];
            rounded.iter_mut().zip(block).for_each(|(own, sample)| *own = (*sample).into() as f32);
            self.observe(&rounded[..block.len()]);
        }
    }

    /// Returns the smallest and the largest sample; `None` without samples, or if the crate's `Calibration` might have
    /// another one.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        self.ends.filter(|_| u32::try_from(self.seen).is_ok())?;
        let min = agreed(self.sums.min, |min, x| x < min)?;
        Some((min.into(), agreed(self.sums.max, |max, x| x > max)?.into()))
    }

    /// Returns the threshold of temporal contrast; `None` if it might be another one after the additions in their own
    /// order.
    pub(super) fn threshold(&self, factor: f32, of_magnitudes: bool) -> Option<f32> {
        let (first, last) = self.ends.filter(|_| u32::try_from(self.seen).is_ok())?;
        let factor = f64::from(factor);
        let n = (self.seen - 1) as f64;
        let [magnitudes, squares] =
            [self.sums.magnitudes, self.sums.squares].map(|all| all.iter().sum::<f64>());
        // In any order, `n` additions err by at most `n` halves of `EPSILON` of what the sum of magnitudes is (Higham,
        // Accuracy and Stability of Numerical Algorithms, section 4.2). The rest of the work adds a few more.
        let error = (n + 16.0) * f64::EPSILON;
        let sum = if of_magnitudes { magnitudes } else { f64::from(last) - f64::from(first) };
        let (mean, far) = (sum / n, error * magnitudes / n);
        // `sum * mean` is at most `squares`, and errs by at most three times as much.
        let ends = [-4.0, 4.0].map(|side| squares - sum * mean + side * error * squares);
        let ends = ends.map(|own| factor * (own.max(0.0) / (n - 1.0)).sqrt());
        let far = far + error * (mean.abs() + ends[0].abs().max(ends[1].abs()));
        let low = (mean + ends[0].min(ends[1]) - far) as f32;
        let high = (mean + ends[0].max(ends[1]) + far) as f32;
        (low == high && TemporalContrast::try_new(low).is_ok()).then_some(low)
    }
}

#[cfg(test)]
mod tests {
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};
    use spikewire::Calibration;

    use super::*;

    /// Signals of many kinds: short and long, of one or of all sizes, with slopes, with zeros of both signs.
    fn drawn(random: &mut Pcg32, case: usize) -> Vec<f32> {
        let length = random.next_u32() as usize % [5, 40, 3000][case % 3];
        let (offset, scale) = ([0.0, 9.81, 1e6][case / 3 % 3], [1.0, 1e-3, 1e4][case / 9 % 3]);
        let slope = [0.0, 1.0, -1.0][case / 27 % 3];
        let sample = |i: usize| match (case / 81 % 4, random.next_u32()) {
            (0, draw) => [0.0, -0.0, 1.0][draw as usize % 3],
            (1, draw) if f32::from_bits(draw).is_finite() => f32::from_bits(draw),
            (_, draw) => (draw as f32 / 4e9 + slope * i as f32) * scale + offset,
        };
        (0..length).map(sample).collect()
    }

    /// Whatever is told is what the crate's own sums give, and most signals are told.
    #[test]
    fn thresholds_are_those_of_the_sums_in_order() {
        let mut random = Pcg32::seed_from_u64(1);
        let (mut told, mut all) = (0, 0);
        for case in 0..4000 {
            let samples = drawn(&mut random, case);
            let mut unordered = Unordered::new();
            let (one, other) = samples.split_at(samples.len() / 3);
            unordered.observe(one);
            unordered.observe(other);
            let mut ordered = Calibration::<f32>::new();
            for sample in &samples {
                ordered.observe(*sample);
            }
            let bits = |(min, max): (f64, f64)| [min.to_bits(), max.to_bits()];
            let range = ordered.min().zip(ordered.max()).map(|(min, max)| (min.into(), max.into()));
            if let Some(own) = unordered.range() {
                assert_eq!(bits(own), bits(range.unwrap()));
            } else {
                assert!(range.is_none_or(|(min, max)| min == 0.0 || max == 0.0));
            }
            // The second is next to a factor with a threshold of 0, where not all digits are left.
            let least = ordered.differences().map_or(0.3, |own| -own.mean / own.deviation);
            for factor in [0.5, least as f32, -0.7, 0.0, 1e38, f32::INFINITY] {
                let expected = [
                    TemporalContrast::from_calibration(&ordered, factor),
                    TemporalContrast::from_magnitudes(&ordered, factor),
                ];
                for (expected, of_magnitudes) in expected.into_iter().zip([false, true]) {
                    all += usize::from(expected.is_ok());
                    if let Some(threshold) = unordered.threshold(factor, of_magnitudes) {
                        told += 1;
                        assert_eq!(Ok(threshold), expected.map(|own| own.threshold()), "{case}");
                    }
                }
            }
        }
        assert!(told * 10 > all * 9, "{told} of {all}");
    }
}
