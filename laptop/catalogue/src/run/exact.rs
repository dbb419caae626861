//! Lists the outcomes of all thresholds of a step code on a signal.
//!
//! Spikes change only where the threshold passes the distance of some sample from its past, so there are finitely many
//! intervals of thresholds with equal spikes. Within an interval the squared error is a parabola in the decoder's step,
//! with a known minimum.

use super::Piece;
use std::ops::Range;

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
    /// Sum of the squared errors if each scored range is decoded with the step that is best for all other ranges: an
    /// estimate for samples that were not seen. Equal to `squares` if there is a single range, or if the step must
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
/// sent before. Each piece is coded by itself, from its first sample. Takes time `n log n` for `n` samples,
/// times the number of scored ranges if the step is free: between a threshold and the next lower one a single sample
/// begins to spike, which raises or lowers all counts from it on.
pub fn outcomes(pieces: &[Piece], distances: &[Vec<f64>], is_step_free: bool) -> Outcomes {
    let ranges: usize = pieces.iter().map(|own| own.scored.len()).sum();
    let is_apart = is_step_free && ranges > 1;
    let mut stacks: Vec<Counts> = pieces.iter().map(|piece| Counts::new(piece, is_apart)).collect();
    let mut order: Vec<(f64, usize, usize)> = Vec::new();
    for (piece, own) in distances.iter().enumerate() {
        order.extend(own.iter().enumerate().map(|(place, distance)| (*distance, piece, place)));
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
        for &(distance, piece, place) in group {
            let Some(stack) = stacks.get_mut(piece) else { continue };
            spikes += usize::from(stack.is_scored(place));
            // The decoder holds the first sample's value, whose spike changes nothing.
            if place > 0 {
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
            let apart = if is_apart { apart(&stacks, threshold) } else { squares };
            list.push(Outcome { threshold, step, spikes, squares, apart });
        }
    }
    Outcomes { list, is_complete: true }
}

fn sum(stacks: &[Counts]) -> Parabola {
    stacks.iter().fold(Parabola::default(), |sum, own| sum.plus(own.parabola))
}

/// Returns the sum of the squared errors if each scored range is decoded with the best step of the others.
fn apart(stacks: &[Counts], threshold: f64) -> f64 {
    let all = sum(stacks);
    let squares = stacks.iter().flat_map(|own| &own.ranges).map(|(_, own)| {
        let others = all.minus(*own);
        own.squares(others.lowest().unwrap_or(threshold))
    });
    squares.sum()
}

/// Number of spikes up minus spikes down at each sample of a piece; spikes are added in any order.
struct Counts {
    /// Tree of partial sums (a Fenwick tree) of the signs of the spikes.
    signs: Vec<i64>,
    /// Tree of partial sums of the signs, each times the number of scored samples from its own to the end.
    weighted: Vec<i64>,
    /// Sums of the scored values from each sample to the end, as distances from the first; 0 after the last sample.
    values: Vec<f64>,
    /// Number of scored samples from each sample to the end; 0 after the last sample.
    left: Vec<i64>,
    /// Sum of all weighted signs.
    total: i64,
    /// Squared error as a function of the step.
    parabola: Parabola,
    /// The parabola of each scored range; empty if none is asked for.
    ranges: Vec<(Range<usize>, Parabola)>,
}

impl Counts {
    fn new(piece: &Piece, is_apart: bool) -> Self {
        let first = piece.values.first().copied().unwrap_or_default();
        let mut sums: Vec<f64> = piece.values.iter().map(|value| value - first).collect();
        let mask = piece.mask();
        let of = |range: &Range<usize>| {
            let values = sums.get(range.clone()).unwrap_or_default();
            let values = values.iter().map(|value| value * value).sum();
            (range.clone(), Parabola { values, ..Parabola::default() })
        };
        let ranges: Vec<(Range<usize>, Parabola)> = piece.scored.iter().map(of).collect();
        let parabola = ranges.iter().fold(Parabola::default(), |sum, (_, own)| sum.plus(*own));
        let count = sums.len();
        sums.push(0.0);
        let mut left = vec![0; count + 1];
        let (mut sum, mut scored) = (0.0, 0);
        for ((value, left), is_scored) in sums.iter_mut().zip(&mut left).zip(&mask).rev() {
            sum += if *is_scored { *value } else { 0.0 };
            scored += i64::from(*is_scored);
            (*value, *left) = (sum, scored);
        }
        Self {
            signs: vec![0; count + 1],
            weighted: vec![0; count + 1],
            values: sums,
            left,
            total: 0,
            parabola,
            ranges: if is_apart { ranges } else { Vec::new() },
        }
    }

    fn left(&self, place: usize) -> i64 {
        self.left.get(place).copied().unwrap_or_default()
    }

    fn is_scored(&self, place: usize) -> bool {
        self.left(place) > self.left(place + 1)
    }

    /// Returns the sum of the counts of all scored samples from `place` on. Spikes up to `place` count in all of these
    /// samples, later spikes from their own sample on.
    fn from(&self, place: usize) -> i64 {
        let left = self.left(place);
        if left == 0 {
            return 0;
        }
        let (signs, weighted) = (prefix(&self.signs, place), prefix(&self.weighted, place));
        signs * left + (self.total - weighted)
    }

    /// Adds a spike at a sample, which changes all counts from there on.
    fn raise(&mut self, place: usize, sign: i64) {
        let mut ranges = std::mem::take(&mut self.ranges);
        let value = |place: usize| self.values.get(place).copied().unwrap_or_default();
        let change = |start: usize, end: usize| {
            let sum = self.from(start) - self.from(end);
            let counts = (2 * sign * sum + self.left(start) - self.left(end)) as f64;
            Parabola { counts, products: sign as f64 * (value(start) - value(end)), values: 0.0 }
        };
        let (end, left) = (self.values.len(), self.left(place));
        let all = self.parabola.plus(change(place, end));
        for (range, own) in ranges.iter_mut().filter(|(range, _)| range.end > place) {
            *own = own.plus(change(range.start.max(place), range.end));
        }
        (self.parabola, self.ranges) = (all, ranges);
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
    use super::{Outcome, Piece, outcomes};
    use std::ops::Range;

    /// Scored samples of each test piece, of 60 samples.
    const SCORED: [Range<usize>; 2] = [0..17, 29..60];

    /// Computes spikes and squared errors of a threshold and a step, sample by sample: those of all scored samples, and
    /// those of each scored range.
    fn coded(pieces: &[Vec<f64>], threshold: f64, step: f64) -> (usize, f64, Vec<f64>) {
        let (mut spikes, mut apart) = (0, Vec::new());
        for values in pieces {
            let mut decoded = vec![values[0]];
            for pair in values.windows(2) {
                let distance = pair[1] - pair[0];
                let sign = if distance.abs() > threshold { distance.signum() } else { 0.0 };
                let place = decoded.len();
                let is_scored = SCORED.iter().any(|own| own.contains(&place));
                spikes += usize::from(sign != 0.0 && is_scored);
                decoded.push(decoded[place - 1] + step * sign);
            }
            apart.extend(SCORED.iter().map(|own| -> f64 {
                own.clone().map(|place| (values[place] - decoded[place]).powi(2)).sum()
            }));
        }
        (spikes, apart.iter().sum(), apart)
    }

    fn all(is_step_free: bool) -> (Vec<Vec<f64>>, Vec<Outcome>) {
        let values = |shift: i32| (0..60).map(|i| f64::from((i + shift) * i % 23) * 0.37).collect();
        let signals: Vec<Vec<f64>> = vec![values(0), values(5)];
        let pieces: Vec<Piece> =
            signals.iter().map(|values| Piece { values, scored: &SCORED }).collect();
        let distances = signals.iter().map(|values| {
            [0.0].into_iter().chain(values.windows(2).map(|pair| pair[1] - pair[0])).collect()
        });
        let found = outcomes(&pieces, &distances.collect::<Vec<_>>(), is_step_free);
        assert!(found.is_complete);
        (signals, found.list)
    }

    #[test]
    fn figures_are_those_of_coding_sample_by_sample() {
        for is_step_free in [false, true] {
            let (signals, list) = all(is_step_free);
            for own in list {
                let (spikes, squares, _) = coded(&signals, own.threshold, own.step);
                assert_eq!(own.spikes, spikes, "{own:?}");
                assert!(
                    (own.squares - squares).abs() < 1e-9 * squares.max(1.0),
                    "{own:?} {squares}"
                );
            }
        }
    }

    /// The error with the step of the other ranges is the error of a range at the step that minimises the error of all
    /// other ranges, found here on a grid. If that step is not above 0, it is the threshold.
    #[test]
    fn ranges_apart_have_the_step_of_the_others() {
        let (signals, list) = all(true);
        for own in list.iter().step_by(5).filter(|own| own.spikes > 4) {
            let steps: Vec<f64> = (1..4000).map(|place| f64::from(place) * 0.002).collect();
            let at: Vec<Vec<f64>> =
                steps.iter().map(|step| coded(&signals, own.threshold, *step).2).collect();
            let at_threshold = coded(&signals, own.threshold, own.threshold).2;
            let apart: f64 = (0..4)
                .map(|range| {
                    let others = |place: &usize| at[*place].iter().sum::<f64>() - at[*place][range];
                    let best = (0..at.len()).min_by(|a, b| others(a).total_cmp(&others(b)));
                    // No step above 0 lowers the error of the others.
                    if best == Some(0) { at_threshold[range] } else { at[best.unwrap()][range] }
                })
                .sum();
            assert!((own.apart / apart - 1.0).abs() < 0.01, "{own:?} {apart}");
        }
    }

    /// For every threshold on a fine grid the list contains its outcome, or a better one.
    #[test]
    fn no_threshold_is_better() {
        let (signals, list) = all(false);
        for threshold in (1..1200).map(|i| f64::from(i) * 0.01) {
            let (spikes, squares, _) = coded(&signals, threshold, threshold);
            let is_as_good =
                |own: &Outcome| own.spikes <= spikes && own.squares <= squares * 1.01 + 1e-9;
            assert!(list.iter().any(is_as_good), "{threshold}: {spikes} {squares}");
        }
    }
}
