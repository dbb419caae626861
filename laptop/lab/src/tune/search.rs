//! Searches for the settings of a scheme. The search is exact if the scheme can list the number of spikes and the error
//! for all thresholds. Otherwise, the search is an evolution.
//!
//! The length of a search is counted in settings scored with the codec, not in seconds. Therefore the result is the
//! same on every machine.

use super::Bound;
use super::bounds::bounds;
use super::evolution::Evolution;
use super::problem::{Goal, Problem, Scored, front};
use super::space::{Inner, Role, Space};
use super::strategy::Strategy;
use catalogue::run::{Asked, LANES, Value};
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// The budget of a search, which ends after a number of settings, at a time, or on request.
pub struct Budget<'a> {
    /// Maximum number of settings to score.
    pub evaluations: usize,
    /// Time at which the search stops. If this limit ends the search, the result depends on the machine's speed.
    pub deadline: Option<Instant>,
    /// Returns whether the user wants the search to stop.
    pub is_stopped: &'a (dyn Fn() -> bool + Sync),
    /// Called after each batch with the number of settings scored so far, and the best of them.
    pub tick: &'a (dyn Fn(usize, Option<&Scored>) + Sync),
}

/// The settings that a search has found.
pub struct Found {
    /// The best settings, even if they break a limit.
    pub best: Option<Scored>,
    /// The Pareto front of the settings within the limits: the settings that no others beat in both spikes and error.
    pub front: Vec<Scored>,
    /// Number of settings that were scored with the codec.
    pub evaluated: usize,
    /// Number of outcomes (spikes and error of a threshold) that were computed in exact arithmetic, without the codec.
    /// Thresholds with the same spikes share an outcome.
    pub listed: usize,
    /// Whether all thresholds were compared in this way: `listed` is then the number of all their outcomes.
    pub is_complete: bool,
    /// Whether the search stopped before its budget of settings was spent, by its deadline or on request.
    pub is_cut_short: bool,
    /// The parameters whose best value lies at a bound of the search, if the scheme allows values beyond this bound.
    pub bounds: Vec<Bound>,
}

/// Options of a search that are not part of the [`Problem`].
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Seed of the random generator.
    pub seed: u64,
    /// Whether the search also varies each tap of a filter by itself, after it has varied the filter's shape, length
    /// and sum.
    pub free_taps: bool,
}

/// Number of settings that are scored before the search checks again whether to stop.
pub(super) const BATCH: usize = 64;
/// Smallest and largest number of parents with which an evolution starts.
const PARENTS: (usize, usize) = (10, 100);
/// Efficiencies in percent: 100 less the number of spikes for every 100 samples. To find a Pareto front, the search
/// seeks the settings with the least error for each of these efficiencies.
const SPREAD: [f64; 8] = [99.0, 97.0, 94.0, 88.0, 78.0, 62.0, 45.0, 0.0];
/// Smallest value to which [`Run::tighten`] reduces a parameter. The parameter limits the number of spikes in a sample.
const ROOM: usize = 16;
/// Rating of invalid settings, for which no codec can be built. The search seeks small ratings, and the ratings of all
/// valid settings are smaller than this one.
const NONE: f64 = 1e30;

/// Searches for the best settings for a problem within a budget.
pub fn search(problem: &Problem, method: Method, budget: &Budget) -> Found {
    let rounded: Vec<Vec<f64>> =
        problem.train.iter().map(|stretch| stretch.rounded(problem.sample)).collect();
    let mut run = Run {
        problem,
        budget,
        rounded: &rounded,
        found: Found {
            best: None,
            front: Vec::new(),
            evaluated: 0,
            listed: 0,
            is_complete: false,
            is_cut_short: false,
            bounds: Vec::new(),
        },
        least: f64::INFINITY,
    };
    let space = Space::new(problem.scheme, &problem.fixed, problem.extent);
    // The search starts from the paper's settings.
    let mut paper = problem.fixed.clone();
    paper.paper = true;
    run.try_all(&[paper]);
    if space.len() > 0 && !run.exactly(&space) {
        // One setting of the budget is left for `tighten`.
        let is_loose = space.axes().iter().any(|axis| axis.role == Role::Most);
        let (seed, all) = (method.seed, budget.evaluations - usize::from(is_loose));
        if method.free_taps {
            run.evolve(&space, problem.goal, seed, all / 2);
            run.free(&space, seed);
        } else if problem.goal == Goal::Front {
            for (place, efficiency) in SPREAD.into_iter().enumerate() {
                let until = all * (place + 1) / SPREAD.len();
                let seed = seed.wrapping_add(place as u64);
                run.evolve(&space, Goal::LeastError(efficiency), seed, until);
            }
        } else {
            run.evolve(&space, problem.goal, seed, all);
        }
    }
    run.tighten(&space);
    if let Some(best) = &run.found.best {
        run.found.bounds = bounds(problem, &space, &best.options);
    }
    run.found.front = front(run.found.front);
    run.found
}

