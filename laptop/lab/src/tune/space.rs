//! The space of a search: converts points of the unit cube to options, and options to points.

use super::chance::Chance;
use crate::scheme::Scheme;
use catalogue::run::{Asked, Value, taps};
use catalogue::{Found, Parameter, Search, Unit};

/// The statistics of the signal on which the bounds of a search depend.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Smallest sample.
    pub min: f64,
    /// Largest sample.
    pub max: f64,
    /// Mean of the samples.
    pub mean: f64,
}

impl Extent {
    fn range(self) -> f64 {
        self.max - self.min
    }
}

/// An axis of the search: a number from which a parameter is computed, and the bounds of this number.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub name: &'static str,
    pub role: Role,
    pub low: f64,
    pub high: f64,
}

impl Axis {
    /// Converts a number to its place on the axis: 0 at the lower bound, 1 at the upper bound.
    pub(super) fn place(&self, number: f64) -> f64 {
        (number - self.low) / (self.high - self.low).max(f64::MIN_POSITIVE)
    }
}

/// The meaning of the numbers on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Role {
    /// Number on the axis: the natural logarithm of the parameter divided by the given unit.
    Log(f64),
    /// Number on the axis for `Around(base, unit)`: the parameter less `base`, as a multiple of `unit`.
    Around(f64, f64),
    /// Number on the axis: the parameter divided by the sum of the absolute values of the filter's taps.
    OfFilter,
    /// Number on the axis: the natural logarithm of the parameter divided by the threshold.
    Thresholds,
    Whole,
    /// Number on the axis: the parameter itself, a whole number. The parameter is a maximum, such as the largest number
    /// of spikes in a sample.
    Most,
    Words(&'static [&'static str]),
    /// Number on the axis: the natural logarithm of the filter's length in taps.
    Length,
    Shape,
    Alpha,
    /// Number on the axis: the natural logarithm of S / H. S is the sum of the filter's taps. H is the height of the
    /// signal's mean above the parameter `shift`. A signal that stays at its mean gives one spike every S / H samples.
    /// For `Sum(low, high)`, S is clamped to the range from `low` to `high`.
    Sum(f64, f64),
    /// Number on the axis: a tap of the filter, divided by the given unit.
    Tap(f64),
    /// Number on the axis: the natural logarithm of the number of receptive fields that fire in a sample, 2 R / beta. R
    /// is how far a field reaches, which [`reach`] computes. Thus a step in the slots or the floor keeps the number of
    /// spikes. For `Fields(low, high)`, beta is clamped to the range from `low` to `high`.
    Fields(f64, f64),
}

/// The shapes of a filter that are searched. Only the last shape has a parameter alpha.
const SHAPES: [&str; 3] = ["triang", "hann", "gauss"];

/// The space of a scheme's search: an axis for each number that is searched, and the parameters that are fixed.
#[derive(Clone, Debug)]
pub(crate) struct Space {
    axes: Vec<Axis>,
    fixed: Asked,
    extent: Extent,
}

impl Space {
    /// Makes the space of the scheme's searched parameters. A parameter with a value in `fixed` is not searched. `extent`
    /// holds the range and mean of the samples.
    pub(crate) fn new(scheme: Scheme, fixed: &Asked, extent: Extent) -> Self {
        Self::of(scheme, fixed, extent, |search| search)
    }

    /// Makes the same space, but with beta itself on an axis in place of the fields that fire.
    pub(super) fn plain(scheme: Scheme, fixed: &Asked, extent: Extent) -> Self {
        Self::of(scheme, fixed, extent, |search| match search {
            Search::Fields(low, high) => Search::Log(low, high),
            other => other,
        })
    }

