//! Searches on a part of the signal, the screen, to choose the settings that are worth scoring on all of it.
//!
//! A long recording is represented by short windows, so that many settings are compared in the time that one takes on
//! the whole recording. A short recording is its own screen.

use super::chance::Chance;
use super::evolution::Evolution;
use super::problem::{Goal, Problem, Scored};
use super::space::{Inner, Role, Space};
use super::{Stretch, Tally};
use catalogue::run::{LANES, Piece};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;

/// Largest number of scored samples that are their own screen, and the number of samples in all windows of a screen.
const SAMPLES: usize = 4096;
/// Number of windows that represent a longer recording.
const WINDOWS: usize = 8;
/// Number of points that are tried on the screen for each one that is scored afterwards.
const TRIES: usize = 8;
/// Number of points above which a round tries no more than it scores.
const MOST_TRIED: usize = 4000;
/// The same for a scheme that compares [`LANES`] values of one parameter for each point.
const MOST_SWEPT: usize = 400;
/// Smallest and largest number of parents with which an evolution starts.
const PARENTS: (usize, usize) = (8, 100);
/// Share of an evolution's parents that are the best points of the rounds before.
const INHERITED: f64 = 0.3;
/// Share of a round's points that are tried around the best one.
const LOCAL: f64 = 0.35;
/// Number of points around the best one that are tried at once.
const AROUND: usize = 6;
/// Number of generations without a new point after which a phase ends, because it only repeats itself.
const PATIENCE: usize = 20;
/// Value of settings that cannot be built. It is worse than the value of any other settings.
const NONE: f64 = 1e30;

/// A point that was tried on the screen.
struct Tried {
    point: Vec<f64>,
    /// Score on the screen. `None` if the settings cannot be built.
    scored: Option<Scored>,
    is_scored: bool,
}

/// The points of a space that were tried on the screen, for one goal.
pub(super) struct Screen<'a> {
    problem: &'a Problem<'a>,
    space: &'a Space,
    goal: Goal,
    /// The stretches of the screen.
    stretches: Cow<'a, [Stretch]>,
    /// The stretches' samples, rounded to the sample type.
    rounded: Vec<Vec<f64>>,
    /// The goal on the screen: the best settings so far are as far from it there as they are from the goal on all
    /// stretches.
    own_goal: Goal,
    best: Option<(f64, Scored)>,
    tried: Vec<Tried>,
    /// Index in `tried` by the point's settings.
    known: HashMap<Vec<u64>, usize>,
}

