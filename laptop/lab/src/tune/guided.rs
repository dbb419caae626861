//! A search that a model guides: of many candidates, the one is scored from which the model of the points so far expects
//! the greatest improvement.
//!
//! Nothing depends on the budget: a search with more settings scores those of a shorter one first, and is never worse.

use super::chance::Chance;
use super::problem::{Goal, Problem, Scored, most_spikes};
use super::space::{Role, Space};
use super::surrogate::{Hyper, Surrogate};
use std::collections::HashSet;
use std::f64::consts::TAU;

/// Number of points that are scored at once.
const TOGETHER: usize = 4;
/// Number of candidates for each point.
const CANDIDATES: usize = 60;
/// Largest number of points in a model.
const MODELLED: usize = 60;
/// Number of batches after which the model's parameters are fitted again.
const REFIT: usize = 4;
/// Deviation of the candidates around the best point at the start, as a share of an axis: smallest, first, largest.
const STEPS: (f64, f64, f64) = (1e-4, 0.15, 0.3);

/// A point that was scored.
struct Known {
    point: Vec<f64>,
    /// Rating of the point: smaller is better.
    value: f64,
    /// Logarithms of the number of spikes and of the mean square error. `None` if the settings are invalid.
    modelled: Option<[f64; 2]>,
}

/// A search that is running.
pub(super) struct Guided<'a> {
    problem: &'a Problem<'a>,
    space: &'a Space,
    goal: Goal,
    chance: Chance,
    known: Vec<Known>,
    keys: HashSet<Vec<u64>>,
    best: usize,
    step: f64,
    near: [Hyper; 2],
    far: [Hyper; 2],
    first: Vec<Vec<f64>>,
    round: usize,
}

impl<'a> Guided<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, space: &'a Space, goal: Goal, seed: u64) -> Self {
        let share = match goal {
            Goal::LeastError(efficiency) => 1.0 - efficiency / 100.0,
            Goal::MostEfficient(_) | Goal::Front => 0.5,
        };
        let hyper = || std::array::from_fn(|_| Hyper::new(space.len()));
        Self {
            problem,
            space,
            goal,
            chance: Chance::new(seed),
            known: Vec::new(),
            keys: HashSet::new(),
            best: 0,
            step: STEPS.1,
            near: hyper(),
            far: hyper(),
            first: space.starts(seed, 4 + 4 * space.len(), share),
            round: 0,
        }
    }

    /// Returns the next points to score, at most `most`. Returns none if no new ones are found.
    pub(super) fn ask(&mut self, most: usize) -> Vec<Vec<f64>> {
        let mut points = Vec::new();
        while let Some(point) = self.first.pop() {
            points.extend(self.new_point(point));
            if points.len() == TOGETHER {
                break;
            }
        }
        if points.is_empty() {
            self.round += 1;
            let near = self.models(true);
            let far = self.models(false);
            for slot in 0..TOGETHER {
                let is_far = slot == TOGETHER - 1;
                let step = self.step * [1.0, 0.3, 0.1, 0.0][slot];
                let models = if is_far { &far } else { &near };
                for _ in 0..4 {
                    let chosen = self.chosen(models, (!is_far).then_some(step));
                    if let Some(point) = self.new_point(chosen) {
                        points.push(point);
                        break;
                    }
                }
            }
        }
        points.truncate(most);
        points
    }

    /// Takes the scores of the points that `ask` returned.
    pub(super) fn tell(&mut self, points: Vec<Vec<f64>>, scored: &[Option<Scored>]) {
        let before = self.known.get(self.best).map_or(f64::INFINITY, |own| own.value);
        let was_guided = self.round > 0;
        for (point, own) in points.into_iter().zip(scored) {
            let value = own.as_ref().map_or(f64::INFINITY, |own| self.problem.value(self.goal, own));
            let modelled = own.as_ref().map(|own| {
                let square = self.problem.mean_square(&own.tally).max(1e-300);
                [(1.0 + own.tally.spikes as f64).ln(), square.ln()]
            });
            if self.known.get(self.best).is_none_or(|best| value < best.value) {
                self.best = self.known.len();
            }
            self.known.push(Known { point, value, modelled });
        }
        if was_guided {
            let (fewest, first, most) = STEPS;
            let is_better = self.known[self.best].value < before;
            self.step = if is_better { (1.5 * self.step).min(most) } else { 0.75 * self.step };
            if self.step < fewest {
                self.step = first;
            }
        }
    }

    /// Moves whole numbers and words of a point to where they count. Returns `None` if the point is known.
    fn new_point(&mut self, point: Vec<f64>) -> Option<Vec<f64>> {
        let point = self.space.snapped(point);
        let key = point.iter().map(|own| own.to_bits()).collect();
        self.keys.insert(key).then_some(point)
    }

    /// Returns the candidate from which the greatest improvement is expected: around the best point with deviation
    /// `step`, or anywhere.
    fn chosen(&mut self, models: &[Option<Surrogate>; 2], step: Option<f64>) -> Vec<f64> {
        let mut best = (f64::NEG_INFINITY, Vec::new());
        let mut order = Vec::new();
        if step.is_none() {
            order = (0..self.known.len()).collect();
            order.sort_by(|a, b| self.known[*a].value.total_cmp(&self.known[*b].value));
            order.truncate((self.known.len() / 10).max(4));
        }
        for place in 0..CANDIDATES {
            let candidate = match step {
                Some(step) => {
                    let own = &self.known[self.best].point;
                    self.space.near(own, step, &mut self.chance)
                }
                None if place % 2 == 0 => {
                    (0..self.space.len()).map(|_| self.chance.part()).collect()
                }
                None => {
                    let own = order[self.chance.below(order.len())];
                    self.space.near(&self.known[own].point, STEPS.2, &mut self.chance)
                }
            };
            let candidate = self.space.snapped(candidate);
            if self.keys.contains(&candidate.iter().map(|own| own.to_bits()).collect::<Vec<_>>()) {
                continue;
            }
            let gain = self.gain(models, &candidate);
            if gain > best.0 || best.1.is_empty() {
                best = (gain, candidate);
            }
        }
        if best.1.is_empty() {
            return self.space.near(&self.known[self.best].point, STEPS.2, &mut self.chance);
        }
        best.1
    }

    /// Returns the logarithm of the expected improvement at a point.
    fn gain(&self, models: &[Option<Surrogate>; 2], point: &[f64]) -> f64 {
        let samples = self.samples();
        let at = |place: usize| {
            let model: Option<&Surrogate> = models[place].as_ref();
            model.map(|model| model.at(point))
        };
        let (spikes, error) = (at(0), at(1));
        let (wanted, bounded, limit) = match self.goal {
            Goal::LeastError(efficiency) => {
                let most = most_spikes(efficiency, samples) as f64;
                (error, spikes, (1.5 + most).ln())
            }
            Goal::MostEfficient(rmse) => (spikes, error, 2.0 * rmse.ln()),
            Goal::Front => (error, spikes, f64::INFINITY),
        };
        let wanted_place = usize::from(!matches!(self.goal, Goal::MostEfficient(_)));
        let bounded = bounded.map_or(0.0, |(mean, deviation)| {
            normal((limit - mean) / deviation).max(1e-300).ln()
        });
        let best = &self.known[self.best];
        let is_allowed = best.value < 1e12;
        let least = best.modelled.map(|own| own[wanted_place]);
        match (wanted, least) {
            (Some((mean, deviation)), Some(least)) if is_allowed => {
                let z = (least - mean) / deviation;
                let density = (-0.5 * z * z).exp() / TAU.sqrt();
                let expected = deviation * (z * normal(z) + density);
                expected.max(1e-300).ln() + bounded
            }
            _ => bounded,
        }
    }

    fn samples(&self) -> usize {
        self.problem.train.iter().map(super::Stretch::samples).sum()
    }

    /// Fits models of spikes and error to the points near the best one, or to all.
    fn models(&mut self, is_near: bool) -> [Option<Surrogate>; 2] {
        let best = &self.known[self.best].point;
        let mut own: Vec<(f64, usize)> = Vec::new();
        for (place, known) in self.known.iter().enumerate() {
            if known.modelled.is_none() {
                continue;
            }
            let distance = if is_near {
                let squares = known.point.iter().zip(best).map(|(a, b)| (a - b).powi(2));
                squares.sum::<f64>()
            } else if place % 2 == 0 {
                // The best points, and some of the others.
                known.value
            } else {
                self.chance.part() * 1e12
            };
            own.push((distance, place));
        }
        own.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        own.truncate(MODELLED);
        let points: Vec<&[f64]> =
            own.iter().map(|(_, place)| &self.known[*place].point[..]).collect();
        let rounds = usize::from(self.round <= 8 || self.round % REFIT == 0);
        let hyper = if is_near { &mut self.near } else { &mut self.far };
        std::array::from_fn(|output| {
            let values: Vec<f64> = own
                .iter()
                .filter_map(|(_, place)| self.known[*place].modelled.map(|own| own[output]))
                .collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            // Outliers would hide the rest.
            let at = |part: f64| sorted[(part * (sorted.len() - 1) as f64) as usize];
            let most = if values.is_empty() { 0.0 } else { 2.0 * at(0.75) - at(0.25) };
            let values: Vec<f64> = values.iter().map(|own| own.min(most)).collect();
            Surrogate::fit(&points, &values, &mut hyper[output], rounds)
        })
    }
}