    fn of(
        scheme: Scheme,
        fixed: &Asked,
        extent: Extent,
        searched: impl Fn(Search) -> Search,
    ) -> Self {
        let mut axes = Vec::new();
        for parameter in scheme.info().parameters {
            if let (None, Some(search)) =
                (fixed.get(parameter.name), scheme.search(parameter, fixed))
            {
                axes.extend(axes_of(parameter, searched(search), extent));
            }
        }
        let ends = |name: &str| {
            let searched = axes.iter().find(|axis| axis.name == name);
            let given = fixed.number(name).map(|own| [own, own]);
            given.or_else(|| searched.map(|axis| [axis.low, axis.high]))
        };
        let (slots, floor) = (ends("slots"), ends("floor"));
        let reach = |at: usize| {
            let floor = floor.map(|own| own[1 - at]);
            // With fewer slots than the floor no field fires.
            reach(slots.map(|own| own[at].max(floor.unwrap_or(1.0))), floor)
        };
        let reaches = [reach(0), reach(1)];
        for axis in &mut axes {
            if let Role::Fields(low, high) = axis.role {
                // All of beta, with any slots and floor with which fields fire.
                axis.low = (2.0 * reaches[0] / high).ln();
                axis.high = (2.0 * reaches[1] / low).ln();
            }
        }
        Self { axes, fixed: fixed.clone(), extent }
    }

    /// Returns a search space in which each tap of the filter has an axis. The axes for the filter's shape, length and
    /// sum are left out. Parameters that are integers or words have no axes either. The new space fixes each of them at
    /// the parameter's value in `found`.
    pub(crate) fn with_taps(&self, found: &Asked, taps: &[f64]) -> Self {
        let peak = taps.iter().fold(0.0, |peak: f64, tap| peak.max(tap.abs()));
        let mut fixed = self.fixed.clone();
        let mut axes: Vec<Axis> = Vec::new();
        for axis in &self.axes {
            match axis.role {
                Role::Length | Role::Shape | Role::Alpha | Role::Sum(..) => {}
                Role::Whole | Role::Most | Role::Words(_) => {
                    if let Some(value) = found.get(axis.name) {
                        fixed.set(axis.name, value.clone());
                    }
                }
                _ => axes.push(axis.clone()),
            }
        }
        let tap = Axis { name: "filter", role: Role::Tap(peak), low: -1.0, high: 2.0 };
        axes.extend(taps.iter().map(|_| tap.clone()));
        Self { axes, fixed, extent: self.extent }
    }

    /// Returns the number of axes.
    pub(crate) fn len(&self) -> usize {
        self.axes.len()
    }

    /// Returns the axes, with the bounds of each.
    pub(super) fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Converts a place on the axis of index `axis` to the number at this place. `place` runs from 0 at the axis's
    /// lower bound to 1 at its upper bound.
    pub(crate) fn number(&self, axis: usize, place: f64) -> f64 {
        let Axis { low, high, .. } = self.axes[axis];
        low + place.clamp(0.0, 1.0) * (high - low)
    }

