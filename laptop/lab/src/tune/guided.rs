//! A search that a model guides. Of many candidates, the search scores the one from which a model of the points so far
//! promises the largest improvement.
//!
//! Most points lie around a centre, by steps that grow with success and shrink without. A centre is left when its steps
//! have become small. The next centre is by turns a good point elsewhere and the best point so far. No step depends on
//! the budget. Therefore a search with a larger budget scores the settings of a smaller one first, and is never worse.

use super::Stretch;
use super::chance::Chance;
use super::problem::{Goal, Problem, Scored, most_spikes};
use super::space::{Axis, Role, Space};
use super::surrogate::{Hyper, Surrogate};
use std::collections::HashSet;
use std::f64::consts::TAU;

/// Sizes of a batch. An entry applies while fewer points are known than its first number; the second is the number of
/// points scored at once, the third how many of them the models choose. A model takes about a millisecond for a point,
/// and helps most while few points are known.
const TOGETHER: [(usize, usize, usize); 3] = [(300, 4, 3), (1000, 8, 4), (usize::MAX, 16, 2)];
/// Number of candidates of which a model chooses one.
const CANDIDATES: usize = 50;
/// Maximum number of points in a model.
const MODELLED: usize = 60;
/// Number of batches after which the models' parameters are fitted again.
const REFIT: usize = 4;
/// Deviation of points around the centre, as a share of an axis: the smallest, below which the centre is left; the
/// first; the largest.
const STEPS: (f64, f64, f64) = (2e-3, 0.15, 0.3);
/// Distance on an axis, as a share of the axis, within which a point belongs to a centre that was left.
const SAME: f64 = 0.05;
/// Number of points that are drawn in place of one with which no codec can be built, or which breaks a limit.
const REDRAWS: usize = 32;
/// Number of points that are drawn until one is not known already.
const DRAWS: usize = 4;

/// A point that was scored.
struct Known {
    point: Vec<f64>,
    /// Rating of the point's settings. A smaller rating is better.
    value: f64,
    /// The logarithms of the number of spikes and of the mean square error. `None` if the settings are invalid.
    modelled: Option<[f64; 2]>,
}

/// Models of the logarithms of the number of spikes and of the mean square error. A model is `None` if all its points
/// have the same value.
type Models = [Option<Surrogate>; 2];

/// A search that is running.
pub(super) struct Guided<'a> {
    problem: &'a Problem<'a>,
    space: &'a Space,
    goal: Goal,
    chance: Chance,
    /// Starting points that are not scored yet.
    first: Vec<Vec<f64>>,
    known: Vec<Known>,
    /// All settings that `ask` has proposed, as text.
    keys: HashSet<String>,
    /// The least amount by which proposed settings exceed the limits of RAM, instructions and latency.
    excess: f64,
    /// Index in `known` of the best point.
    best: usize,
    /// Index in `known` of the point around which most points are tried.
    centre: usize,
    /// Indices in `known` of the best points, filled at the start of a round.
    good: Vec<usize>,
    /// Former centres.
    left: Vec<usize>,
    step: f64,
    /// Number of batches that were chosen by models.
    round: usize,
    /// Parameters of the models of the points around the centre, and of those anywhere.
    hypers: [[Hyper; 2]; 2],
}

