//! Gaussian-process regression: a model of a function that is known at a few points, after Rasmussen and Williams
//! (2006). The kernel is Matérn 5/2 with a length for each axis.

/// Smallest and largest variance of the noise, as a share of the function's variance.
const NOISE: (f64, f64) = (1e-6, 0.3);
/// Smallest, likeliest and largest length of the kernel, in standard deviations of the points along an axis.
const LENGTHS: (f64, f64, f64) = (0.1, 3.0, 60.0);

/// Deviation below which values count as equal, as a share of their size.
const EQUAL: f64 = 1e-9;

/// A fitted model.
pub(super) struct Surrogate {
    /// Mean and deviation of the points along each axis, by which points are scaled.
    scales: Vec<(f64, f64)>,
    points: Vec<Vec<f64>>,
    /// Reciprocals of the kernel's lengths.
    inverse_lengths: Vec<f64>,
    /// Lower triangle of the Cholesky factor of the points' covariance, row by row.
    factor: Vec<f64>,
    weights: Vec<f64>,
    mean: f64,
    /// Variance of the function far from all points.
    variance: f64,
}

/// The parameters of the kernel: the logarithms of its lengths and of the noise's variance.
#[derive(Clone, Debug)]
pub(super) struct Hyper {
    lengths: Vec<f64>,
    noise: f64,
}

impl Hyper {
    /// Starts from likely parameters.
    pub(super) fn new(axes: usize) -> Self {
        Self { lengths: vec![LENGTHS.1.ln(); axes], noise: 1e-3_f64.ln() }
    }

    /// Returns parameters of which one is changed by a step: a length or, if `place` is past the lengths, the noise.
    fn moved(&self, place: usize, step: f64) -> Self {
        let mut all = self.clone();
        match all.lengths.get_mut(place) {
            Some(length) => *length = (*length + step).clamp(LENGTHS.0.ln(), LENGTHS.2.ln()),
            None => all.noise = (all.noise + 2.0 * step).clamp(NOISE.0.ln(), NOISE.1.ln()),
        }
        all
    }

    /// Returns the reciprocals of the lengths.
    fn inverse_lengths(&self) -> Vec<f64> {
        self.lengths.iter().map(|length| (-length).exp()).collect()
    }
}

impl Surrogate {
    /// Fits a model to points and their values. If `is_fitted`, adapts `hyper` first: tries a step up, then a step down,
    /// for each parameter, and keeps a step that raises the likelihood. Returns `None` if all values are equal.
    pub(super) fn fit(
        points: &[&[f64]],
        values: &[f64],
        hyper: &mut Hyper,
        is_fitted: bool,
    ) -> Option<Self> {
        let axes = hyper.lengths.len();
        let (mean, deviation) = moments(values.iter().copied());
        let least = EQUAL * mean.abs().max(1.0);
        if !deviation.is_finite() || deviation <= least {
            return None;
        }
        let scales: Vec<(f64, f64)> = (0..axes)
            .map(|axis| moments(points.iter().map(|point| point[axis])))
            .map(|(mean, deviation)| (mean, if deviation > EQUAL { deviation } else { 1.0 }))
            .collect();
        let points: Vec<Vec<f64>> = points.iter().map(|point| scaled(point, &scales)).collect();
        let targets: Vec<f64> = values.iter().map(|value| (value - mean) / deviation).collect();
        let mut best = solved(&points, &targets, hyper)?;
        for place in 0..=axes {
            let steps = if is_fitted { &[1.0, -1.0][..] } else { &[] };
            for step in steps {
                let tried = hyper.moved(place, *step);
                if let Some(found) = solved(&points, &targets, &tried)
                    && found.likelihood > best.likelihood
                {
                    (best, *hyper) = (found, tried);
                    break;
                }
            }
        }
        let weights = best.weights.iter().map(|weight| weight * deviation).collect();
        let variance = best.variance * deviation * deviation;
        let (factor, inverse_lengths) = (best.factor, hyper.inverse_lengths());
        Some(Self { scales, points, inverse_lengths, factor, weights, mean, variance })
    }

    /// Returns the expected value at a point, and its deviation.
    pub(super) fn at(&self, point: &[f64]) -> (f64, f64) {
        let point = scaled(point, &self.scales);
        let kernel: Vec<f64> =
            self.points.iter().map(|own| matern(&point, own, &self.inverse_lengths)).collect();
        let mean: f64 = kernel.iter().zip(&self.weights).map(|(a, b)| a * b).sum();
        let known = forward(&self.factor, kernel).iter().map(|own| own * own).sum::<f64>();
        (self.mean + mean, (self.variance * (1.0 - known).max(1e-9)).sqrt())
    }
}

/// The solution for given parameters of the kernel.
struct Solved {
    factor: Vec<f64>,
    weights: Vec<f64>,
    variance: f64,
    /// Logarithm of the likelihood, up to a constant.
    likelihood: f64,
}