    /// Returns `count` points from which a search starts, spread over each axis. `share` is the largest number of spikes
    /// for each sample, if it is limited; without a limit sums start as for 0.5. For each point, the sum of the filter's
    /// taps is chosen such that a signal at its mean gives about this number of spikes for each sample. Receptive fields
    /// give a quarter of it to a little more.
    pub(crate) fn starts(&self, seed: u64, count: usize, share: Option<f64>) -> Vec<Vec<f64>> {
        let mut chance = Chance::new(seed);
        let apart = 1.0 / share.unwrap_or(0.5).clamp(0.02, 1.0);
        let most = share.map_or(f64::INFINITY, f64::ln);
        let has_filter = self.axes.iter().any(|axis| axis.role == Role::Length);
        let mut points = vec![Vec::new(); count];
        for axis in &self.axes {
            let mut order: Vec<usize> = (0..count).collect();
            if axis.role != Role::Length {
                for place in (1..count).rev() {
                    order.swap(place, chance.below(place + 1));
                }
            }
            for (point, stratum) in points.iter_mut().zip(order) {
                let even = (stratum as f64 + chance.part()) / count as f64;
                let number = match axis.role {
                    // From 1.5 to 48 taps.
                    Role::Length => (1.5_f64 * 32_f64.powf(even)).ln(),
                    Role::Alpha => (0.8 + 2.0 * even).ln(),
                    Role::Sum(..) => (apart * (0.75 + 0.6 * even)).ln(),
                    Role::Fields(..) if share.is_some() => {
                        most.min(axis.high) + 0.1 - 1.5 * (1.0 - even)
                    }
                    // HSA's value is never above the signal, so that a high shift is often best.
                    Role::Around(..) if has_filter => {
                        axis.low + (1.3 * even).min(1.0) * (axis.high - axis.low)
                    }
                    // Many are best at an end of their range, and more often at the upper one.
                    Role::Whole => {
                        axis.low + (1.6 * even - 0.2).clamp(0.0, 1.0) * (axis.high - axis.low)
                    }
                    // The signal's range, or somewhat off it.
                    Role::Around(..) if stratum % 3 == 0 => 0.0,
                    _ => axis.low + even * (axis.high - axis.low),
                };
                point.push(axis.place(number).clamp(0.0, 1.0));
            }
        }
        points
    }

    /// Returns every combination of values of the searched parameters that are integers or words. Leaves out maxima
    /// such as the largest number of spikes in a sample.
    pub(crate) fn combinations(&self) -> Vec<Asked> {
        let mut all = vec![Asked::default()];
        for axis in
            self.axes.iter().filter(|axis| matches!(axis.role, Role::Whole | Role::Words(_)))
        {
            let values = axis.low as u32..=axis.high as u32;
            let values = values.map(|value| match axis.role {
                Role::Words(words) => Value::from(words[value as usize]),
                _ => Value::from(u64::from(value)),
            });
            let values: Vec<Value> = values.collect();
            all = all
                .iter()
                .flat_map(|options| {
                    values.iter().map(|value| {
                        let mut options = options.clone();
                        options.set(axis.name, value.clone());
                        options
                    })
                })
                .collect();
        }
        all
    }

    /// Converts a point of the unit cube to options, which give values to the scheme's parameters. The point has one
    /// coordinate for each axis.
    pub(crate) fn options(&self, point: &[f64]) -> Asked {
        let numbers: Vec<f64> =
            point.iter().enumerate().map(|(axis, place)| self.number(axis, *place)).collect();
        self.meant(&numbers)
    }

    /// Converts numbers, one for each axis, to options. A number may lie beyond the bounds of its axis.
    pub(super) fn meant(&self, numbers: &[f64]) -> Asked {
        let mut options = self.fixed.clone();
        let (mut filter, mut free) = (Shaped::default(), Vec::new());
        let (height, reach) = self.coupled(numbers);
        for (axis, &value) in self.axes.iter().zip(numbers) {
            let whole = value.round();
            match axis.role {
                Role::Log(unit) => options.set(axis.name, value.exp() * unit),
                Role::Around(base, unit) => {
                    options.set(axis.name, base + value * unit);
                }
                Role::Thresholds => options.set(axis.name, format!("{}x", value.exp())),
                Role::Whole | Role::Most => options.set(axis.name, whole as u64),
                Role::Words(words) => options.set(axis.name, words[whole as usize]),
                Role::Length => filter.length = value.exp().round() as usize,
                Role::Shape => filter.shape = SHAPES[whole as usize],
                Role::Alpha => filter.alpha = value.exp(),
                Role::Sum(low, high) => {
                    filter.sum = (value.exp() * height).clamp(low, high);
                }
                Role::Fields(low, high) => {
                    options.set(axis.name, (2.0 * reach / value.exp()).clamp(low, high));
                }
                Role::Tap(unit) => free.push(value * unit),
                Role::OfFilter => {}
            }
        }
        if !free.is_empty() {
            options.set("filter", free);
        } else if filter.length > 0 {
            options.set("filter", filter.taps());
        }
        for (axis, value) in self.axes.iter().zip(numbers) {
            if axis.role == Role::OfFilter {
                let sum =
                    taps_of(&options).map_or(1.0, |taps| taps.iter().map(|tap| tap.abs()).sum());
                options.set(axis.name, value * sum);
            }
        }
        options
    }