impl<'a> Guided<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, space: &'a Space, goal: Goal, seed: u64) -> Self {
        let share = most(problem, goal).map(|most| most / samples(problem) as f64);
        let hypers = || std::array::from_fn(|_| Hyper::new(space.len()));
        let mut chance = Chance::new(seed);
        let starts = space.starts(seed, 4 + 3 * space.len(), share);
        let drawn = starts.iter().map(|point| sound(problem, space, point, &mut chance));
        let mut first: Vec<Vec<f64>> =
            drawn.filter(|point| is_sound(problem, space, point)).collect();
        if first.is_empty() {
            first = starts;
        }
        Self {
            problem,
            space,
            goal,
            chance,
            first,
            known: Vec::new(),
            keys: HashSet::new(),
            excess: f64::INFINITY,
            best: 0,
            centre: 0,
            good: Vec::new(),
            left: Vec::new(),
            step: STEPS.1,
            round: 0,
            hypers: [hypers(), hypers()],
        }
    }

    /// Returns up to `most` points, whose settings the caller is to score. Returns none if no unknown points are found.
    pub(super) fn ask(&mut self, most: usize) -> Vec<Vec<f64>> {
        let (_, together, guided) = self.together();
        let mut points = Vec::new();
        while points.len() < together
            && let Some(point) = self.first.pop()
        {
            points.extend(self.unknown(point));
        }
        // If no starting point can be scored, others are drawn.
        for _ in 0..together {
            if points.is_empty() && self.known.is_empty() {
                let point = self.space.drawn(&mut self.chance);
                points.extend(self.unknown(point));
            }
        }
        if points.is_empty() && !self.known.is_empty() {
            self.round += 1;
            self.good = self.best_points();
            let near = self.models(true);
            let far = self.models(false);
            for slot in 0..together {
                let step = self.step * [1.0, 0.3, 0.3, 0.1][self.chance.below(4)];
                let drawn = match slot {
                    // The last of the guided points lies anywhere.
                    _ if slot + 1 == guided => self.ranked(&far, None),
                    _ if slot < guided => self.ranked(&near, Some(step)),
                    _ if self.round.is_multiple_of(2) => {
                        (0..DRAWS).map(|_| self.near(self.centre, step)).collect()
                    }
                    _ => (0..DRAWS).map(|_| self.mixed()).collect(),
                };
                points.extend(drawn.into_iter().find_map(|point| self.unknown(point)));
            }
        }
        points.truncate(most);
        points
    }

    /// Takes the scores of the points that `ask` returned, in the same order. A score is `None` if the settings are
    /// invalid.
    pub(super) fn tell(&mut self, points: Vec<Vec<f64>>, scored: &[Option<Scored>]) {
        let (before, count) = (self.centre, points.len());
        for (point, own) in points.into_iter().zip(scored) {
            let value = own.as_ref().map(|own| self.problem.value(self.goal, own));
            let value = value.filter(|own| !own.is_nan()).unwrap_or(f64::INFINITY);
            let modelled = own.as_ref().map(|own| {
                let square = self.problem.mean_square(&own.tally).max(f64::MIN_POSITIVE);
                [(1.0 + own.tally.spikes as f64).ln(), square.ln()]
            });
            self.known.push(Known { point, value, modelled });
            let last = self.known.len() - 1;
            if value < self.known[self.best].value {
                self.best = last;
            }
            let is_near = self.distance(last, self.centre) < STEPS.2;
            let is_better = value < self.known[self.centre].value;
            if is_better && (is_near || self.best == last || self.round == 0) {
                self.centre = last;
            }
        }
        if self.round > 0 {
            let (least, first, most) = STEPS;
            let is_better = self.centre != before;
            let factor = if is_better { 1.5 } else { 0.75_f64.powf(count as f64 / 4.0) };
            self.step = (factor * self.step).min(most);
            if self.step < least {
                self.step = first;
                self.left.push(self.centre);
                self.centre = self.next_centre();
            }
        }
    }

    fn together(&self) -> (usize, usize, usize) {
        let [.., last] = TOGETHER;
        TOGETHER.into_iter().find(|(end, ..)| self.known.len() < *end).unwrap_or(last)
    }

    /// Returns the largest distance on an axis between two known points.
    fn distance(&self, a: usize, b: usize) -> f64 {
        let pairs = self.known[a].point.iter().zip(&self.known[b].point);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    fn next_centre(&self) -> usize {
        let is_new = |own: &usize| self.left.iter().all(|left| self.distance(*left, *own) > SAME);
        let elsewhere = (0..self.known.len()).filter(is_new);
        let value = |own: &usize| self.known[*own].value;
        match elsewhere.min_by(|a, b| value(a).total_cmp(&value(b))) {
            Some(own) if self.left.len() % 2 == 1 => own,
            _ => self.best,
        }
    }

    /// Moves whole numbers and words of a point to the exact value that they stand for. Returns `None` if no codec can
    /// be built, if the settings were proposed before, or if they exceed a limit by more than earlier ones; otherwise
    /// remembers and returns the point. Points that differ only in parameters without effect are the same settings.
    fn unknown(&mut self, point: Vec<f64>) -> Option<Vec<f64>> {
        let point = self.space.settled(point);
        let (settings, excess) = self.problem.unscored(&self.space.options(&point))?;
        if excess > self.excess || !self.keys.insert(format!("{:?}", settings.entries())) {
            return None;
        }
        self.excess = excess;
        Some(point)
    }

    fn near(&mut self, from: usize, step: f64) -> Vec<f64> {
        self.space.near(&self.known[from].point, step, &mut self.chance)
    }

    /// Returns candidates around the centre, with the deviation `step`, or anywhere if there is no `step`. The candidate
    /// that promises the largest improvement is the first.
    fn ranked(&mut self, models: &Models, step: Option<f64>) -> Vec<Vec<f64>> {
        let gain = self.gain(models, if step.is_some() { self.centre } else { self.best });
        let mut candidates: Vec<(f64, Vec<f64>)> = Vec::new();
        for place in 0..CANDIDATES {
            let point = match (step, place % 3) {
                (Some(step), _) => self.near(self.centre, step),
                (None, 0) => self.anywhere(),
                (None, 1) => {
                    let good = self.good();
                    self.near(good, STEPS.2)
                }
                (None, _) => self.mixed(),
            };
            let point = self.space.settled(point);
            candidates.push((gain(&point), point));
        }
        candidates.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        candidates.into_iter().map(|(_, point)| point).collect()
    }

    /// Returns the indices of the best known points: the best eighth, or the best 8 if these are more.
    fn best_points(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.known.len()).collect();
        let count = (order.len() / 8).max(8).min(order.len());
        let value = |own: usize| self.known[own].value;
        order.sort_unstable_by(|a, b| value(*a).total_cmp(&value(*b)).then(a.cmp(b)));
        order.truncate(count);
        order
    }

    /// Draws the index of one of the best known points.
    fn good(&mut self) -> usize {
        self.good[self.chance.below(self.good.len())]
    }

    /// Draws a point anywhere.
    fn anywhere(&mut self) -> Vec<f64> {
        let point = self.space.drawn(&mut self.chance);
        sound(self.problem, self.space, &point, &mut self.chance)
    }

    /// Draws a point as differential evolution does: a good point, moved half the way to the best and by half the
    /// difference of two other good points, with a small random step added.
    fn mixed(&mut self) -> Vec<f64> {
        let [own, a, b] = std::array::from_fn(|_| self.good());
        let at = |place: usize, axis: usize| self.known[place].point[axis];
        let moved = |axis| {
            let towards = at(self.best, axis) - at(own, axis);
            at(own, axis) + 0.5 * towards + 0.5 * (at(a, axis) - at(b, axis))
        };
        let point: Vec<f64> =
            (0..self.space.len()).map(moved).map(|own: f64| own.clamp(0.0, 1.0)).collect();
        self.space.near(&point, 0.03, &mut self.chance)
    }

    /// Returns a function that rates a point by a logarithm: of the expected improvement over the known point `from`,
    /// times the probability that the point meets the goal's limit. If `from` breaks this limit, of this probability alone.
    fn gain<'b>(&self, models: &'b Models, from: usize) -> impl Fn(&[f64]) -> f64 + use<'b> {
        const LEAST: f64 = 1e-300;
        let (wanted, limited, limit) = self.outputs();
        let from = &self.known[from];
        let is_within = from.modelled.is_some_and(|own| own[limited] <= limit);
        let (wanted, limited) = (&models[wanted], &models[limited]);
        let wanted = wanted.as_ref().filter(|_| is_within);
        // Compared with the model's value at `from`, as the scored value may be a lucky one.
        let wanted = wanted.map(|model| (model, model.at(&from.point).0));
        move |point| {
            let limited = limited.as_ref().map_or(0.0, |model| {
                let (mean, deviation) = model.at(point);
                normal((limit - mean) / deviation).max(LEAST).ln()
            });
            wanted.map_or(limited, |(model, least)| {
                let (mean, deviation) = model.at(point);
                let z = (least - mean) / deviation;
                let density = (-0.5 * z * z).exp() / TAU.sqrt();
                (deviation * (z * normal(z) + density)).max(LEAST).ln() + limited
            })
        }
    }

    /// Returns the index in [`Models`] of the quantity to minimise, the index of the quantity that is limited, and the
    /// logarithm of this limit. Spikes are limited by the goal and by a limit of the rate.
    fn outputs(&self) -> (usize, usize, f64) {
        let most = most(self.problem, self.goal);
        match self.goal {
            Goal::MostEfficient(rmse) => (0, 1, 2.0 * rmse.ln()),
            _ => (1, 0, most.map_or(f64::INFINITY, |most| (1.5 + most).ln())),
        }
    }

    /// Fits models to the points nearest to the centre or, if not `is_near`, to the best points and as many others.
    fn models(&mut self, is_near: bool) -> Models {
        let mut order: Vec<(f64, usize)> = Vec::new();
        for (place, known) in self.known.iter().enumerate() {
            let rank = if is_near {
                let pairs = known.point.iter().zip(&self.known[self.centre].point);
                pairs.map(|(a, b)| (a - b).powi(2)).sum()
            } else {
                known.value
            };
            order.extend(known.modelled.map(|_| (rank, place)));
        }
        order.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        if !is_near {
            for place in MODELLED / 2..MODELLED.min(order.len()) {
                let other = place + self.chance.below(order.len() - place);
                order.swap(place, other);
            }
        }
        order.truncate(MODELLED);
        let known: Vec<&Known> = order.iter().map(|(_, place)| &self.known[*place]).collect();
        let points: Vec<&[f64]> = known.iter().map(|own| &own.point[..]).collect();
        let is_fitted = self.round <= 2 * REFIT || self.round.is_multiple_of(REFIT);
        let (_, limited, limit) = self.outputs();
        let hypers = &mut self.hypers[usize::from(is_near)];
        std::array::from_fn(|output| {
            let values = known.iter().filter_map(|own| own.modelled.map(|own| own[output]));
            let mut values: Vec<f64> = values.collect();
            if output != limited {
                limit_outliers(&mut values);
            } else if limit.is_finite() {
                // Only near the limit do differences matter.
                for own in &mut values {
                    *own = own.clamp(limit - 1.0, limit + 1.0);
                }
            }
            Surrogate::fit(&points, &values, &mut hypers[output], is_fitted)
        })
    }
}