/// A search that is running.
pub(super) struct Run<'a> {
    pub problem: &'a Problem<'a>,
    pub budget: &'a Budget<'a>,
    /// Samples of the stretches (parts of the recording) that are used for tuning, rounded to the sample type.
    pub rounded: &'a [Vec<f64>],
    pub found: Found,
    least: f64,
}

impl Run<'_> {
    pub(super) fn is_over(&mut self) -> bool {
        self.found.evaluated >= self.budget.evaluations || self.is_cut_short()
    }

    pub(super) fn is_cut_short(&mut self) -> bool {
        let is_late = self.budget.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        self.found.is_cut_short |= is_late || (self.budget.is_stopped)();
        self.found.is_cut_short
    }

    /// Scores the first entries of `all`, as many as the budget allows. Records the best settings and those that may be
    /// on the Pareto front. Returns the score of each entry that was tried, or `None` for an invalid entry.
    pub(super) fn try_all(&mut self, all: &[Asked]) -> Vec<Option<Scored>> {
        let problem = self.problem;
        let left = self.budget.evaluations - self.found.evaluated;
        let all = &all[..left.min(all.len())];
        let scored: Vec<Option<Scored>> =
            all.par_iter().map(|options| problem.score(options).ok()).collect();
        for own in scored.iter().flatten() {
            let value = problem.value(problem.goal, own);
            if value < self.least {
                self.least = value;
                self.found.best = Some(own.clone());
            }
            if own.is_allowed() || problem.goal != Goal::Front {
                self.found.front.push(own.clone());
            }
        }
        // Whenever the list grows long, it is reduced to its Pareto front.
        if self.found.front.len() > 4000 {
            self.found.front = front(std::mem::take(&mut self.found.front));
        }
        self.found.evaluated += all.len();
        (self.budget.tick)(self.found.evaluated, self.found.best.as_ref());
        scored
    }

    /// Scores points of a space until the budget is spent. Returns each point with its rating for `goal`. The rating of
    /// a point with invalid settings is [`NONE`].
    fn tried(&mut self, space: &Space, goal: Goal, points: Vec<Vec<f64>>) -> Vec<(Vec<f64>, f64)> {
        let options: Vec<Asked> = points.iter().map(|point| space.options(point)).collect();
        let scored = self.try_all(&options);
        let value = |own: Option<Scored>| own.map_or(NONE, |own| self.problem.value(goal, &own));
        points.into_iter().zip(scored.into_iter().map(value)).collect()
    }

    /// Runs an evolution that searches for settings for `goal`. The evolution ends when the whole search has scored
    /// `until` settings, or when the budget is spent.
    fn evolve(&mut self, space: &Space, goal: Goal, seed: u64, until: usize) {
        let own = until.saturating_sub(self.found.evaluated);
        let before = self.found.evaluated;
        let (fewest, most) = PARENTS;
        // 18 parents for 100 settings, 57 for 1000.
        let count = ((1.8 * (own as f64).sqrt()) as usize).clamp(fewest, most).min(own);
        if count == 0 {
            return;
        }
        let share = match goal {
            Goal::LeastError(efficiency) => 1.0 - efficiency / 100.0,
            Goal::MostEfficient(_) | Goal::Front => 0.5,
        };
        let first = space.starts(seed, count, share);
        // The first points are compared over the whole axis, later ones only near their own value.
        let first = self.swept(space, goal, first, None);
        let parents = self.tried(space, goal, first);
        let mut evolution = Evolution::new(seed, parents);
        while self.found.evaluated < until && !self.is_over() {
            let spent = (self.found.evaluated - before) as f64 / own as f64;
            let mut points = evolution.ask(spent);
            points.truncate(until - self.found.evaluated);
            let width = 0.4 * (1.0 - spent).max(0.1);
            let points = self.swept(space, goal, points, Some(width));
            let values = self.tried(space, goal, points);
            evolution.tell(values);
        }
    }

    /// Moves each point along one axis to the best of several positions. The scheme encodes the signal for all
    /// positions in a single pass. `width` is the length of the searched interval around the point, as a share of the
    /// axis. Without a `width`, the positions span the whole axis. Leaves the points as they are if the scheme cannot
    /// process several values in one pass.
    fn swept(
        &self,
        space: &Space,
        goal: Goal,
        mut points: Vec<Vec<f64>>,
        width: Option<f64>,
    ) -> Vec<Vec<f64>> {
        let problem = self.problem;
        let Some(inner) = space.inner(problem.scheme) else { return points };
        let stretches: Vec<&[f64]> = self.rounded.iter().map(Vec::as_slice).collect();
        let samples: usize = stretches.iter().map(|values| values.len()).sum();
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
                problem.settings(&options, problem.sample, problem.train.first()?).ok()?;
            let number = |place: f64| space.number(axis, place);
            let values = if is_factor {
                places.map(|place| (number(place) - number(own)).exp())
            } else {
                let taps = settings.numbers("taps").ok()?;
                let sum: f64 = taps.iter().map(|tap| tap.abs()).sum();
                places.map(|place| number(place) * sum)
            };
            let found = problem.scheme.swept(&settings, &stretches, &values)?;
            let value =
                |(spikes, squares): (usize, f64)| problem.value_of(goal, spikes, squares, samples);
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

    /// Lowers the parameter that limits the number of spikes in a sample, because a high limit costs time. The new
    /// limit is twice the largest number of spikes in a sample of the signal, but at least [`ROOM`]. Held-out blocks
    /// and other recordings may need more spikes than this signal.
    fn tighten(&mut self, space: &Space) -> Option<()> {
        let axis = space.axes().iter().find(|axis| axis.role == Role::Most)?;
        let problem = self.problem;
        let best = self.found.best.clone()?;
        let mut needed = 0;
        for stretch in problem.train {
            let (events, ..) = problem.run(&best.options, problem.sample, stretch).ok()?;
            let counts = events.chunk_by(|a, b| a.sample == b.sample).map(<[_]>::len);
            needed = needed.max(counts.max().unwrap_or_default());
        }
        let enough = (2 * needed).max(ROOM);
        if enough as f64 >= best.options.number(axis.name)? {
            return None;
        }
        let mut options = best.options;
        options.set(axis.name, enough as u64);
        let [scored] = self.try_all(&[options]).try_into().ok()?;
        self.found.best = scored.or(self.found.best.take());
        Some(())
    }

    /// Improves the taps of the best filter with an evolution strategy. Restarts the strategy from the best filter so
    /// far until the budget is spent.
    fn free(&mut self, space: &Space, seed: u64) {
        /// Number of generations without progress after which the strategy restarts.
        const PATIENCE: usize = 60;
        for round in 0.. {
            let Some(best) = self.found.best.clone() else { return };
            let Some(own) = best.options.get("filter").and_then(Value::numbers) else { return };
            let free = space.with_taps(&best.options, own);
            let step = [0.01, 0.03, 0.003][round as usize % 3];
            let steps = vec![step; free.len()];
            let from = free.point(&best.options);
            let mut strategy = Strategy::new(seed.wrapping_add(round), from, &steps);
            let (mut since, mut least) = (0, self.least);
            while since < PATIENCE {
                if self.is_over() {
                    return;
                }
                let points = strategy.ask();
                let values = self.tried(&free, self.problem.goal, points);
                strategy.tell(values);
                since = if self.least < least * (1.0 - 1e-4) { 0 } else { since + 1 };
                least = self.least;
            }
        }
    }
}

/// Returns the deadline of the next search, if `left` searches share the time until `end`.
pub fn share(end: Option<Instant>, left: usize) -> Option<Instant> {
    let end = end?;
    // In a browser, WebAssembly has no clock to ask, but no deadline is set there either.
    let now = Instant::now();
    let time = end.saturating_duration_since(now).checked_div(left.max(1) as u32);
    Some(now + time.unwrap_or(Duration::ZERO))
}
