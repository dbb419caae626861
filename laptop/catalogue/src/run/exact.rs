//! Lists the outcomes of all thresholds of a step code on a signal.
//!
//! Spikes change only where the threshold passes the distance of some sample from its past, so there are finitely many
//! intervals of thresholds with equal spikes. Within an interval the squared error is a parabola in the decoder's step,
//! with a known minimum.

/// A threshold and a step, with their spikes and errors in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Threshold of the encoder.
    pub threshold: f64,
    /// Amount that the decoder adds for a spike.
    pub step: f64,
    /// Number of spikes.
    pub spikes: usize,
    /// Sum of the squared errors of the decoded values.
    pub squares: f64,
    /// Sum of the squared errors if each stretch is decoded with the step that is best for all other stretches: an
    /// estimate for stretches that were not seen. Equal to `squares` if there is a single stretch, or if the step must
    /// equal the threshold.
    pub apart: f64,
}

/// The outcomes of a range of thresholds.
#[derive(Clone, Debug, Default)]
pub struct Outcomes {
    /// The outcomes, each with its best step.
    pub list: Vec<Outcome>,
    /// Whether the list contains every outcome in the range.
    pub is_complete: bool,
}

/// The squared error as a function of the decoder's step: a parabola, given by its sums.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parabola {
    counts: f64,
    products: f64,
    values: f64,
}

impl Parabola {
    /// Adds a sample: its distance from the first, and the number of spikes up minus spikes down until then.
    pub fn observe(&mut self, value: f64, count: f64) {
        self.counts += count * count;
        self.products += count * value;
        self.values += value * value;
    }

    /// Returns the sum for two signals.
    fn plus(self, other: Self) -> Self {
        Self {
            counts: self.counts + other.counts,
            products: self.products + other.products,
            values: self.values + other.values,
        }
    }

    /// Returns the sum without one of the signals.
    fn minus(self, other: Self) -> Self {
        Self {
            counts: self.counts - other.counts,
            products: self.products - other.products,
            values: self.values - other.values,
        }
    }

    /// Returns the step with the smallest error; `None` if there is none above 0.
    pub fn lowest(&self) -> Option<f64> {
        (self.counts > 0.0 && self.products > 0.0).then(|| self.products / self.counts)
    }

    /// Returns the squared error at this step.
    pub fn squares(&self, step: f64) -> f64 {
        (self.values - 2.0 * step * self.products + step * step * self.counts).max(0.0)
    }
}

/// Returns the largest value to use in an interval that does not contain its upper end.
pub fn below(low: f64, high: f64) -> f64 {
    // Two neighbours of the floats have nothing between them.
    (low + (high - low) * 0.9999).min(high.next_down())
}

/// Returns the smallest value to use in an interval that does not contain its lower end.
pub fn above(low: f64, high: f64) -> f64 {
    high - (high - low) * 0.9999
}

/// Lists all outcomes of a code that spikes if a sample's distance from its past is above the threshold, whatever was
/// sent before. Each stretch is coded by itself, from its first sample. Takes time `n log n` for `n` samples: between a
/// threshold and the next lower one a single sample begins to spike, which raises or lowers all counts from it on.
pub fn outcomes(stretches: &[&[f64]], distances: &[Vec<f64>], is_step_free: bool) -> Outcomes {
    let mut stacks: Vec<Counts> = stretches.iter().map(|values| Counts::new(values)).collect();
    let mut order: Vec<(f64, usize, usize)> = Vec::new();
    for (stretch, own) in distances.iter().enumerate() {
        order.extend(own.iter().enumerate().map(|(place, distance)| (*distance, stretch, place)));
    }
    order.retain(|(distance, ..)| *distance != 0.0);
    order.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let mut list = Vec::new();
    let mut spikes = 0;
    let mut high = None;
    // From the threshold that no distance exceeds to the one that all do.
    let mut groups = order.chunk_by(|a, b| a.0.abs() == b.0.abs()).peekable();
    while let Some(group) = groups.next() {
        let size = group.first().map_or(0.0, |(distance, ..)| distance.abs());
        if high.is_none() {
            let squares = sum(&stacks).values;
            list.push(Outcome { threshold: size, step: size, spikes, squares, apart: squares });
        }
        high = Some(size);
        for &(distance, stretch, place) in group {
            spikes += 1;
            // The decoder holds the first sample's value, whose spike changes nothing.
            if let (Some(stack), true) = (stacks.get_mut(stretch), place > 0) {
                stack.raise(place, if distance > 0.0 { 1 } else { -1 });
            }
        }
        let low = groups.peek().and_then(|next| next.first()).map_or(0.0, |next| next.0.abs());
        let inside = below(low, size);
        let parabola = sum(&stacks);
        let (threshold, step) = if is_step_free {
            (f64::midpoint(low, inside), parabola.lowest())
        } else {
            let step = parabola.lowest().unwrap_or(low).clamp(low, inside);
            (step, Some(step))
        };
        let step = step.filter(|step| *step > 0.0).unwrap_or(threshold);
        if threshold > 0.0 {
            let squares = parabola.squares(step);
            let is_apart = is_step_free && stacks.len() > 1;
            let apart = if is_apart { apart(&stacks, threshold) } else { squares };
            list.push(Outcome { threshold, step, spikes, squares, apart });
        }
    }
    Outcomes { list, is_complete: true }
}