fn samples(problem: &Problem) -> usize {
    problem.train.iter().map(Stretch::samples).sum()
}

/// Returns the largest number of spikes that the goal and a limit of the rate allow; `None` if the goal limits the error.
fn most(problem: &Problem, goal: Goal) -> Option<f64> {
    let Goal::LeastError(efficiency) = goal else { return None };
    let seconds = problem.train.iter().map(Stretch::seconds).sum::<Option<f64>>();
    let by_rate = problem.limits.rate.zip(seconds).map(|(rate, own)| rate * own);
    let most = most_spikes(efficiency, samples(problem)) as f64;
    Some(most.min(by_rate.unwrap_or(f64::INFINITY).floor()))
}

/// Lowers outliers to the upper quartile plus the distance between the quartiles, because they would hide how the other
/// values differ.
fn limit_outliers(values: &mut [f64]) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quarter = sorted.len() / 4;
    let (Some(low), Some(high)) = (sorted.get(quarter), sorted.iter().rev().nth(quarter)) else {
        return;
    };
    let most = 2.0 * high - low;
    for own in values {
        *own = own.min(most);
    }
}

/// Returns whether a codec can be built from a point, and keeps to the limits of RAM, instructions and latency.
fn is_sound(problem: &Problem, space: &Space, point: &[f64]) -> bool {
    let known = problem.unscored(&space.options(&space.settled(point.to_vec())));
    known.is_some_and(|(_, excess)| excess == 0.0)
}

