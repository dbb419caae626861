//! Every outcome that a step code's threshold can have on a signal.
//!
//! Spikes change only where the threshold passes a distance that some sample has, so that finitely many intervals say
//! all; within one of them the error is a parabola in the decoder's step, whose lowest point is known.

/// A threshold and a step, and what they come to in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The encoder's threshold.
    pub threshold: f64,
    /// What the decoder adds for a spike.
    pub step: f64,
    /// How many spikes there are.
    pub spikes: usize,
    /// The sum of the squares of what decoded values are off.
    pub squares: f64,
}

/// Sums of a parabola: the error's squares by the step that the decoder adds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parabola {
    counts: f64,
    products: f64,
    values: f64,
}

impl Parabola {
    /// Takes a sample, as its distance from the first, and how many more spikes went up than down before and with it.
    pub fn observe(&mut self, value: f64, count: f64) {
        self.counts += count * count;
        self.products += count * value;
        self.values += value * value;
    }

    /// The step with the least error, if there is one above 0.
    pub fn lowest(&self) -> Option<f64> {
        (self.counts > 0.0 && self.products > 0.0).then(|| self.products / self.counts)
    }

    /// The squares at this step.
    pub fn squares(&self, step: f64) -> f64 {
        (self.values - 2.0 * step * self.products + step * step * self.counts).max(0.0)
    }
}

/// What is next to the upper end of an interval that does not hold it.
pub fn below(low: f64, high: f64) -> f64 {
    low + (high - low) * 0.9999
}

/// The outcomes of a code that spikes where a sample's distance from its past is above the threshold, whatever it has
/// sent before: all of them, or about so many at most. The stretches are coded each by itself, from its first sample.
pub fn outcomes(
    stretches: &[&[f64]],
    distances: &[Vec<f64>],
    is_step_free: bool,
    most: usize,
) -> Vec<Outcome> {
    let mut sizes: Vec<f64> = distances.iter().flatten().map(|distance| distance.abs()).collect();
    sizes.retain(|size| *size > 0.0);
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes.dedup();
    let stride = sizes.len().div_ceil(most.max(1)).max(1);
    let outcome = |(high, low): (f64, f64)| {
        let (mut parabola, mut spikes) = (Parabola::default(), 0);
        for (values, distances) in stretches.iter().zip(distances) {
            let mut count = 0.0;
            let first = values.first().copied().unwrap_or_default();
            for (place, (value, distance)) in values.iter().zip(distances).enumerate() {
                if distance.abs() >= high {
                    spikes += 1;
                    // The decoder holds the first sample's value, whose spike changes nothing.
                    count += if place > 0 { distance.signum() } else { 0.0 };
                }
                parabola.observe(value - first, count);
            }
        }
        let inside = below(low, high);
        let (threshold, step) = if is_step_free {
            (f64::midpoint(low, inside), parabola.lowest().unwrap_or(low))
        } else {
            let step = parabola.lowest().unwrap_or(low).clamp(low, inside);
            (step, step)
        };
        Outcome { threshold, step, spikes, squares: parabola.squares(step) }
    };
    let pairs = sizes.iter().zip(sizes.iter().skip(1)).step_by(stride);
    pairs.map(|(high, low)| outcome((*high, *low))).filter(|found| found.step > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::outcomes;

    /// Every threshold on a fine grid gives an outcome that is among them, or worse.
    #[test]
    fn no_threshold_is_better() {
        let values: Vec<f64> = (0..60).map(|i| f64::from(i * i % 23) * 0.37).collect();
        let mut distances = vec![0.0];
        distances.extend(values.windows(2).map(|pair| pair[1] - pair[0]));
        let all = outcomes(&[&values], &[distances.clone()], false, usize::MAX);
        for threshold in (1..900).map(|i| f64::from(i) * 0.01) {
            let (mut decoded, mut spikes, mut squares) = (values[0], 0, 0.0);
            for (value, distance) in values.iter().zip(&distances) {
                if distance.abs() > threshold {
                    spikes += 1;
                    decoded += threshold * distance.signum();
                }
                squares += (value - decoded).powi(2);
            }
            let is_as_good =
                |own: &super::Outcome| own.spikes <= spikes && own.squares <= squares * 1.01 + 1e-9;
            assert!(spikes == 0 || all.iter().any(is_as_good), "{threshold}: {spikes} {squares}");
        }
    }
}
