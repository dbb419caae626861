//! Tunes step codes. In a step code, each spike moves the decoded value up or down by a step. The number of spikes and
//! the error at each threshold are first computed in exact arithmetic, without the codec. Then the codec scores only
//! the best thresholds.

use super::problem::{Goal, most_spikes};
use super::search::{BATCH, Run};
use super::space::Space;
use super::{Over, Scored, Stretch};
use catalogue::run::{Asked, Outcome, Outcomes};
use rayon::prelude::*;

/// Smallest threshold in the list of thresholds, as a share of the signal's range.
const SMALLEST: f64 = 1e-3;
/// Maximum number of samples that are processed to list outcomes. An outcome is a threshold with its spikes and its
/// error. The limit bounds the time to seconds.
const PASSES: usize = 4_000_000_000;
/// Maximum number of samples that are processed to list outcomes, for each setting that the search may score. This
/// limit keeps a search with a small budget short. In a search with a large budget, [`PASSES`] is the smaller limit.
const PASSES_A_SETTING: usize = 200_000;
/// Minimum number of settings by which the list's length is chosen. A search with fewer settings lists as many outcomes.
const FEW_SETTINGS: usize = 300;
/// Maximum number of ranges around good thresholds in which the outcomes of further thresholds are listed.
const NEIGHBOURHOODS: usize = 24;
/// Number of combinations of integer parameters that are listed before the search checks again whether to stop.
const COMBINATIONS: usize = 8;
/// Maximum number of outcomes (thresholds with their spikes and errors) that are scored with the codec.
const MOST_SCORED: usize = 1000;

/// The combinations of integer parameters, and a list of outcomes (thresholds with their spikes and errors) that are
/// worth scoring with the codec. Each outcome has the index of its combination.
type Listed = (Vec<Asked>, Vec<(Outcome, usize)>);

impl Run<'_> {
    /// Lists the number of spikes and the error at all thresholds, for every combination of integer parameters. Scores
    /// the best of these outcomes with the codec, until the whole search has scored `until` settings. Returns whether
    /// the search is over. The search goes on if the scheme cannot list outcomes, if the user fixed the threshold, the
    /// step, the factor or the start value, if the error on the worst flight counts, or if settings close to the best
    /// outcomes may be better, because the codec rounds and the list does not.
    pub(super) fn exactly(&mut self, space: &Space, until: usize) -> bool {
        let problem = self.problem;
        let decides = ["threshold", "step", "factor", "start"];
        if decides.iter().any(|name| problem.fixed.get(name).is_some()) {
            return false;
        }
        // The list knows only the error over all flights.
        if problem.over == Over::Worst {
            return false;
        }
        let Some((combinations, mut all)) = self.listed(space) else { return false };
        let samples: usize = problem.train.iter().map(Stretch::samples).sum();
        // The best by the goal, several because rounding may move one over a limit, and then a selection of the Pareto
        // front.
        let most = MOST_SCORED.min(until.saturating_sub(self.found.evaluated));
        let best = if problem.goal == Goal::Front { 0 } else { most.div_ceil(2) };
        let in_order = self.in_order(samples);
        all.sort_by(|a, b| in_order(&a.0).total_cmp(&in_order(&b.0)));
        let mut chosen: Vec<(Outcome, usize)> = all.iter().take(best).copied().collect();
        let is_fitted = all.iter().any(|(own, _)| own.apart != own.squares);
        unbeaten(&mut all);
        let stride = all.len().div_ceil((most - best).max(1)).max(1);
        chosen.extend(all.iter().step_by(stride));
        let options = |(outcome, place): &(Outcome, usize)| of(outcome, &combinations[*place]);
        let order: Vec<Asked> = chosen.iter().map(options).collect();
        let mut first = None;
        for batch in order.chunks(BATCH) {
            if self.is_over() {
                break;
            }
            let scored = self.try_all(batch).into_iter().flatten();
            first = first.or_else(|| scored.into_iter().find(Scored::is_allowed));
        }
        // A step that is fitted to these stretches scores too well on them. The list is sorted by the error to expect
        // on other stretches, so its first allowed setting is the best.
        if is_fitted && matches!(problem.goal, Goal::LeastError(_)) {
            self.found.best = first.or_else(|| self.found.best.take());
        }
        is_fitted
    }

    /// Lists the outcomes (thresholds with their spikes and errors) that are worth scoring, for all combinations of
    /// integer parameters. Returns `None` if the scheme cannot list its outcomes.
    fn listed(&mut self, space: &Space) -> Option<Listed> {
        let problem = self.problem;
        let pieces = self.pieces;
        let coded: usize = pieces.iter().map(|own| own.values.len()).sum();
        let samples: usize = problem.train.iter().map(Stretch::samples).sum();
        let settings = self.budget.evaluations.max(FEW_SETTINGS);
        let passes = settings.saturating_mul(PASSES_A_SETTING).min(PASSES);
        let most = (passes / coded.max(1) / 2).max(50);
        let range = problem.extent.max - problem.extent.min;
        let list_of = |combination: &Asked, span: (f64, f64), most: usize| -> Option<Outcomes> {
            let mut options = combination.clone();
            options.set("threshold", range * 0.1);
            let first = problem.train.first()?;
            let settings = problem.settings(&options, problem.sample, first).ok()?;
            problem.scheme.outcomes(&settings, pieces, span, most)
        };
        let in_order = self.in_order(samples);
        let combined = |options: &Asked| -> Option<(Vec<Outcome>, usize, bool)> {
            let Outcomes { mut list, is_complete } =
                list_of(options, (range * SMALLEST, range), most)?;
            if !is_complete {
                let spans = neighbourhoods(&list, &in_order);
                let share = most / spans.len().max(1);
                let again = spans.par_iter().filter_map(|span| list_of(options, *span, share));
                let again: Vec<Outcomes> = again.collect();
                list.extend(again.into_iter().flat_map(|found| found.list));
            }
            let listed = list.len();
            list.sort_by(|a, b| in_order(a).total_cmp(&in_order(b)));
            let mut front: Vec<(Outcome, usize)> = list.iter().map(|own| (*own, 0)).collect();
            unbeaten(&mut front);
            list.truncate(MOST_SCORED);
            let stride = front.len().div_ceil(MOST_SCORED).max(1);
            list.extend(front.into_iter().step_by(stride).map(|(own, _)| own));
            Some((list, listed, is_complete))
        };
        let combinations = space.combinations();
        let combinations: Vec<Asked> =
            combinations.iter().map(|own| own.or(&problem.fixed)).collect();
        let mut all = Vec::new();
        self.found.is_complete = true;
        for (batch, start) in combinations.chunks(COMBINATIONS).zip((0..).step_by(COMBINATIONS)) {
            if self.is_cut_short() {
                self.found.is_complete = false;
                break;
            }
            let found: Option<Vec<_>> = batch.par_iter().map(combined).collect();
            for ((list, listed, is_complete), place) in found?.into_iter().zip(start..) {
                self.found.listed += listed;
                self.found.is_complete &= is_complete;
                all.extend(list.into_iter().map(|outcome| (outcome, place)));
            }
        }
        Some((combinations, all))
    }

    /// Returns a function that rates an outcome (a threshold with its spikes and error) by how well it reaches the
    /// goal. A smaller rating is better. `samples` is the number of samples in which the spikes and the error were
    /// counted.
    fn in_order(&self, samples: usize) -> impl Fn(&Outcome) -> f64 + use<> {
        const NOT_ALLOWED: f64 = 1e100;
        let (goal, count) = (self.problem.goal, samples as f64);
        let range = self.problem.extent.max - self.problem.extent.min;
        move |own: &Outcome| match goal {
            Goal::LeastError(efficiency) => {
                let most = most_spikes(efficiency, samples);
                let above = own.spikes.saturating_sub(most) as f64;
                if above > 0.0 { NOT_ALLOWED * above } else { own.apart }
            }
            Goal::MostEfficient(rmse) => {
                let part = own.squares / (rmse * rmse * count);
                if part > 1.0 { NOT_ALLOWED * part } else { own.spikes as f64 }
            }
            Goal::Front => (own.squares / count).sqrt() / range + own.spikes as f64 / count,
        }
    }
}