/// Returns the point if it is sound, or else a drawn one that is sound; the last one drawn if none of [`REDRAWS`] is. The
/// first half of the draws keep whole numbers and words. Otherwise those that fit few other numbers would hardly be drawn.
fn sound(problem: &Problem, space: &Space, point: &[f64], chance: &mut Chance) -> Vec<f64> {
    let mut own = point.to_vec();
    for draw in 0..REDRAWS {
        if is_sound(problem, space, &own) {
            break;
        }
        let drawn = space.drawn(chance);
        let axes = space.axes().iter().zip(point).zip(drawn);
        let kept = |((axis, old), new): ((&Axis, &f64), f64)| {
            if draw < REDRAWS / 2 && is_whole(axis.role) { *old } else { new }
        };
        own = axes.map(kept).collect();
    }
    own
}

/// Returns the standard normal distribution function at `z`, with an absolute error below 2e-4.
fn normal(z: f64) -> f64 {
    1.0 / (1.0 + (-z * (1.5976 + 0.070_565 * z * z)).exp())
}

impl Space {
    /// Draws a point. The ends of whole numbers, words and shapes are drawn more often than what lies between, as many
    /// numbers are best there.
    fn drawn(&self, chance: &mut Chance) -> Vec<f64> {
        let place = |axis: &Axis| match chance.part() {
            part if is_whole(axis.role) => (1.4 * part - 0.2).clamp(0.0, 1.0),
            part => part,
        };
        self.axes().iter().map(place).collect()
    }