/// Solves for the weights of scaled points. Returns `None` if rounding makes the covariance singular.
fn solved(points: &[Vec<f64>], targets: &[f64], hyper: &Hyper) -> Option<Solved> {
    let count = points.len();
    let inverse_lengths = hyper.inverse_lengths();
    let mut factor = Vec::with_capacity(count * (count + 1) / 2);
    for (row, point) in points.iter().enumerate() {
        factor.extend(points[..row].iter().map(|own| matern(point, own, &inverse_lengths)));
        factor.push(1.0 + hyper.noise.exp());
    }
    let mut logarithms = 0.0;
    for row in 0..count {
        let start = row * (row + 1) / 2;
        for column in 0..=row {
            let other = column * (column + 1) / 2;
            let (a, b) = (&factor[start..start + column], &factor[other..other + column]);
            let rest = factor[start + column] - a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            factor[start + column] = if column < row {
                rest / factor[other + column]
            } else if rest > 0.0 {
                logarithms += rest.ln();
                rest.sqrt()
            } else {
                return None;
            };
        }
    }
    let mut weights = forward(&factor, targets.to_vec());
    let variance = weights.iter().map(|own| own * own).sum::<f64>() / count as f64;
    for row in (0..count).rev() {
        let start = row * (row + 1) / 2;
        weights[row] /= factor[start + row];
        let own = weights[row];
        for (column, weight) in weights[..row].iter_mut().enumerate() {
            *weight -= factor[start + column] * own;
        }
    }
    // Lengths are log-normally distributed a priori.
    let unlikely = |length: &f64| ((length - LENGTHS.1.ln()) / 1.5).powi(2);
    let unlikely: f64 = hyper.lengths.iter().map(unlikely).sum();
    let likelihood = -0.5 * (count as f64 * variance.ln() + logarithms + unlikely);
    Some(Solved { factor, weights, variance, likelihood })
}

/// Solves a lower triangle for `values`.
fn forward(factor: &[f64], mut values: Vec<f64>) -> Vec<f64> {
    for row in 0..values.len() {
        let start = row * (row + 1) / 2;
        let known = factor[start..start + row].iter().zip(&values).map(|(a, b)| a * b).sum::<f64>();
        values[row] = (values[row] - known) / factor[start + row];
    }
    values
}

fn matern(a: &[f64], b: &[f64], inverse_lengths: &[f64]) -> f64 {
    let squares = a.iter().zip(b).zip(inverse_lengths);
    let square: f64 = squares.map(|((a, b), inverse)| ((a - b) * inverse).powi(2)).sum();
    let distance = (5.0 * square).sqrt();
    (1.0 + distance + distance * distance / 3.0) * (-distance).exp()
}

fn scaled(point: &[f64], scales: &[(f64, f64)]) -> Vec<f64> {
    point.iter().zip(scales).map(|(own, (mean, deviation))| (own - mean) / deviation).collect()
}

/// Returns mean and deviation.
fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, (values.map(|own| (own - mean).powi(2)).sum::<f64>() / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::chance::Chance;
    use super::{Hyper, Surrogate};

    /// A smooth function of three axes is known at 60 drawn points. At 100 others, the model's error is below a tenth of
    /// the function's deviation, and nine in ten errors are below three deviations that the model states.
    #[test]
    fn a_smooth_function_is_predicted_between_its_points() {
        let function = |point: &[f64]| (3.0 * point[0]).sin() + point[1] * point[1] - point[2];
        let mut chance = Chance::new(1);
        let mut drawn = |count: usize| -> Vec<Vec<f64>> {
            (0..count).map(|_| (0..3).map(|_| chance.part()).collect()).collect()
        };
        let (known, others) = (drawn(60), drawn(100));
        let points: Vec<&[f64]> = known.iter().map(Vec::as_slice).collect();
        let values: Vec<f64> = points.iter().map(|point| function(point)).collect();
        let mut hyper = Hyper::new(3);
        for _ in 0..5 {
            Surrogate::fit(&points, &values, &mut hyper, true);
        }
        let model = Surrogate::fit(&points, &values, &mut hyper, false).unwrap();
        let (mut squares, mut within) = (0.0, 0);
        for point in &others {
            let (mean, deviation) = model.at(point);
            let error = mean - function(point);
            squares += error * error;
            within += usize::from(error.abs() < 3.0 * deviation);
        }
        assert!((squares / 100.0_f64).sqrt() < 0.05 && within >= 90, "{squares} {within}");
        // The mean of sixty times 0.1 is not 0.1.
        for equal in [[1.0; 60], [0.1; 60], [f64::NAN; 60]] {
            assert!(Surrogate::fit(&points, &equal, &mut hyper, true).is_none(), "{equal:?}");
        }
    }

    /// An axis along which all points are equal, up to rounding, does not change what a model predicts between them.
    #[test]
    fn an_axis_with_one_value_is_left_out() {
        let mut chance = Chance::new(1);
        let drawn: Vec<f64> = (0..60).map(|_| chance.part()).collect();
        let values: Vec<f64> = drawn.iter().map(|own| (3.0 * own).sin()).collect();
        let predicted = |rest: &[f64]| {
            let points = drawn.iter().map(|own| [&[*own][..], rest].concat());
            let points: Vec<Vec<f64>> = points.collect();
            let points: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
            let mut hyper = Hyper::new(1 + rest.len());
            let model = Surrogate::fit(&points, &values, &mut hyper, false).unwrap();
            // Beside the axis's only value, by little.
            let beside = rest.iter().map(|own| own + 1e-6);
            model.at(&[0.5].into_iter().chain(beside).collect::<Vec<_>>())
        };
        let ((mean, deviation), (one, own)) = (predicted(&[1.0 / 3.0]), predicted(&[]));
        assert!((mean - one).abs() < 1e-6 && (deviation - own).abs() < 1e-6, "{mean} {one}");
    }
}
