//! An evolution strategy for the taps of a filter, with a step size for each axis: separable CMA-ES, after Ros and
//! Hansen (2008).

use super::chance::Chance;

/// Number of points in a generation.
const POINTS: usize = 16;
/// Number of the best points of a generation, from which the mean of the next generation is computed.
const PARENTS: usize = POINTS / 2;

/// An optimiser that seeks the smallest value of a function. The caller computes the values.
pub(super) struct Strategy {
    chance: Chance,
    mean: Vec<f64>,
    /// Step size common to all axes.
    step: f64,
    /// Variance of the points of a generation along each axis, before the factor `step` is applied.
    variances: Vec<f64>,
    /// Evolution path: a decaying sum of the mean's recent moves. The length of this path determines how the step size
    /// changes.
    path: Vec<f64>,
    /// Second evolution path, which decays at another rate than `path`. This path helps to adapt the variances.
    long_path: Vec<f64>,
    weights: Vec<f64>,
    mass: f64,
    generation: i32,
}

impl Strategy {
    /// Starts at the point `from`, with an initial step size for each axis.
    pub(super) fn new(seed: u64, from: Vec<f64>, steps: &[f64]) -> Self {
        let weight = |place: usize| (PARENTS as f64 + 0.5).ln() - (place as f64 + 1.0).ln();
        let sum: f64 = (0..PARENTS).map(weight).sum();
        let weights: Vec<f64> = (0..PARENTS).map(|place| weight(place) / sum).collect();
        let zeros = vec![0.0; from.len()];
        Self {
            chance: Chance::new(seed),
            mass: 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>(),
            mean: from,
            step: 1.0,
            variances: steps.iter().map(|step| step * step).collect(),
            path: zeros.clone(),
            long_path: zeros,
            weights,
            generation: 0,
        }
    }

    /// Returns the next points at which the caller is to compute the function.
    pub(super) fn ask(&mut self) -> Vec<Vec<f64>> {
        let Self { chance, mean, variances, step, .. } = self;
        let mut point = || {
            let axes = mean.iter().zip(variances.iter());
            axes.map(|(mean, variance)| mean + *step * variance.sqrt() * chance.normal()).collect()
        };
        (0..POINTS).map(|_| point()).collect()
    }

    /// Takes the points that `ask` returned, each with the function's value there. Adapts the mean, the step size and
    /// the variances from which `ask` draws the next points.
    pub(super) fn tell(&mut self, mut points: Vec<(Vec<f64>, f64)>) {
        points.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let axes = self.mean.len() as f64;
        let (mass, best) = (self.mass, points.iter().zip(&self.weights));
        let best: Vec<(&Vec<f64>, f64)> = best.map(|((point, _), own)| (point, *own)).collect();
        let for_step = (mass + 2.0) / (axes + mass + 5.0);
        let damping = 1.0 + for_step + 2.0 * (((mass - 1.0) / (axes + 1.0)).sqrt() - 1.0).max(0.0);
        let for_path = (4.0 + mass / axes) / (axes + 4.0 + 2.0 * mass / axes);
        // Without correlations between axes, the variances can be learnt faster than a full matrix.
        let faster = (axes + 2.0) / 3.0;
        let from_path = (faster * 2.0 / ((axes + 1.3).powi(2) + mass)).min(0.5);
        let from_points = (faster * 2.0 * (mass - 2.0 + 1.0 / mass)
            / ((axes + 2.0).powi(2) + mass))
            .min(1.0 - from_path);
        let normal = axes.sqrt() * (1.0 - 1.0 / (4.0 * axes) + 1.0 / (21.0 * axes * axes));
        self.generation += 1;
        let old = self.mean.clone();
        for (axis, mean) in self.mean.iter_mut().enumerate() {
            *mean = best.iter().map(|(point, weight)| weight * point[axis]).sum();
        }
        for (axis, path) in self.path.iter_mut().enumerate() {
            let moved = (self.mean[axis] - old[axis]) / self.step;
            *path = (1.0 - for_step) * *path
                + (for_step * (2.0 - for_step) * mass).sqrt() * moved / self.variances[axis].sqrt();
        }
        let length = self.path.iter().map(|own| own * own).sum::<f64>().sqrt();
        let expected = (1.0 - (1.0 - for_step).powi(2 * self.generation)).sqrt();
        let is_short = length / expected < (1.4 + 2.0 / (axes + 1.0)) * normal;
        for (axis, path) in self.long_path.iter_mut().enumerate() {
            let moved = (self.mean[axis] - old[axis]) / self.step;
            let gain = (for_path * (2.0 - for_path) * mass).sqrt() * moved;
            *path = (1.0 - for_path) * *path + if is_short { gain } else { 0.0 };
        }
        for (axis, variance) in self.variances.iter_mut().enumerate() {
            let spread = best
                .iter()
                .map(|(point, weight)| weight * ((point[axis] - old[axis]) / self.step).powi(2));
            *variance = (1.0 - from_path - from_points) * *variance
                + from_path * self.long_path[axis].powi(2)
                + from_points * spread.sum::<f64>();
            *variance = variance.max(1e-30);
        }
        self.step *= ((for_step / damping) * (length / normal - 1.0)).exp().min(2.0);
    }
}

#[cfg(test)]
mod tests {
    use super::Strategy;

    #[test]
    fn a_narrow_bowl_is_descended() {
        let value = |point: &[f64]| -> f64 {
            point.iter().zip(0..).map(|(own, axis)| 10_f64.powi(axis) * (own - 1.0).powi(2)).sum()
        };
        let mut strategy = Strategy::new(1, vec![0.0; 6], &[0.3; 6]);
        let mut least = f64::INFINITY;
        for _ in 0..250 {
            let points = strategy.ask().into_iter().map(|point| {
                let value = value(&point);
                (point, value)
            });
            let points: Vec<(Vec<f64>, f64)> = points.collect();
            least = points.iter().map(|(_, value)| *value).fold(least, f64::min);
            strategy.tell(points);
        }
        assert!(least < 1e-6, "{least}");
    }
}