    /// Moves a point by normally distributed amounts of deviation `step` along about half of the axes. On an axis of
    /// whole numbers or words, the amount is at least one.
    fn near(&self, point: &[f64], step: f64, chance: &mut Chance) -> Vec<f64> {
        let always = chance.below(point.len());
        let moved = self.axes().iter().zip(point).enumerate().map(|(place, (axis, own))| {
            let (is_moved, amount) = (chance.part() < 0.5, step * chance.normal());
            if !is_moved && place != always {
                return *own;
            }
            let one = if is_whole(axis.role) { 1.0 / (axis.high - axis.low).max(1.0) } else { 0.0 };
            (own + amount.signum() * amount.abs().max(one)).clamp(0.0, 1.0)
        });
        moved.collect()
    }

    /// Moves whole numbers and words of a point to the exact value that they stand for, and sums and fields beyond the
    /// bounds of their parameter to these bounds.
    fn settled(&self, mut point: Vec<f64>) -> Vec<f64> {
        let numbers = point.iter().enumerate().map(|(place, own)| self.number(place, *own));
        let numbers: Vec<f64> = numbers.collect();
        let rounded = self.axes().iter().zip(&numbers).map(|(axis, number)| match axis.role {
            role if is_whole(role) => number.round(),
            Role::Length => number.exp().round().ln(),
            _ => *number,
        });
        let settled = self.clamped(rounded.collect());
        for (place, (axis, own)) in self.axes().iter().zip(&mut point).enumerate() {
            // The others keep every digit.
            if (settled[place] - numbers[place]).abs() > 0.0 {
                *own = axis.place(settled[place]);
            }
        }
        point
    }
}

fn is_whole(role: Role) -> bool {
    matches!(role, Role::Whole | Role::Most | Role::Words(_) | Role::Shape)
}

#[cfg(test)]
mod tests {
    use super::super::{Goal, Limits, Problem, Stretch};
    use super::{Chance, Guided, Space};
    use crate::scheme::Scheme;
    use crate::trial::Recording;
    use catalogue::run::{Asked, SampleType};
    use std::collections::HashSet;

    /// Limits the latency such that at least half of drawn points keep to it. With all settings that a search proposes a codec can
    /// be built, none are proposed twice, and all keep to the limit.
    #[test]
    fn proposed_settings_are_new_and_keep_to_the_limit() {
        let values = (0..300).map(|place| (f64::from(place) * 0.2).sin()).collect();
        let train = Stretch::whole(&Recording::of("x".to_owned(), values, None));
        let (asked, mut chance) = (Asked::default(), Chance::new(1));
        for scheme in Scheme::all() {
            let (goal, mut limits) = (Goal::LeastError(0.0), Limits::default());
            let known = (goal, &limits, "M4F");
            let free = Problem::new(scheme, SampleType::F32, &asked, &train, known);
            let space = Space::new(scheme, &asked, free.extent);
            if space.len() == 0 {
                continue;
            }
            let drawn = (0..40).map(|_| space.options(&space.drawn(&mut chance)));
            let scored = drawn.filter_map(|options| free.score(&options).ok());
            let mut latencies: Vec<usize> = scored.map(|own| own.costs.latency).collect();
            latencies.sort_unstable();
            limits.latency = Some(latencies[latencies.len() / 2] as f64);
            let known = (goal, &limits, "M4F");
            let problem = Problem::new(scheme, SampleType::F32, &asked, &train, known);
            let mut guided = Guided::new(&problem, &space, goal, 1);
            let mut known = HashSet::new();
            for _ in 0..15 {
                let points = guided.ask(100);
                let options: Vec<Asked> = points.iter().map(|own| space.options(own)).collect();
                for own in &options {
                    let (settings, excess) = problem.unscored(own).unwrap();
                    assert!(excess == 0.0, "{} {own:?}: {excess}", scheme.name());
                    let is_new = known.insert(format!("{:?}", settings.entries()));
                    assert!(is_new, "{} {own:?}", scheme.name());
                }
                let scored: Vec<_> = options.iter().map(|own| problem.score(own).ok()).collect();
                guided.tell(points, &scored);
            }
            assert!(!known.is_empty(), "{}", scheme.name());
        }
    }
}