/// Returns the probability that a normally distributed number of deviation 1 is below `z`, to 2e-4.
fn normal(z: f64) -> f64 {
    1.0 / (1.0 + (-z * (1.5976 + 0.070_565 * z * z)).exp())
}

impl Space {
    /// Moves a point by normally distributed amounts of deviation `step` along about half of the axes. On an axis of
    /// whole numbers or words, the amount is at least one.
    fn near(&self, point: &[f64], step: f64, chance: &mut Chance) -> Vec<f64> {
        let always = chance.below(point.len());
        let moved = self.axes().iter().zip(point).enumerate().map(|(place, (axis, own))| {
            let (is_moved, amount) = (chance.part() < 0.5, step * chance.normal());
            if !is_moved && place != always {
                return *own;
            }
            let is_whole =
                matches!(axis.role, Role::Whole | Role::Most | Role::Words(_) | Role::Shape);
            let one = if is_whole { 1.0 / (axis.high - axis.low).max(1.0) } else { 0.0 };
            (own + amount.signum() * amount.abs().max(one)).clamp(0.0, 1.0)
        });
        moved.collect()
    }

    /// Moves whole numbers and words of a point to the middle of the places that mean the same.
    fn snapped(&self, mut point: Vec<f64>) -> Vec<f64> {
        for (place, (axis, own)) in self.axes().iter().zip(&mut point).enumerate() {
            let number = self.number(place, *own);
            let settled = match axis.role {
                Role::Whole | Role::Most | Role::Words(_) | Role::Shape => number.round(),
                Role::Length => number.exp().round().ln(),
                _ => continue,
            };
            *own = (settled - axis.low) / (axis.high - axis.low).max(f64::MIN_POSITIVE);
        }
        point
    }
}
