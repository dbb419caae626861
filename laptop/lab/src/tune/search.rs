//! Searches for the settings of a scheme. The search is exact if the scheme can list the number of spikes and the error
//! for all thresholds. Otherwise, a model guides it.
//!
//! The length of a search is counted in settings scored with the codec, not in seconds. Therefore the result does not
//! depend on a machine's speed, load or number of cores. It may depend on how a platform rounds logarithms.

use super::Bound;
use super::bounds::bounds;
use super::guided::Guided;
use super::problem::{Goal, Problem, Scored};
use super::space::{Role, Space};
use super::strategy::Strategy;
use catalogue::run::{Asked, Piece, Value};
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
    /// Whether no part of the recordings checks the settings found. Of settings about as good as each other, the search
    /// then takes those whose step doubles, if the code has such a step: without doubling, a steeper flight leaves it
    /// behind.
    pub is_unchecked: bool,
}

/// Number of settings that are scored before the search checks again whether to stop.
pub(super) const BATCH: usize = 64;
/// Efficiencies in percent. To find a Pareto front, settings are searched for each of these efficiencies.
const SPREAD: [f64; 8] = [99.0, 97.0, 94.0, 88.0, 78.0, 62.0, 45.0, 0.0];
/// Smallest value to which [`Run::tighten`] reduces a parameter. The parameter limits the number of spikes in a sample.
const ROOM: usize = 16;
/// Name of the parameter that limits how often the step of an adaptive code doubles.
const DOUBLINGS: &str = "doublings";
/// Rating of invalid settings, for which no codec can be built. The search seeks small ratings, and the ratings of all
/// valid settings are smaller than this one.
const NONE: f64 = 1e30;

