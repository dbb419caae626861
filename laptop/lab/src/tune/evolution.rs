//! Adaptive differential evolution with a shrinking number of parents: L-SHADE, after Tanabe and Fukunaga (2014).
//!
//! The number of parents shrinks with the share of the caller's budget that is spent. Even a search with a small budget
//! thus converges as far as possible. Points lie in the unit cube.

use super::chance::Chance;

/// Number of entries in each of two memories: one of scale factors, one of crossover rates. Each entry is the weighted
/// mean of the factors or rates with which one generation produced points better than their parents.
const MEMORY: usize = 6;
/// Number of parents at the end of the search. Parents are the points from which new points are made. The number of
/// parents falls while the budget is spent.
const FEWEST: usize = 4;
/// Share of all parents that count as best parents. Each new point moves towards one of these best parents.
const BEST: f64 = 0.15;

/// An optimiser that seeks the smallest value of a function. The caller computes the values.
pub(super) struct Evolution {
    chance: Chance,
    /// The parents, each with the function's value at this point. Each call of `ask` sorts the parents by value,
    /// smallest first.
    parents: Vec<(Vec<f64>, f64)>,
    /// Former parents that were replaced by better points.
    replaced: Vec<Vec<f64>>,
    first_count: usize,
    factors: [f64; MEMORY],
    rates: [f64; MEMORY],
    remembered: usize,
    /// Scale factor and crossover rate of each point that the latest call of `ask` returned.
    asked: Vec<(f64, f64)>,
}

impl Evolution {
    /// Starts with `parents`, points whose values are known.
    pub(super) fn new(seed: u64, parents: Vec<(Vec<f64>, f64)>) -> Self {
        Self {
            chance: Chance::new(seed),
            first_count: parents.len(),
            parents,
            replaced: Vec::new(),
            factors: [0.5; MEMORY],
            rates: [0.7; MEMORY],
            remembered: 0,
            asked: Vec::new(),
        }
    }

    /// Returns the next points, whose values the caller is to compute. `spent` is the share of the budget that is used,
    /// from 0 to 1.
    pub(super) fn ask(&mut self, spent: f64) -> Vec<Vec<f64>> {
        self.parents.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let (first, fewest) = (self.first_count as f64, FEWEST as f64);
        let count = (first + (fewest - first) * spent).round().max(fewest) as usize;
        self.parents.truncate(count);
        self.asked.clear();
        (0..self.parents.len()).map(|place| self.trial(place)).collect()
    }

    fn trial(&mut self, place: usize) -> Vec<f64> {
        let chance = &mut self.chance;
        let count = self.parents.len();
        let memory = chance.below(MEMORY);
        let factor = loop {
            let factor = self.factors[memory] + 0.1 * chance.cauchy();
            if factor > 0.0 {
                break factor.min(1.0);
            }
        };
        let rate = (self.rates[memory] + 0.1 * chance.normal()).clamp(0.0, 1.0);
        self.asked.push((factor, rate));
        let best = chance.below(((count as f64 * BEST).max(2.0) as usize).min(count));
        let other = (place + 1 + chance.below((count - 1).max(1))) % count;
        let third = chance.below(count + self.replaced.len());
        let third = match self.replaced.get(third.wrapping_sub(count)) {
            Some(point) => point,
            None => &self.parents[third.min(count - 1)].0,
        };
        let (own, best, other) =
            (&self.parents[place].0, &self.parents[best].0, &self.parents[other].0);
        let always = chance.below(own.len());
        let mut point = own.clone();
        for (axis, value) in point.iter_mut().enumerate() {
            if axis == always || chance.part() < rate {
                let from = *value;
                *value += factor * (best[axis] - from) + factor * (other[axis] - third[axis]);
                // Instead of passing a bound, the value moves halfway to it.
                if *value < 0.0 {
                    *value = from / 2.0;
                } else if *value > 1.0 {
                    *value = f64::midpoint(1.0, from);
                }
            }
        }
        point
    }

    /// Takes points that `ask` returned, in the same order, each with its value. The caller may have changed the
    /// coordinates of these points, and may leave out points at the end.
    pub(super) fn tell(&mut self, points: Vec<(Vec<f64>, f64)>) {
        /// Maximum weight of a point in the means of scale factors and crossover rates. Only a point that is better
        /// than its parent has a weight. The weight is the amount by which the function is smaller at the point than at
        /// its parent. Without a maximum, points whose parents break a limit would outweigh all others.
        const MOST: f64 = 1e5;
        let mut successes = Vec::new();
        let tried = points.into_iter().zip(&self.asked);
        for (((point, value), (factor, rate)), parent) in tried.zip(&mut self.parents) {
            if value > parent.1 {
                continue;
            }
            let gain = (parent.1 - value).min(MOST);
            let (old, _) = std::mem::replace(parent, (point, value));
            if gain > 0.0 {
                successes.push((*factor, *rate, gain));
                self.replaced.push(old);
            }
        }
        while self.replaced.len() > 2 * self.first_count {
            let place = self.chance.below(self.replaced.len());
            self.replaced.swap_remove(place);
        }
        let sum = |of: fn(&(f64, f64, f64)) -> f64| successes.iter().map(of).sum::<f64>();
        let gains = sum(|own| own.2);
        if gains > 0.0 {
            self.factors[self.remembered] =
                sum(|own| own.2 * own.0 * own.0) / sum(|own| own.2 * own.0);
            self.rates[self.remembered] = sum(|own| own.2 * own.1) / gains;
            self.remembered = (self.remembered + 1) % MEMORY;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Chance, Evolution};

    /// In a bowl of five dimensions, the evolution comes within a squared distance of 1e-3 of the minimum with 400
    /// points. 400 random points would not come so near.
    #[test]
    fn a_bowl_is_descended() {
        let value = |point: &[f64]| point.iter().map(|own| (own - 0.3).powi(2)).sum::<f64>();
        let mut chance = Chance::new(1);
        let mut draw = || (0..5).map(|_| chance.part()).collect::<Vec<f64>>();
        let first: Vec<(Vec<f64>, f64)> = (0..20)
            .map(|_| draw())
            .map(|point| (value(&point), point))
            .map(|(v, p)| (p, v))
            .collect();
        let mut least = f64::INFINITY;
        let mut evolution = Evolution::new(1, first);
        let mut spent = 20;
        while spent < 400 {
            let points = evolution.ask(f64::from(spent) / 400.0);
            spent += points.len() as i32;
            let values: Vec<(Vec<f64>, f64)> = points
                .into_iter()
                .map(|point| (value(&point), point))
                .map(|(v, p)| (p, v))
                .collect();
            least = values.iter().map(|(_, value)| *value).fold(least, f64::min);
            evolution.tell(values);
        }
        assert!(least < 1e-3, "{least}");
    }
}
