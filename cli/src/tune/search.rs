//! The search: exact where a scheme lists its outcomes, by optimisers that ask and are told elsewhere.

use super::problem::{Goal, Problem, Scored, front};
use super::space::Space;
use catalogue::run::{Options, taps};
use fcmaes_core::{Cmaes, CmaesParams, De, DeParams, Fitness, Mode, ModeParams};
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// How long a search may take.
pub(crate) struct Budget<'a> {
    /// Settings to try at most.
    pub evaluations: usize,
    /// When to stop at the latest.
    pub deadline: Instant,
    /// Whether somebody wants it to stop.
    pub is_stopped: &'a (dyn Fn() -> bool + Sync),
    /// Told how many settings were tried, and the best so far.
    pub tick: &'a (dyn Fn(usize, Option<&Scored>) + Sync),
}

/// What a search has found.
pub(crate) struct Found {
    /// The best settings, allowed or not.
    pub best: Option<Scored>,
    /// Those allowed that no other one beats in both spikes and error.
    pub front: Vec<Scored>,
    /// How many settings were scored by the codec.
    pub evaluated: usize,
    /// How many outcomes were compared in exact arithmetic, where the scheme lists them.
    pub listed: usize,
}

/// How a search is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Method {
    pub seed: u64,
    /// The taps of a filter themselves.
    pub free_taps: bool,
}

/// Settings that are tried a generation; a multiple of the cores of most machines.
const GENERATION: i32 = 32;
/// Generations without progress after which a run begins anew.
const PATIENCE: usize = 40;
/// Outcomes that are listed of a combination at most.
const MOST_OUTCOMES: usize = 20_000;
/// Samples passed over to list them all, at most: seconds.
const PASSES: usize = 4_000_000_000;
/// The same for each setting of the budget, so that a small budget is a short search.
const PASSES_A_SETTING: usize = 200_000;
/// Settings that are tried around the best outcome: rounding moves the ends of an interval.
const AROUND: usize = 400;
/// Of the listed outcomes' front, what the codec scores at most.
const MOST_SCORED: usize = 1000;
/// Listed outcomes that are scored by the codec at most, besides their front.
const CONTENDERS: usize = 400;

/// Looks for the best settings.
pub(crate) fn search(problem: &Problem, method: Method, budget: &Budget) -> Found {
    let mut run = Run {
        problem,
        budget,
        found: Found { best: None, front: Vec::new(), evaluated: 0, listed: 0 },
        least: f64::INFINITY,
    };
    let space = Space::new(problem.scheme, &problem.fixed, problem.extent);
    // The paper's settings are a place to start from.
    let mut paper = problem.fixed.clone();
    paper.paper = true;
    run.try_all(&[paper]);
    if !run.exactly(&space) {
        if method.free_taps {
            let half = budget.evaluations / 2;
            run.evolve(&space, method.seed, half);
            run.free(&space, method.seed);
        } else if problem.goal == Goal::Front {
            run.spread(&space, method.seed);
        } else {
            run.evolve(&space, method.seed, budget.evaluations);
        }
    }
    run.found.front = front(run.found.front);
    run.found
}

struct Run<'a> {
    problem: &'a Problem<'a>,
    budget: &'a Budget<'a>,
    found: Found,
    least: f64,
}