impl<'a> Screen<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, space: &'a Space, goal: Goal) -> Self {
        let stretches = match windows(problem.train) {
            Some(windows) => Cow::Owned(windows),
            None => Cow::Borrowed(problem.train),
        };
        let rounded = stretches.iter().map(|own| own.rounded(problem.sample)).collect();
        let (own_goal, best, tried, known) = (goal, None, Vec::new(), HashMap::new());
        Self { problem, space, goal, stretches, rounded, own_goal, best, tried, known }
    }

    /// Searches on the screen, and returns at most `count` points to score, the best first. No point is returned twice.
    pub(super) fn round(
        &mut self,
        seed: u64,
        count: usize,
        is_late: &dyn Fn() -> bool,
    ) -> Vec<Vec<f64>> {
        let most = match self.space.inner(self.problem.scheme) {
            Some(_) => MOST_SWEPT,
            None => MOST_TRIED,
        };
        let tries = (TRIES * count).min(most.max(count));
        let end = self.tried.len() + tries;
        let local = end - (tries as f64 * LOCAL) as usize;
        self.evolve(seed, local, is_late);
        self.around_best(seed, end, is_late);
        let values = self.values();
        let mut order: Vec<usize> =
            (0..values.len()).filter(|place| !self.tried[*place].is_scored).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        order.truncate(count);
        for place in &order {
            self.tried[*place].is_scored = true;
        }
        order.into_iter().map(|place| self.tried[place].point.clone()).collect()
    }

    /// Returns whether the screen is only a part of the stretches.
    pub(super) fn is_part(&self) -> bool {
        matches!(self.stretches, Cow::Owned(_))
    }

    /// Takes settings that were scored on all stretches, and moves the goal on the screen accordingly.
    pub(super) fn compare<'b>(&mut self, scored: impl Iterator<Item = &'b Scored>) {
        if !self.is_part() {
            return;
        }
        for own in scored.filter(|own| own.is_allowed()) {
            let value = self.problem.value(self.goal, own);
            if self.best.as_ref().is_none_or(|(least, _)| value < *least) {
                self.best = Some((value, own.clone()));
            }
        }
        let Some((_, best)) = &self.best else { return };
        let here = self.problem.tally(&best.options, self.problem.sample, &self.stretches);
        let Ok((here, _)) = here else { return };
        let part = |tally: &Tally| tally.spikes as f64 / tally.samples as f64;
        let ratio = |here: f64, all: f64| if here > 0.0 && all > 0.0 { here / all } else { 1.0 };
        self.own_goal = match self.goal {
            Goal::LeastError(efficiency) => {
                let allowed = (100.0 - efficiency) * ratio(part(&here), part(&best.tally));
                Goal::LeastError(100.0 - allowed)
            }
            Goal::MostEfficient(rmse) => {
                Goal::MostEfficient(rmse * ratio(here.rmse(), best.tally.rmse()))
            }
            Goal::Front => Goal::Front,
        };
    }

    fn value(&self, scored: Option<&Scored>) -> f64 {
        scored.map_or(NONE, |own| self.problem.value(self.own_goal, own))
    }

    fn values(&self) -> Vec<f64> {
        self.tried.iter().map(|own| self.value(own.scored.as_ref())).collect()
    }

    /// Returns the best `count` points so far, with their values.
    fn best(&self, count: usize) -> Vec<(Vec<f64>, f64)> {
        let values = self.values();
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        order
            .into_iter()
            .take(count)
            .map(|own| (self.tried[own].point.clone(), values[own]))
            .collect()
    }

    /// Scores points on the screen, and returns them with their values. Points whose settings are known are not scored
    /// again.
    fn tried(&mut self, points: Vec<Vec<f64>>) -> Vec<(Vec<f64>, f64)> {
        let mut new: Vec<Vec<f64>> = Vec::new();
        let keys: Vec<Vec<u64>> = points.iter().map(|point| self.space.key(point)).collect();
        for (point, key) in points.iter().zip(&keys) {
            let next = self.tried.len() + new.len();
            self.known.entry(key.clone()).or_insert_with(|| {
                new.push(point.clone());
                next
            });
        }
        let (problem, space, stretches) = (self.problem, self.space, &self.stretches);
        let scored: Vec<Option<Scored>> = new
            .par_iter()
            .map(|point| problem.score_on(&space.options(point), stretches).ok())
            .collect();
        let scored = new.into_iter().zip(scored);
        self.tried.extend(scored.map(|(point, scored)| Tried { point, scored, is_scored: false }));
        let value = |key: &Vec<u64>| self.known.get(key).and_then(|place| self.tried.get(*place));
        let values =
            keys.iter().map(|key| self.value(value(key).and_then(|own| own.scored.as_ref())));
        points.into_iter().zip(values).collect()
    }

    /// Evolves points until `until` points have been tried.
    fn evolve(&mut self, seed: u64, until: usize, is_late: &dyn Fn() -> bool) {
        let (fewest, most) = PARENTS;
        let start = self.tried.len();
        let tries = until.saturating_sub(start);
        let count = ((1.8 * (tries as f64).sqrt()) as usize).clamp(fewest, most);
        let share = match self.goal {
            Goal::LeastError(efficiency) => 1.0 - efficiency / 100.0,
            Goal::MostEfficient(_) | Goal::Front => 0.5,
        };
        let mut parents = self.best((count as f64 * INHERITED) as usize);
        let first = self.space.starts(seed, count - parents.len(), share);
        // The first points are compared over the whole axis, later ones only near their own value.
        let first = self.swept(first, None);
        parents.extend(self.tried(first));
        let mut evolution = Evolution::new(seed, parents);
        let mut idle = 0;
        while self.tried.len() < until && idle < PATIENCE && !is_late() {
            let before = self.tried.len();
            let spent = (before - start) as f64 / tries as f64;
            let mut points = evolution.ask(spent);
            points.truncate(until - before);
            let width = 0.4 * (1.0 - spent).max(0.1);
            let points = self.swept(points, Some(width));
            let values = self.tried(points);
            evolution.tell(values);
            idle = if self.tried.len() == before { idle + 1 } else { 0 };
        }
    }

    /// Tries points around the best one until `until` points have been tried.
    fn around_best(&mut self, seed: u64, until: usize, is_late: &dyn Fn() -> bool) {
        let Some(best) = self.best(1).pop() else { return };
        let mut around = Around::new(seed, best);
        let mut idle = 0;
        while self.tried.len() < until && idle < PATIENCE && !is_late() {
            let before = self.tried.len();
            let points = around.ask(self.space, until - before);
            let points = self.swept(points, Some(0.1 * around.step.min(Around::FIRST)));
            let values = self.tried(points);
            around.tell(values);
            idle = if self.tried.len() == before { idle + 1 } else { 0 };
        }
    }

    /// Moves each point along one axis to the best of several positions, which the scheme compares in a single pass
    /// over the screen. The positions span the whole axis, or the share `width` of the axis around the point. Leaves
    /// the points as they are if the scheme cannot compare values in this way.
    fn swept(&self, mut points: Vec<Vec<f64>>, width: Option<f64>) -> Vec<Vec<f64>> {
        let (problem, space) = (self.problem, self.space);
        let Some(inner) = space.inner(problem.scheme) else { return points };
        let pieces: Vec<Piece> = self
            .rounded
            .iter()
            .zip(self.stretches.iter())
            .map(|(values, own)| Piece { values, scored: &own.scored })
            .collect();
        let samples: usize = self.stretches.iter().map(Stretch::samples).sum();
        let best = |point: &mut Vec<f64>| -> Option<()> {
            let Inner { axis, is_factor } = inner;
            let own = point[axis];
            let places: [f64; LANES] = std::array::from_fn(|lane| match width {
                None => (lane as f64 + 0.5) / LANES as f64,
                Some(_) if lane == 0 => own,
                Some(width) => {
                    let off = (lane as f64 - 7.5) / 7.5;
                    (own + 0.5 * width * off * off.abs()).clamp(0.0, 1.0)
                }
            });
            let options = space.options(point);
            let settings =
                problem.settings(&options, problem.sample, self.stretches.first()?).ok()?;
            let number = |place: f64| space.number(axis, place);
            let values = if is_factor {
                places.map(|place| (number(place) - number(own)).exp())
            } else {
                let taps = settings.numbers("taps").ok()?;
                let sum: f64 = taps.iter().map(|tap| tap.abs()).sum();
                places.map(|place| number(place) * sum)
            };
            let found = problem.scheme.swept(&settings, &pieces, &values)?;
            let value = |(spikes, squares): (usize, f64)| {
                problem.value_of(self.own_goal, spikes, squares, samples)
            };
            let all = places.into_iter().zip(found);
            let (place, _) = all.min_by(|(_, a), (_, b)| value(*a).total_cmp(&value(*b)))?;
            point[axis] = place;
            Some(())
        };
        points.par_iter_mut().for_each(|point| {
            best(point);
        });
        points
    }
}