fn sum(stacks: &[Counts]) -> Parabola {
    stacks.iter().fold(Parabola::default(), |sum, own| sum.plus(own.parabola))
}

/// Returns the sum of the squared errors if each stretch is decoded with the best step of the others.
fn apart(stacks: &[Counts], threshold: f64) -> f64 {
    let all = sum(stacks);
    let squares = stacks.iter().map(|own| {
        let others = all.minus(own.parabola);
        own.parabola.squares(others.lowest().unwrap_or(threshold))
    });
    squares.sum()
}

/// Number of spikes up minus spikes down at each sample of a stretch; spikes are added in any order.
struct Counts {
    /// Tree of partial sums (a Fenwick tree) of the signs of the spikes.
    signs: Vec<i64>,
    /// Tree of partial sums of the signs, each times the number of samples from its own to the end.
    weighted: Vec<i64>,
    /// Sums of the values from each sample to the end, as distances from the first.
    values: Vec<f64>,
    /// Sum of all weighted signs.
    total: i64,
    /// Squared error as a function of the step.
    parabola: Parabola,
}

impl Counts {
    fn new(values: &[f64]) -> Self {
        let first = values.first().copied().unwrap_or_default();
        let mut sums: Vec<f64> = values.iter().map(|value| value - first).collect();
        let squares = sums.iter().map(|value| value * value).sum();
        let parabola = Parabola { values: squares, ..Parabola::default() };
        let mut sum = 0.0;
        for value in sums.iter_mut().rev() {
            sum += *value;
            *value = sum;
        }
        let count = values.len();
        Self {
            signs: vec![0; count + 1],
            weighted: vec![0; count + 1],
            values: sums,
            total: 0,
            parabola,
        }
    }

    /// Adds a spike at a sample, which changes all counts from there on.
    fn raise(&mut self, place: usize, sign: i64) {
        let samples = self.values.len() as i64;
        let left = samples - place as i64;
        // The sum of the counts from this place on: spikes up to here count in all that are left, later ones from
        // their own sample on.
        let (signs, weighted) = (prefix(&self.signs, place), prefix(&self.weighted, place));
        let sum = signs * left + (self.total - weighted);
        self.parabola.counts += (2 * sign * sum + left) as f64;
        self.parabola.products += sign as f64 * self.values.get(place).copied().unwrap_or_default();
        add(&mut self.signs, place, sign);
        add(&mut self.weighted, place, sign * left);
        self.total += sign * left;
    }
}

/// Returns the sum of the entries up to and including this one.
fn prefix(tree: &[i64], place: usize) -> i64 {
    let mut node = place + 1;
    let mut sum = 0;
    while node > 0 {
        sum += tree.get(node).copied().unwrap_or_default();
        node &= node - 1;
    }
    sum
}

fn add(tree: &mut [i64], place: usize, change: i64) {
    let mut node = place + 1;
    while let Some(sum) = tree.get_mut(node) {
        *sum += change;
        node += node & node.wrapping_neg();
    }
}

#[cfg(test)]
mod tests {
    use super::{Outcome, outcomes};

    /// Computes spikes and squared error of a threshold and a step, sample by sample.
    fn coded(stretches: &[Vec<f64>], threshold: f64, step: f64) -> (usize, f64) {
        let (mut spikes, mut squares) = (0, 0.0);
        for values in stretches {
            let mut decoded = values[0];
            for pair in values.windows(2) {
                let distance = pair[1] - pair[0];
                if distance.abs() > threshold {
                    spikes += 1;
                    decoded += step * distance.signum();
                }
                squares += (pair[1] - decoded).powi(2);
            }
        }
        (spikes, squares)
    }

    fn all(is_step_free: bool) -> (Vec<Vec<f64>>, Vec<Outcome>) {
        let values = |shift: i32| (0..60).map(|i| f64::from((i + shift) * i % 23) * 0.37).collect();
        let stretches: Vec<Vec<f64>> = vec![values(0), values(5)];
        let slices: Vec<&[f64]> = stretches.iter().map(Vec::as_slice).collect();
        let distances = stretches.iter().map(|values| {
            [0.0].into_iter().chain(values.windows(2).map(|pair| pair[1] - pair[0])).collect()
        });
        let found = outcomes(&slices, &distances.collect::<Vec<_>>(), is_step_free);
        assert!(found.is_complete);
        (stretches, found.list)
    }

    #[test]
    fn figures_are_those_of_coding_sample_by_sample() {
        for is_step_free in [false, true] {
            let (stretches, list) = all(is_step_free);
            for own in list {
                let (spikes, squares) = coded(&stretches, own.threshold, own.step);
                assert_eq!(own.spikes, spikes, "{own:?}");
                assert!(
                    (own.squares - squares).abs() < 1e-9 * squares.max(1.0),
                    "{own:?} {squares}"
                );
            }
        }
    }

    /// For every threshold on a fine grid the list contains its outcome, or a better one.
    #[test]
    fn no_threshold_is_better() {
        let (stretches, list) = all(false);
        for threshold in (1..1200).map(|i| f64::from(i) * 0.01) {
            let (spikes, squares) = coded(&stretches, threshold, threshold);
            let is_as_good =
                |own: &Outcome| own.spikes <= spikes && own.squares <= squares * 1.01 + 1e-9;
            assert!(list.iter().any(is_as_good), "{threshold}: {spikes} {squares}");
        }
    }
}
