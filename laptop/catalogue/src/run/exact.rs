//! The outcomes that a step code's threshold can have on a signal.
//!
//! Spikes change only where the threshold passes a distance that some sample has, so that finitely many intervals say
//! all; within one of them the error is a parabola in the decoder's step, whose lowest point is known.

/// A threshold and a step, and what they come to in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The encoder's threshold.
    pub threshold: f64,
    /// The amount that the decoder adds for a spike.
    pub step: f64,
    /// How many spikes there are.
    pub spikes: usize,
    /// The sum of the squared errors of the decoded values.
    pub squares: f64,
    /// The same if each stretch is decoded with the step that is best for all others: what can be expected of a stretch
    /// that was not there. The same as `squares` for a single stretch, or where the step is the threshold.
    pub apart: f64,
}

/// Outcomes of a threshold over a range of thresholds.
#[derive(Clone, Debug, Default)]
pub struct Outcomes {
    /// The outcomes, each with its best step.
    pub list: Vec<Outcome>,
    /// Whether no outcome in the range is missing from the list.
    pub is_complete: bool,
}

/// The sums of a parabola: the squared error as a function of the decoder's step.
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

    /// The sums of two signals.
    fn plus(self, other: Self) -> Self {
        Self {
            counts: self.counts + other.counts,
            products: self.products + other.products,
            values: self.values + other.values,
        }
    }

    /// The sums without those of one of the signals.
    fn minus(self, other: Self) -> Self {
        Self {
            counts: self.counts - other.counts,
            products: self.products - other.products,
            values: self.values - other.values,
        }
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

/// The largest value that is used of an interval without its upper end.
pub fn below(low: f64, high: f64) -> f64 {
    // Two neighbours of the floats have nothing between them.
    (low + (high - low) * 0.9999).min(high.next_down())
}

/// The smallest value that is used of an interval without its lower end.
pub fn above(low: f64, high: f64) -> f64 {
    high - (high - low) * 0.9999
}

/// All outcomes of a code that spikes where a sample's distance from its past is above the threshold, whatever it has
/// sent before. Each stretch is coded by itself, from its first sample. Takes `n log n` steps for `n` samples: from one
/// threshold to the next lower one a single sample begins to spike, which raises or lowers all counts from it on.
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

/// The squares if each stretch is decoded with the step of the others.
fn apart(stacks: &[Counts], threshold: f64) -> f64 {
    let all = sum(stacks);
    let squares = stacks.iter().map(|own| {
        let others = all.minus(own.parabola);
        own.parabola.squares(others.lowest().unwrap_or(threshold))
    });
    squares.sum()
}

/// How many more spikes went up than down, by sample, of a stretch to which spikes are added in any order.
struct Counts {
    /// A tree of partial sums (Fenwick's) of the signs of the spikes.
    signs: Vec<i64>,
    /// The same of the signs, each times the number of samples from its own on.
    weighted: Vec<i64>,
    /// The sums of the values from each sample to the end, as distances from the first.
    values: Vec<f64>,
    /// The sum of all weighted signs.
    total: i64,
    /// The error by the step.
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

    /// Adds a spike of this sign at a place, which changes all counts from there on.
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

/// The sum of the entries up to and with this one.
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

    /// The spikes and the squared error of a threshold and a step, computed sample by sample.
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

    /// Every threshold on a fine grid gives an outcome that is among them, or worse.
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