    /// Returns numbers, one for each axis, with those of a sum or of fields moved to where the bounds of the parameter
    /// end. Beyond, a step on such an axis would change nothing.
    pub(super) fn clamped(&self, mut numbers: Vec<f64>) -> Vec<f64> {
        let (height, reach) = self.coupled(&numbers);
        for (axis, number) in self.axes.iter().zip(&mut numbers) {
            let (low, high) = match axis.role {
                Role::Sum(low, high) => (low / height, high / height),
                Role::Fields(low, high) => (2.0 * reach / high, 2.0 * reach / low),
                _ => continue,
            };
            // Not `clamp`: without a range, both are NaN.
            *number = number.max(low.ln()).min(high.ln());
        }
        numbers
    }

    /// Returns what numbers, one for each axis, say of other parameters than their own: the height that multiplies a
    /// filter's sum, and the reach of a receptive field.
    fn coupled(&self, numbers: &[f64]) -> (f64, f64) {
        let axes = || self.axes.iter().zip(numbers);
        let shifts = axes().find_map(|(axis, value)| match axis.role {
            Role::Around(base, unit) => Some(base + value * unit),
            _ => None,
        });
        let whole = |name: &str| {
            let own = axes().find(|(axis, _)| axis.name == name).map(|(_, value)| value.round());
            own.or_else(|| self.fixed.number(name))
        };
        let shift = shifts.or_else(|| self.fixed.number("shift"));
        (self.height(shift), reach(whole("slots"), whole("floor")))
    }

    /// Returns the height of the signal's mean above `shift` or, if `shift` is `None`, above the signal's minimum. The
    /// height is at least 1 % of the signal's range.
    fn height(&self, shift: Option<f64>) -> f64 {
        let Extent { min, mean, .. } = self.extent;
        (mean - shift.unwrap_or(min)).max(0.01 * self.extent.range())
    }

    /// Converts options to a point of the unit cube, with one coordinate for each axis. If the options have no value
    /// for an axis, the coordinate is 0.5.
    pub(crate) fn point(&self, options: &Asked) -> Vec<f64> {
        let number = |name: &str| options.number(name);
        let taps = taps_of(options).unwrap_or_default();
        let mut next_tap = taps.iter();
        let place = |axis: &Axis| {
            let value = match axis.role {
                Role::Log(unit) => number(axis.name).map(|value| (value / unit).ln()),
                Role::Around(base, unit) => number(axis.name).map(|value| (value - base) / unit),
                Role::OfFilter => {
                    let sum: f64 = taps.iter().map(|tap| tap.abs()).sum();
                    number(axis.name).map(|value| value / sum)
                }
                Role::Whole | Role::Most => number(axis.name),
                // Given in multiples of the threshold, or as a number.
                Role::Thresholds => {
                    match options.word(axis.name).and_then(|text| text.strip_suffix('x')) {
                        Some(times) => times.parse::<f64>().ok().map(f64::ln),
                        None => number(axis.name)
                            .zip(number("threshold"))
                            .map(|(step, own)| (step / own).ln()),
                    }
                }
                Role::Tap(unit) => next_tap.next().map(|tap| tap / unit),
                Role::Length => Some((taps.len() as f64).ln()),
                Role::Sum(..) => {
                    Some((taps.iter().sum::<f64>() / self.height(number("shift"))).ln())
                }
                Role::Fields(..) => {
                    let reach = reach(number("slots"), number("floor"));
                    number(axis.name).map(|beta| (2.0 * reach / beta).ln())
                }
                Role::Words(words) => options
                    .word(axis.name)
                    .and_then(|own| words.iter().position(|word| *word == own))
                    .map(|place| place as f64),
                Role::Shape | Role::Alpha => None,
            };
            let value = value.filter(|value| value.is_finite());
            let value = value.unwrap_or(f64::midpoint(axis.low, axis.high));
            axis.place(value).clamp(0.0, 1.0)
        };
        self.axes.iter().map(place).collect()
    }
}

