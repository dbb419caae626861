//! Reports parameters whose best value lies at a bound of the search, so that a better value may lie beyond the bound.
//! Leaves out a parameter if the scheme allows no value beyond the bound.

use super::Problem;
use super::space::{Axis, Role, Space};
use crate::brief::short;
use catalogue::run::Asked;

/// A parameter whose best value lies at a bound of its search.
#[derive(Clone, Debug)]
pub struct Bound {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Value of the parameter in the best settings, formatted.
    pub value: String,
    /// The lowest and the highest value that the search could try, formatted.
    pub searched: [String; 2],
}

impl Bound {
    /// Returns a sentence for the user. The sentence states the parameter, its value, and the lowest and highest value
    /// that the search could try.
    pub fn words(&self) -> String {
        let Self { parameter, value, searched: [low, high] } = self;
        format!(
            "{parameter} {value} is at the end of its search, {low} to {high}: beyond was not tried"
        )
    }
}

/// Returns the parameters whose values in the settings `best` lie at a bound of the search. Leaves out a parameter if
/// the scheme allows no value beyond the bound.
pub(super) fn bounds(problem: &Problem, best: &Asked) -> Vec<Bound> {
    /// Largest distance from a bound at which a value counts as lying at the bound, as a share of the axis.
    const NEAR: f64 = 0.02;
    let space = Space::plain(problem.scheme, &problem.fixed, problem.extent);
    let point = space.point(best);
    let Some(first) = problem.train.first() else { return Vec::new() };
    let is_built = |options: &Asked| {
        let settings = problem.settings(options, problem.sample, first);
        settings.is_ok_and(|settings| problem.scheme.codec(&settings).is_ok())
    };
    let numbers: Vec<f64> =
        point.iter().enumerate().map(|(axis, place)| space.number(axis, *place)).collect();
    let mut found = Vec::new();
    for (place, axis) in space.axes().iter().enumerate() {
        let Some(value) = number(axis, best) else { continue };
        let is_high = point[place] > 0.5;
        let is_near = if is_high { point[place] >= 1.0 - NEAR } else { point[place] <= NEAR };
        let mut beyond = numbers.clone();
        beyond[place] = further(axis, is_high);
        let is_count = matches!(axis.role, Role::Whole | Role::Most);
        // A count cannot be below 0.
        let is_bound = is_count && meaning(axis, beyond[place]) < 0.0;
        if is_near && !is_bound && is_built(&space.meant(&beyond)) {
            let searched = [axis.low, axis.high].map(|end| short(meaning(axis, end)));
            found.push(Bound { parameter: axis.name, value: short(value), searched });
        }
    }
    found
}

/// Returns the value of the axis's parameter in `options`. Returns `None` for an axis that is not reported, such as the
/// length of a filter.
fn number(axis: &Axis, options: &Asked) -> Option<f64> {
    match axis.role {
        Role::Log(_) | Role::Around(..) | Role::Whole | Role::Most => options.number(axis.name),
        _ => None,
    }
}

/// Converts a number on an axis to the value of the parameter, in the form in which a user gives this value.
fn meaning(axis: &Axis, number: f64) -> f64 {
    match axis.role {
        Role::Log(unit) => number.exp() * unit,
        Role::Around(base, unit) => base + number * unit,
        _ => number,
    }
}

/// Returns a number just beyond a bound of an axis. On an axis of whole numbers, this is the next whole number. On
/// other axes, it lies 2 % of the axis's length beyond the bound.
fn further(axis: &Axis, is_high: bool) -> f64 {
    let (end, sign) = if is_high { (axis.high, 1.0) } else { (axis.low, -1.0) };
    match axis.role {
        Role::Whole | Role::Most => end + sign,
        _ => end + sign * 0.02 * (axis.high - axis.low),
    }
}
