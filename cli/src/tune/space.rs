//! Where settings are looked for: the searched parameters of a scheme as numbers between bounds, and back to options.

use crate::scheme::Scheme;
use anyhow::Result;
use catalogue::run::{Options, taps};
use catalogue::{Found, Parameter, Search, Unit};

/// What of the signal the bounds hang on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// Its smallest sample.
    pub min: f64,
    /// Its largest sample.
    pub max: f64,
}

impl Extent {
    fn range(self) -> f64 {
        self.max - self.min
    }
}

/// One number of the search.
#[derive(Clone, Debug)]
struct Axis {
    name: &'static str,
    role: Role,
    low: f64,
    high: f64,
}

/// What a number becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    /// The logarithm of a number in this unit.
    Log(f64),
    /// An offset from a value, in parts of a range.
    Around(f64, f64),
    /// A part of the filter's sum.
    OfFilter,
    /// The logarithm of a number of thresholds.
    Thresholds,
    Whole,
    Words(&'static [&'static str]),
    Length,
    Shape,
    Alpha,
    /// The logarithm of the filter's sum in this unit.
    Sum(f64),
    /// A tap in this unit.
    Tap(f64),
}

/// The shapes of a filter; the last one takes an alpha.
const SHAPES: [&str; 3] = ["triang", "hann", "gauss"];

/// The numbers of a scheme's search.
#[derive(Clone, Debug)]
pub(crate) struct Space {
    axes: Vec<Axis>,
    fixed: Options,
}

impl Space {
    /// All that these options leave open.
    pub(crate) fn new(scheme: Scheme, fixed: &Options, extent: Extent) -> Self {
        let mut axes = Vec::new();
        for parameter in scheme.info().parameters {
            if let (None, Some(search)) =
                (fixed.get(parameter.name), scheme.search(parameter, fixed))
            {
                axes.extend(axes_of(parameter, search, extent));
            }
        }
        Self { axes, fixed: fixed.clone() }
    }

    /// The taps of a filter themselves, besides what is no filter and no whole number.
    pub(crate) fn with_taps(&self, found: &Options, taps: &[f64]) -> Self {
        let peak = taps.iter().fold(0.0, |peak: f64, tap| peak.max(tap.abs()));
        let mut fixed = self.fixed.clone();
        let mut axes: Vec<Axis> = Vec::new();
        for axis in &self.axes {
            match axis.role {
                Role::Length | Role::Shape | Role::Alpha | Role::Sum(_) => {}
                Role::Whole | Role::Words(_) => {
                    fixed.set(axis.name, found.get(axis.name).unwrap_or_default());
                }
                _ => axes.push(axis.clone()),
            }
        }
        let tap = Axis { name: "filter", role: Role::Tap(peak), low: -1.0, high: 2.0 };
        axes.extend(taps.iter().map(|_| tap.clone()));
        Self { axes, fixed }
    }

    /// How many numbers there are.
    pub(crate) fn len(&self) -> usize {
        self.axes.len()
    }