/// A search around the best point so far. Some axes are changed at a time, by normally distributed amounts at three
/// scales, which grow or shrink with success.
pub(super) struct Around {
    chance: Chance,
    /// The best point, with its value.
    pub(super) best: (Vec<f64>, f64),
    step: f64,
    /// Deviation of the amounts by which each point that `ask` returned last was moved.
    asked: Vec<f64>,
}

impl Around {
    /// Deviation at the start, as a share of an axis.
    const FIRST: f64 = 0.1;
    /// Smallest and largest deviation.
    const STEPS: (f64, f64) = (1e-3, 0.3);

    /// Starts at the point `best`, with its value.
    pub(super) fn new(seed: u64, best: (Vec<f64>, f64)) -> Self {
        Self { chance: Chance::new(!seed), best, step: Self::FIRST, asked: Vec::new() }
    }

    /// Returns up to `most` points, whose values the caller is to compute.
    pub(super) fn ask(&mut self, space: &Space, most: usize) -> Vec<Vec<f64>> {
        const SCALES: [f64; 3] = [1.0, 0.4, 0.15];
        let step = |place: usize| self.step * SCALES[place % SCALES.len()];
        self.asked = (0..AROUND.min(most)).map(step).collect();
        self.asked.iter().map(|step| space.near(&self.best.0, *step, &mut self.chance)).collect()
    }