/// Returns the distance at which a response falls below the floor, in widths of a receptive field.
fn reach(slots: Option<f64>, floor: Option<f64>) -> f64 {
    let least = slots.unwrap_or(2.0) / (floor.unwrap_or(1.0) - 0.5);
    // No field reaches a floor above the slots.
    (2.0 * least.max(1.0 + 1e-6).ln()).sqrt()
}

/// A filter given by its shape, length and sum.
#[derive(Default)]
struct Shaped {
    shape: &'static str,
    length: usize,
    alpha: f64,
    sum: f64,
}

impl Shaped {
    fn taps(&self) -> Value {
        let Self { shape, length, alpha, sum } = self;
        let last = SHAPES[SHAPES.len() - 1];
        let alpha = if *shape == last { format!(":{alpha}") } else { String::new() };
        let word = format!("{shape}:{length}{alpha},sum={sum}");
        // Words that make no filter become an error when the options are completed to settings.
        taps(&word).map_or(Value::from(word), Value::from)
    }
}

/// Returns the taps that the parameter `filter` gives as a list, or as a shape such as `triang:15`. Returns `None` if
/// the parameter is missing or invalid.
fn taps_of(asked: &Asked) -> Option<Vec<f64>> {
    match asked.get("filter")? {
        Value::Word(shape) => taps(shape).ok(),
        value => value.numbers().map(<[f64]>::to_vec),
    }
}