/// Searches for the best settings for a problem within a budget.
pub fn search(problem: &Problem, method: Method, budget: &Budget) -> Found {
    let rounded: Vec<Vec<f64>> =
        problem.train.iter().map(|stretch| stretch.rounded(problem.sample)).collect();
    let pieces: Vec<Piece> = rounded
        .iter()
        .zip(problem.train)
        .map(|(values, stretch)| Piece { values, scored: &stretch.scored })
        .collect();
    let mut run = Run {
        problem,
        budget,
        pieces: &pieces,
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
        doubling: None,
    };
    let space = Space::new(problem.scheme, &problem.fixed, problem.extent);
    // The search starts from the paper's settings.
    let mut paper = problem.fixed.clone();
    paper.paper = true;
    run.try_all(&[paper]);
    if space.len() > 0 && !run.exactly(&space, budget.evaluations / 2) {
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
    if method.is_unchecked {
        run.prefer_doubling();
    }
    if let Some(best) = &run.found.best {
        run.found.bounds = bounds(problem, &best.options);
    }
    run.found.front = problem.front(run.found.front);
    run.found
}

/// A search that is running.
pub(super) struct Run<'a> {
    pub problem: &'a Problem<'a>,
    pub budget: &'a Budget<'a>,
    /// The stretches to tune on, rounded to the sample type.
    pub pieces: &'a [Piece<'a>],
    pub found: Found,
    least: f64,
    /// The best settings whose step doubles, with their rating.
    doubling: Option<(f64, Scored)>,
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

    /// Scores options until the budget is spent, and keeps the best and the Pareto front. Returns each score, or `None`
    /// for invalid options.
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
            let is_doubling = own.options.number(DOUBLINGS).is_some_and(|own| own > 0.0);
            if is_doubling && self.doubling.as_ref().is_none_or(|(least, _)| value < *least) {
                self.doubling = Some((value, own.clone()));
            }
            if own.is_allowed() || problem.goal != Goal::Front {
                self.found.front.push(own.clone());
            }
        }
        // Whenever the list grows long, it is reduced to its Pareto front.
        if self.found.front.len() > 4000 {
            self.found.front = problem.front(std::mem::take(&mut self.found.front));
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

    /// Searches for settings for `goal` until the whole search has scored `until` settings, or no new ones are found.
    fn evolve(&mut self, space: &Space, goal: Goal, seed: u64, until: usize) {
        let mut guided = Guided::new(self.problem, space, goal, seed);
        while self.found.evaluated < until && !self.is_over() {
            let points = guided.ask(until - self.found.evaluated);
            if points.is_empty() {
                return;
            }
            let options: Vec<Asked> = points.iter().map(|point| space.options(point)).collect();
            let scored = self.try_all(&options);
            guided.tell(points, &scored);
        }
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
            let scored = stretch.scored_events(&events);
            let counts = scored.flat_map(|own| own.chunk_by(|a, b| a.sample == b.sample));
            needed = needed.max(counts.map(<[_]>::len).max().unwrap_or_default());
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

    /// Takes the best settings whose step doubles in place of settings whose step does not, if these are hardly better.
    fn prefer_doubling(&mut self) {
        /// Factor by which a rating must be smaller to count as better. On another flight, the difference between two
        /// ratings changes by more.
        const HARDLY: f64 = 1.02;
        let best = self.found.best.as_ref().and_then(|own| own.options.number(DOUBLINGS));
        if let Some((value, doubling)) = self.doubling.take()
            && best == Some(0.0)
            && value <= self.least * HARDLY
        {
            self.found.best = Some(doubling);
        }
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

#[cfg(test)]
mod tests {
    use super::super::chance::Chance;
    use super::super::{Goal, Limits, Problem, Scored, Stretch};
    use super::{Budget, Method, search};
    use crate::scheme::Scheme;
    use crate::trial::Recording;
    use crate::tune::space::Space;
    use catalogue::run::{Asked, SampleType};

    /// Draws a signal: a few sines, noise, and a jump.
    fn drawn(chance: &mut Chance) -> Stretch {
        let sines: Vec<(f64, f64)> =
            (0..3).map(|_| (chance.part(), 0.4 * chance.part().powi(2))).collect();
        let (noise, jump, at) = (0.1 * chance.part(), chance.normal(), 100 + chance.below(300));
        let mut value = |place: usize| {
            let sines = sines.iter().map(|(size, pace)| size * (place as f64 * pace).sin());
            sines.sum::<f64>() + noise * chance.normal() + if place > at { jump } else { 0.0 }
        };
        let values = (0..500).map(&mut value).collect();
        Stretch::whole(&Recording::of("x".to_owned(), values, Some(200.0))).remove(0)
    }

    /// Draws schemes and signals. Spikes are limited by the goal or by a limit of the rate. More settings never give a
    /// worse result, and 200 settings give none that is worse than the best of 200 random points.
    #[test]
    fn more_settings_are_never_worse_and_better_than_random_points() {
        let schemes: Vec<Scheme> = Scheme::all().collect();
        for seed in 0..16 {
            let mut chance = Chance::new(seed);
            let scheme = schemes[chance.below(schemes.len())];
            let train = [drawn(&mut chance)];
            let mut limits = Limits::default();
            let asked = Asked::default();
            let known = (Goal::Front, &limits, "M4F");
            let problem = Problem::new(scheme, SampleType::F32, &asked, &train, known);
            let space = Space::new(scheme, &asked, problem.extent);
            let mut points = || {
                let point: Vec<f64> = (0..space.len()).map(|_| chance.part()).collect();
                space.options(&point)
            };
            let points: Vec<Asked> = (0..200).map(|_| points()).collect();
            let tallies: Vec<_> = points.iter().filter_map(|own| problem.score(own).ok()).collect();
            let middle = &tallies[tallies.len() / 2].tally;
            let goal = if seed % 2 == 0 {
                Goal::LeastError(middle.efficiency().min(97.0))
            } else {
                limits.rate = middle.rate().map(|rate| rate.max(6.0));
                Goal::LeastError(-1e9)
            };
            let known = (goal, &limits, "M4F");
            let problem = Problem::new(scheme, SampleType::F32, &asked, &train, known);
            let value = |own: &Scored| problem.value(problem.goal, own);
            let scored = points.iter().filter_map(|own| problem.score(own).ok());
            let random = scored.map(|own| value(&own)).fold(f64::INFINITY, f64::min);
            let mut before = f64::INFINITY;
            for evaluations in [20, 45, 100, 200] {
                let is_stopped = || false;
                let budget = Budget {
                    evaluations,
                    deadline: None,
                    is_stopped: &is_stopped,
                    tick: &|_, _| {},
                };
                let method = Method { seed, free_taps: false, is_unchecked: false };
                let found = search(&problem, method, &budget);
                assert!(found.evaluated <= evaluations);
                let own = value(found.best.as_ref().unwrap());
                assert!(own <= before, "{} {seed}: {own} after {before}", scheme.name());
                before = own;
            }
            assert!(before <= random * 1.01, "{} {seed}: {before}, {random}", scheme.name());
        }
    }
}