    /// Takes the values of the points that `ask` returned.
    pub(super) fn tell(&mut self, points: Vec<(Vec<f64>, f64)>) {
        let (fewest, most) = Self::STEPS;
        let found = points.into_iter().zip(&self.asked);
        match found.min_by(|((_, a), _), ((_, b), _)| a.total_cmp(b)) {
            Some((found, step)) if found.1 < self.best.1 => {
                (self.best, self.step) = (found, (2.0 * step).clamp(fewest, most));
            }
            _ if self.step > fewest => self.step *= 0.6,
            _ => self.step = Self::FIRST,
        }
    }
}

/// Returns windows that represent stretches, spread evenly over their scored samples. Returns
/// `None` if the stretches are short enough to be scored themselves.
fn windows(train: &[Stretch]) -> Option<Vec<Stretch>> {
    let samples: usize = train.iter().map(Stretch::samples).sum();
    if samples <= SAMPLES {
        return None;
    }
    let middles = (0..WINDOWS).map(|window| (2 * window + 1) * samples / (2 * WINDOWS));
    let window = |mut middle: usize| {
        for stretch in train {
            for range in &stretch.scored {
                if middle < range.len() {
                    return stretch.window(range.start + middle, SAMPLES / WINDOWS);
                }
                middle -= range.len();
            }
        }
        None
    };
    Some(middles.filter_map(window).collect())
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

    /// Returns a key that is equal for points with equal settings.
    fn key(&self, point: &[f64]) -> Vec<u64> {
        let number = |(place, axis): (usize, &super::space::Axis)| {
            let number = self.number(place, point[place]);
            let settled = match axis.role {
                Role::Whole | Role::Most | Role::Words(_) | Role::Shape => number.round(),
                Role::Length => number.exp().round(),
                _ => number,
            };
            settled.to_bits()
        };
        self.axes().iter().enumerate().map(number).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{SAMPLES, Stretch, windows};

    /// The windows hold scored samples only, although unscored ones lie between them.
    #[test]
    fn windows_represent_what_is_scored() {
        let scored: Vec<_> = (0..20).map(|block| block * 1000..block * 1000 + 700).collect();
        let values = (0..20_000).map(f64::from).collect();
        let train = [Stretch { values, rate: None, scored, flight: 3 }];
        let found = windows(&train).unwrap();
        let samples: usize = found.iter().map(Stretch::samples).sum();
        assert!((SAMPLES / 2..=SAMPLES).contains(&samples), "{samples}");
        for value in found.iter().flat_map(Stretch::scored_values).flatten() {
            assert!(*value % 1000.0 < 700.0, "{value}");
        }
        assert!(found.iter().all(|own| own.flight == 3) && found.len() == 8);
        let short = [Stretch { scored: vec![0..SAMPLES], ..train[0].clone() }];
        assert!(windows(&short).is_none());
    }
}