impl Run<'_> {
    fn is_over(&self) -> bool {
        self.found.evaluated >= self.budget.evaluations
            || Instant::now() >= self.budget.deadline
            || (self.budget.is_stopped)()
    }

    /// Scores options, and gives a number for each that is the smaller, the better.
    fn try_all(&mut self, all: &[Options]) -> Vec<Option<Scored>> {
        let problem = self.problem;
        let scored: Vec<Option<Scored>> =
            all.par_iter().map(|options| problem.score(options).ok()).collect();
        for own in scored.iter().flatten() {
            let value = problem.value(own);
            if value < self.least {
                self.least = value;
                self.found.best = Some(own.clone());
            }
            if own.is_allowed() || problem.goal != Goal::Front {
                self.found.front.push(own.clone());
            }
        }
        // It is thinned now and then.
        if self.found.front.len() > 4000 {
            self.found.front = front(std::mem::take(&mut self.found.front));
        }
        self.found.evaluated += all.len();
        (self.budget.tick)(self.found.evaluated, self.found.best.as_ref());
        scored
    }

    fn values(&mut self, space: &Space, points: &[Vec<f64>]) -> Vec<f64> {
        /// Of what cannot even be built.
        const NONE: f64 = 1e30;
        let options: Vec<Options> = points.iter().map(|point| space.options(point)).collect();
        let scored = self.try_all(&options);
        let value = |own: &Option<Scored>| own.as_ref().map_or(NONE, |own| self.problem.value(own));
        scored.iter().map(value).collect()
    }

    /// Compares every outcome of the scheme's threshold, for every combination of what is whole. False if the scheme
    /// has no such list, or the user has decided on a part of it.
    fn exactly(&mut self, space: &Space) -> bool {
        let problem = self.problem;
        let decides = ["threshold", "step", "factor", "start"];
        if decides.iter().any(|name| problem.fixed.get(name).is_some()) {
            return false;
        }
        let rounded: Vec<Vec<f64>> =
            problem.train.iter().map(|stretch| stretch.rounded(problem.sample)).collect();
        let stretches: Vec<&[f64]> = rounded.iter().map(Vec::as_slice).collect();
        let samples: usize = stretches.iter().map(|values| values.len()).sum();
        // Each outcome takes a pass over the samples.
        let combinations = space.combinations();
        let passes = self.budget.evaluations.saturating_mul(PASSES_A_SETTING).min(PASSES);
        let most = (passes / samples.max(1) / combinations.len()).clamp(50, MOST_OUTCOMES);
        let threshold = ((problem.extent.max - problem.extent.min) * 0.1).to_string();
        let list = |combination: &Options| -> Option<Vec<(f64, f64, Options)>> {
            if Instant::now() >= self.budget.deadline || (self.budget.is_stopped)() {
                return Some(Vec::new());
            }
            let mut options = combination.or(&problem.fixed);
            options.set("threshold", &threshold);
            let settings =
                problem.settings(&options, problem.sample, problem.train.first()?).ok()?;
            let outcomes = problem.scheme.outcomes(&settings, &stretches, most)?;
            let with = |outcome: &catalogue::run::Outcome| {
                let mut options = combination.or(&problem.fixed);
                options.set("threshold", &outcome.threshold.to_string());
                if outcome.step != outcome.threshold {
                    options.set("step", &outcome.step.to_string());
                }
                (outcome.spikes as f64 / samples as f64, outcome.squares, options)
            };
            Some(outcomes.iter().map(with).collect())
        };
        let lists: Option<Vec<_>> = combinations.par_iter().map(list).collect();
        let Some(lists) = lists else { return false };
        let mut all: Vec<(f64, f64, Options)> = lists.into_iter().flatten().collect();
        self.found.listed = all.len();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut least = f64::INFINITY;
        let (mut chosen, mut rest) = (Vec::new(), Vec::new());
        for (spikes, squares, options) in all {
            if squares < least {
                least = squares;
                chosen.push(options);
            } else {
                rest.push((spikes, squares, options));
            }
        }
        // What rounding puts on the wrong side of a limit, or what keeps to it where the front does not.
        let by_goal = |(spikes, squares, _): &(f64, f64, Options)| match problem.goal {
            Goal::LeastError(efficiency) => (*spikes > 1.0 - efficiency / 100.0, *squares),
            Goal::MostEfficient(rmse) => (*squares > rmse * rmse * samples as f64, *spikes),
            Goal::Front => (false, spikes + squares),
        };
        rest.sort_by(|a, b| {
            let (a, b) = (by_goal(a), by_goal(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        // The front first: a budget that ends has seen the best.
        let stride = chosen.len().div_ceil(MOST_SCORED).max(1);
        let mut order: Vec<Options> = chosen.into_iter().step_by(stride).collect();
        order.extend(rest.into_iter().take(CONTENDERS).map(|(_, _, options)| options));
        for batch in order.chunks(GENERATION as usize * 2) {
            if self.is_over() {
                break;
            }
            self.try_all(batch);
        }
        if let (Some(best), true) = (self.found.best.clone(), problem.goal != Goal::Front) {
            let until = self.found.evaluated + AROUND;
            self.refine(space, &space.point(&best.options), 1e-4, 1, until);
        }
        true
    }

    /// Differential evolution over all that is open, and CMA-ES from where it stands still, again and again.
    fn evolve(&mut self, space: &Space, seed: u64, until: usize) {
        if space.len() == 0 {
            return;
        }
        for round in 0.. {
            let (low, high) = space.bounds();
            let parameters = DeParams {
                // A larger population finds what a smaller one passed by.
                popsize: GENERATION << round.min(3),
                max_evaluations: u64::MAX,
                seed: seed.wrapping_add(round * 7919),
                ..DeParams::default()
            };
            let fitness = Fitness::bounded(space.len(), 1, &low, &high);
            let mut evolution = De::new(fitness, &[], &[], Some(space.whole()), &parameters);
            let (mut since, mut least) = (0, f64::INFINITY);
            let mut own: Option<Vec<f64>> = None;
            while since < PATIENCE && !self.is_over() && self.found.evaluated < until {
                let points = evolution.ask();
                let values = self.values(space, &points);
                since += 1;
                for (point, value) in points.iter().zip(&values) {
                    if *value < least {
                        // Progress that nobody would see is none.
                        if *value < least * (1.0 - 1e-4) {
                            since = 0;
                        }
                        least = *value;
                        own = Some(point.clone());
                    }
                }
                evolution.tell(&values);
            }
            if let Some(point) = own {
                self.refine(space, &point, 0.05, seed.wrapping_add(round), until);
            }
            if self.is_over() || self.found.evaluated >= until {
                return;
            }
        }
    }

    /// CMA-ES around a point, with steps of a part of each range.
    fn refine(&mut self, space: &Space, from: &[f64], part: f64, seed: u64, until: usize) {
        let (low, high) = space.bounds();
        let steps = low.iter().zip(&high).zip(space.whole());
        let steps: Vec<f64> = steps
            .map(|((low, high), is_whole)| {
                let step = (high - low) * part;
                if is_whole { step.max(0.5) } else { step.max(1e-9) }
            })
            .collect();
        let parameters = CmaesParams {
            popsize: GENERATION.min(16),
            max_evaluations: u64::MAX,
            seed,
            ..CmaesParams::default()
        };
        let fitness = Fitness::bounded(space.len(), 1, &low, &high);
        let mut strategy = Cmaes::new(fitness, from, &steps, &parameters);
        let (mut since, mut least) = (0, f64::INFINITY);
        let patience = PATIENCE + 4 * space.len();
        while since < patience && !self.is_over() && self.found.evaluated < until {
            let points = strategy.ask();
            let values = self.values(space, &points);
            since += 1;
            let now = values.iter().copied().fold(f64::INFINITY, f64::min);
            if now < least * (1.0 - 1e-4) {
                since = 0;
            }
            least = least.min(now);
            if strategy.tell(&values) != 0 {
                break;
            }
        }
    }

    /// CMA-ES on the taps of the best filter so far.
    fn free(&mut self, space: &Space, seed: u64) {
        for round in 0.. {
            let Some(best) = self.found.best.clone() else { return };
            let Some(Ok(own)) = best.options.get("filter").map(taps) else { return };
            let free = space.with_taps(&best.options, &own);
            let from = free.point(&best.options);
            let part = [0.03, 0.1, 0.01][round as usize % 3];
            self.refine(&free, &from, part, seed.wrapping_add(round), usize::MAX);
            if self.is_over() {
                return;
            }
        }
    }

    /// The whole front: differential evolution for two goals at once.
    fn spread(&mut self, space: &Space, seed: u64) {
        /// Of what is not allowed.
        const FAR: f64 = 1e6;
        if space.len() == 0 {
            return;
        }
        let (low, high) = space.bounds();
        let parameters = ModeParams { popsize: 2 * GENERATION, seed, ..ModeParams::default() };
        let fitness = Fitness::bounded(space.len(), 2, &low, &high);
        let whole = Some(space.whole());
        let Ok(mut evolution) = Mode::try_new(fitness, 2, 0, whole, &parameters) else { return };
        let range = self.problem.extent.max - self.problem.extent.min;
        while !self.is_over() {
            let points = evolution.ask();
            let options: Vec<Options> = points.iter().map(|point| space.options(point)).collect();
            let scored = self.try_all(&options);
            let goals = |own: &Option<Scored>| match own {
                Some(own) if own.is_allowed() => {
                    let spikes = own.tally.spikes as f64 / own.tally.samples as f64;
                    // As in the picture: the small errors matter as much as the large.
                    vec![(own.tally.rmse() / range).max(1e-9).ln(), spikes]
                }
                Some(own) => {
                    let excess = own.excess.iter().map(|one| one.part).sum::<f64>();
                    vec![FAR * (1.0 + excess); 2]
                }
                None => vec![FAR * FAR; 2],
            };
            let goals: Vec<Vec<f64>> = scored.iter().map(goals).collect();
            evolution.tell(&goals);
        }
    }
}

/// The part of a budget that is one scheme's, of so many that are still to come.
pub(crate) fn share(end: Instant, left: usize) -> Instant {
    let now = Instant::now();
    now + end
        .saturating_duration_since(now)
        .checked_div(left.max(1) as u32)
        .unwrap_or(Duration::ZERO)
}