fn axes_of(parameter: &'static Parameter, search: Search, extent: Extent) -> Vec<Axis> {
    let name = parameter.name;
    let unit = if parameter.unit == Unit::Signal { extent.range() } else { 1.0 };
    let axis = |role, low, high| Axis { name, role, low, high };
    match search {
        Search::Log(low, high) => vec![axis(Role::Log(unit), low.ln(), high.ln())],
        // `Space::of` sets the ends.
        Search::Fields(low, high) => vec![axis(Role::Fields(low, high), 0.0, 0.0)],
        Search::Around(low, high) => {
            let base = match parameter.found {
                Some(Found::Max) => extent.max,
                _ => extent.min,
            };
            vec![axis(Role::Around(base, extent.range()), low, high)]
        }
        Search::OfFilter(low, high) => vec![axis(Role::OfFilter, low, high)],
        Search::Thresholds(low, high) => vec![axis(Role::Thresholds, low.ln(), high.ln())],
        Search::Whole(low, high) => vec![axis(Role::Whole, low.into(), high.into())],
        Search::Most(low, high) => vec![axis(Role::Most, low.into(), high.into())],
        Search::Words(words) => vec![axis(Role::Words(words), 0.0, words.len() as f64 - 1.0)],
        Search::Filter(longest, low, high) => vec![
            axis(Role::Length, 0.0, f64::from(longest).ln()),
            axis(Role::Shape, 0.0, SHAPES.len() as f64 - 1.0),
            axis(Role::Alpha, 0.1_f64.ln(), 8_f64.ln()),
            axis(Role::Sum(low * extent.range(), high * extent.range()), 0.8_f64.ln(), 60_f64.ln()),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Goal, Limits, Problem, Stretch};
    use super::{Extent, Space};
    use crate::scheme::Scheme;
    use crate::trial::Recording;
    use catalogue::run::{Asked, SampleType};

    /// Takes three points of each scheme's search space: all axes at the lower bound, all in the middle, and all at the
    /// upper bound. The scheme accepts the options of each point.
    #[test]
    fn every_corner_is_understood() {
        for scheme in Scheme::all() {
            let fixed = Asked::default();
            let space = Space::new(scheme, &fixed, Extent { min: -2.0, max: 3.0, mean: 0.5 });
            for place in [0.0, 0.5, 1.0] {
                let options = space.options(&vec![place; space.len()]);
                options.check(scheme.info()).unwrap();
            }
        }
    }

    /// Encodes a ramp with as many slots and floors as are searched. Three fields fire in a sample, fewer at the ends. A
    /// number of fields out of beta's reach moves to where beta ends, which means the same.
    #[test]
    fn slots_and_floor_leave_the_number_of_fields() {
        let ramp: Vec<f64> = (0..1000).map(|place| f64::from(place) * 0.01).collect();
        let train = Stretch::whole(&Recording::of("x".to_owned(), ramp, None));
        let (asked, limits) = (Asked::default(), Limits::default());
        let scheme = Scheme::named("grf-nonlinear-slots").unwrap();
        let known = (Goal::Front, &limits, "M4F");
        let problem = Problem::new(scheme, SampleType::F32, &asked, &train, known);
        let space = Space::new(scheme, &asked, problem.extent);
        for (slots, floor) in [(2.0, 1.0), (2.0, 2.0), (7.0, 2.0), (32.0, 1.0)] {
            let numbers = |fields: f64| -> Vec<f64> {
                let number = |name| match name {
                    "slots" => slots,
                    "floor" => floor,
                    "neurons" => 24.0,
                    "beta" => fields.ln(),
                    _ => 0.0,
                };
                space.axes().iter().map(|axis| number(axis.name)).collect()
            };
            let spikes = problem.score(&space.meant(&numbers(3.0))).unwrap().tally.spikes;
            assert!((2800..3100).contains(&spikes), "{slots} {floor}: {spikes}");
            let beta = |numbers: &[f64]| space.meant(numbers).number("beta").unwrap();
            let clamped = space.clamped(numbers(0.3));
            assert!((beta(&clamped) - beta(&numbers(0.3))).abs() < 1e-9);
            assert!(clamped != numbers(0.3), "{slots} {floor}");
        }
    }

    /// Given slots and floors leave all of beta's range within reach.
    #[test]
    fn beta_reaches_its_bounds_with_any_slots_and_floor() {
        let scheme = Scheme::named("grf-nonlinear-slots").unwrap();
        for (slots, floor) in [(10, 10), (4, 4), (256, 1), (2, 1)] {
            let mut fixed = Asked::default();
            fixed.set("slots", slots as u64);
            fixed.set("floor", floor as u64);
            let space = Space::new(scheme, &fixed, Extent { min: 0.0, max: 1.0, mean: 0.5 });
            for (place, bound) in [(0.0, 4.0), (1.0, 0.3)] {
                let numbers: Vec<f64> =
                    (0..space.len()).map(|axis| space.number(axis, place)).collect();
                let point = space.meant(&numbers);
                let beta = point.number("beta").unwrap();
                assert!((beta - bound).abs() < 1e-9, "{slots} {floor}: {beta}");
            }
        }
    }

    #[test]
    fn a_point_comes_back() {
        let scheme = Scheme::named("t-hsa").unwrap();
        let space =
            Space::new(scheme, &Asked::default(), Extent { min: -2.0, max: 3.0, mean: 0.5 });
        let mut options = Asked::default();
        let taps = [1.0, 2.0, 1.0];
        options.set("filter", taps.to_vec());
        options.set("shift", -2.5);
        options.set("threshold", 1.0);
        let free = space.with_taps(&options, &taps);
        let again = free.options(&free.point(&options));
        assert_eq!(again.get("filter"), Some(&taps.to_vec().into()));
        assert_eq!(again.number("shift"), Some(-2.5));
        assert_eq!(again.number("threshold"), Some(1.0));
    }
}