    /// The lower and the upper bounds.
    pub(crate) fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.axes.iter().map(|axis| (axis.low, axis.high)).unzip()
    }

    /// Which of the numbers are whole.
    pub(crate) fn whole(&self) -> Vec<bool> {
        let is_whole = |axis: &Axis| {
            matches!(axis.role, Role::Whole | Role::Words(_) | Role::Length | Role::Shape)
        };
        self.axes.iter().map(is_whole).collect()
    }

    /// Every combination of the whole numbers and words, as options.
    pub(crate) fn combinations(&self) -> Vec<Options> {
        let mut all = vec![Options::default()];
        for axis in
            self.axes.iter().filter(|axis| matches!(axis.role, Role::Whole | Role::Words(_)))
        {
            let values = axis.low as u32..=axis.high as u32;
            let texts = values.map(|value| match axis.role {
                Role::Words(words) => words[value as usize].to_owned(),
                _ => value.to_string(),
            });
            let texts: Vec<String> = texts.collect();
            all = all
                .iter()
                .flat_map(|options| {
                    texts.iter().map(|text| {
                        let mut options = options.clone();
                        options.set(axis.name, text);
                        options
                    })
                })
                .collect();
        }
        all
    }

    /// The options that these numbers mean.
    pub(crate) fn options(&self, point: &[f64]) -> Options {
        let mut options = self.fixed.clone();
        let (mut filter, mut free) = (Shaped::default(), Vec::new());
        for (axis, &value) in self.axes.iter().zip(point) {
            let value = value.clamp(axis.low, axis.high);
            let whole = value.round();
            match axis.role {
                Role::Log(unit) => options.set(axis.name, &(value.exp() * unit).to_string()),
                Role::Around(base, unit) => {
                    options.set(axis.name, &(base + value * unit).to_string());
                }
                Role::Thresholds => options.set(axis.name, &format!("{}x", value.exp())),
                Role::Whole => options.set(axis.name, &whole.to_string()),
                Role::Words(words) => options.set(axis.name, words[whole as usize]),
                Role::Length => filter.length = whole as usize,
                Role::Shape => filter.shape = SHAPES[whole as usize],
                Role::Alpha => filter.alpha = value.exp(),
                Role::Sum(unit) => filter.sum = value.exp() * unit,
                Role::Tap(unit) => free.push(value * unit),
                Role::OfFilter => {}
            }
        }
        if !free.is_empty() {
            let taps: Vec<String> = free.iter().map(f64::to_string).collect();
            options.set("filter", &(taps.join(",") + ","));
        } else if filter.length > 0 {
            options.set("filter", &filter.text());
        }
        for (axis, value) in self.axes.iter().zip(point) {
            if axis.role == Role::OfFilter {
                let sum = options.get("filter").and_then(|text| sum_of(text).ok());
                options.set(axis.name, &(value * sum.unwrap_or(1.0)).to_string());
            }
        }
        options
    }

    /// The numbers that mean these options, as far as there are any; the middle otherwise.
    pub(crate) fn point(&self, options: &Options) -> Vec<f64> {
        let number = |name: &str| options.get(name).and_then(|text| text.parse::<f64>().ok());
        let taps = options.get("filter").and_then(|text| taps(text).ok()).unwrap_or_default();
        let mut next_tap = taps.iter();
        let place = |axis: &Axis| {
            let value = match axis.role {
                Role::Log(unit) => number(axis.name).map(|value| (value / unit).ln()),
                Role::Around(base, unit) => number(axis.name).map(|value| (value - base) / unit),
                Role::OfFilter => {
                    let sum: f64 = taps.iter().map(|tap| tap.abs()).sum();
                    number(axis.name).map(|value| value / sum)
                }
                Role::Whole => number(axis.name),
                // Given in thresholds, or found as a number.
                Role::Thresholds => {
                    match options.get(axis.name).and_then(|text| text.strip_suffix('x')) {
                        Some(times) => times.parse::<f64>().ok().map(f64::ln),
                        None => number(axis.name)
                            .zip(number("threshold"))
                            .map(|(step, own)| (step / own).ln()),
                    }
                }
                Role::Tap(unit) => next_tap.next().map(|tap| tap / unit),
                Role::Length => Some(taps.len() as f64),
                Role::Sum(unit) => Some((taps.iter().sum::<f64>() / unit).ln()),
                Role::Words(_) | Role::Shape | Role::Alpha => None,
            };
            let value = value.filter(|value| value.is_finite());
            value.unwrap_or(f64::midpoint(axis.low, axis.high)).clamp(axis.low, axis.high)
        };
        self.axes.iter().map(place).collect()
    }
}

/// A filter by its shape.
#[derive(Default)]
struct Shaped {
    shape: &'static str,
    length: usize,
    alpha: f64,
    sum: f64,
}

impl Shaped {
    fn text(&self) -> String {
        let Self { shape, length, alpha, sum } = self;
        let last = SHAPES[SHAPES.len() - 1];
        let alpha = if *shape == last { format!(":{alpha}") } else { String::new() };
        format!("{shape}:{length}{alpha},sum={sum}")
    }
}

fn sum_of(filter: &str) -> Result<f64> {
    Ok(taps(filter)?.iter().map(|tap| tap.abs()).sum())
}

fn axes_of(parameter: &'static Parameter, search: Search, extent: Extent) -> Vec<Axis> {
    let name = parameter.name;
    let unit = if parameter.unit == Unit::Signal { extent.range() } else { 1.0 };
    let axis = |role, low, high| Axis { name, role, low, high };
    match search {
        Search::Log(low, high) => vec![axis(Role::Log(unit), low.ln(), high.ln())],
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
        Search::Words(words) => vec![axis(Role::Words(words), 0.0, words.len() as f64 - 1.0)],
        Search::Filter(longest, low, high) => vec![
            axis(Role::Length, 1.0, longest.into()),
            axis(Role::Shape, 0.0, SHAPES.len() as f64 - 1.0),
            axis(Role::Alpha, 0.1_f64.ln(), 8_f64.ln()),
            axis(Role::Sum(extent.range()), low.ln(), high.ln()),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::{Extent, Space};
    use crate::scheme::Scheme;
    use catalogue::run::Options;

    /// Every corner and the middle of every scheme's space are options that the scheme takes.
    #[test]
    fn every_corner_is_understood() {
        for scheme in Scheme::all() {
            let fixed = Options::default();
            let space = Space::new(scheme, &fixed, Extent { min: -2.0, max: 3.0 });
            let (low, high) = space.bounds();
            let middle: Vec<f64> =
                low.iter().zip(&high).map(|(a, b)| f64::midpoint(*a, *b)).collect();
            for point in [&low, &high, &middle] {
                let options = space.options(point);
                options.check(scheme.info()).unwrap();
            }
        }
    }

    #[test]
    fn a_point_comes_back() {
        let scheme = Scheme::named("t-hsa").unwrap();
        let space = Space::new(scheme, &Options::default(), Extent { min: -2.0, max: 3.0 });
        let mut options = Options::default();
        for (name, text) in [("filter", "1,2,1,"), ("shift", "-2.5"), ("threshold", "1")] {
            options.set(name, text);
        }
        let taps = [1.0, 2.0, 1.0];
        let free = space.with_taps(&options, &taps);
        let again = free.options(&free.point(&options));
        assert_eq!(again.get("filter"), Some("1,2,1,"));
        assert_eq!(again.get("shift"), Some("-2.5"));
        assert_eq!(again.get("threshold"), Some("1"));
    }
}