/// Returns the options that give an outcome: the parameters in `combination`, and the outcome's threshold and step.
fn of(outcome: &Outcome, combination: &Asked) -> Asked {
    let mut options = combination.clone();
    options.set("threshold", outcome.threshold);
    if outcome.step != outcome.threshold {
        options.set("step", outcome.step);
    }
    options
}

/// Sorts outcomes by their number of spikes. Removes outcomes that another outcome beats in both spikes and error.
fn unbeaten(all: &mut Vec<(Outcome, usize)>) {
    all.sort_by(|(a, _), (b, _)| a.spikes.cmp(&b.spikes).then(a.squares.total_cmp(&b.squares)));
    let mut least = f64::INFINITY;
    all.retain(|(own, _)| {
        let is_better = own.squares < least;
        least = least.min(own.squares);
        is_better
    });
}

/// Returns a range of thresholds around each of the best outcomes. The range goes from the next lower to the next
/// higher threshold in `list`.
fn neighbourhoods(list: &[Outcome], in_order: &impl Fn(&Outcome) -> f64) -> Vec<(f64, f64)> {
    let mut thresholds: Vec<f64> = list.iter().map(|own| own.threshold).collect();
    thresholds.sort_by(f64::total_cmp);
    let mut order: Vec<&Outcome> = list.iter().collect();
    order.sort_by(|a, b| in_order(a).total_cmp(&in_order(b)));
    let mut spans: Vec<(f64, f64)> = Vec::new();
    for own in order {
        if spans.len() == NEIGHBOURHOODS {
            break;
        }
        if spans.iter().any(|(low, high)| (*low..=*high).contains(&own.threshold)) {
            continue;
        }
        let place = thresholds.partition_point(|threshold| *threshold < own.threshold);
        let low = thresholds.get(place.saturating_sub(1)).copied().unwrap_or(own.threshold);
        let high = thresholds.get(place + 1).copied().unwrap_or(own.threshold * 1.01);
        spans.push((low, high));
    }
    spans
}
