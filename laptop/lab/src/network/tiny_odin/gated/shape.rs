//! The shape of a network whose neurons compare their potentials with their thresholds once a step. A shape is what all
//! neurons of the network share: the rows of synapses for each weight, and the sequence of events in a step.

use super::super::super::Trained;
use super::{LARGEST_RUNG, MAX_POTENTIAL, NEURONS, ROWS};

/// Rows of synapses to try for each weight: for each row, the number of events that a spike sends on it. All numbers
/// between the smallest and the largest sum of a choice are weights that it can hold.
const ROWS_TRIED: [&[u16]; 5] = [&[1], &[4, 1], &[8, 1], &[8, 8, 1], &[24, 8, 1]];
/// Factor by which the number of rungs (events that raise the neurons) exceeds the number that the recording needs. The
/// excess is for other recordings, in which a step may add more to a potential.
const SPARE: f64 = 1.5;
/// Distances between two leaks to try, in rungs (events that raise the neurons).
const DISTANCES: [f64; 3] = [3.0, 6.0, 12.0];
/// Largest absolute potentials to try that leaks reduce by a share, in units of the median threshold. Beyond them leaks
/// reduce a potential by an amount.
const REACHES: [f64; 2] = [1.0, 2.0];
/// Number of steps in which leaks come at different heights, before the heights repeat.
const TURNS: i32 = 3;
/// Maximum number of leaks that all neurons receive in a step.
const MAX_LEAKS: f64 = 99.0;

/// The sequence of events in each step, which is the same for all neurons. Each neuron begins a step with its potential
/// lowered by an offset, so that spikes alone cannot make it fire. A *rung* is an event that raises the potentials of
/// neurons by a fixed amount. After enough rungs, a neuron fires if its potential has reached its threshold.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shape {
    /// For each row of synapses, the number of events that a spike sends on the row. Every input and every sending
    /// neuron has these rows. A weight is the sum of its synapses, each multiplied by the number of events of its row.
    pub rows: &'static [u16],
    /// Whether the network has a bias, as an input that fires in every step.
    pub has_bias: bool,
    /// Number of rungs that raise a neuron at rest from 0 to the potential at which it compares with its threshold.
    /// They follow the rungs that [`below`](Self::below) counts.
    pub above: u16,
    /// Number of rungs (events that raise the neurons) that raise a neuron at rest to 0. A neuron at rest begins a step
    /// below 0, at the downward offset.
    pub below: u16,
    /// The leaks that all neurons receive: one list for each step. After the last list, the next step uses the first
    /// list again. A list has one entry for each leak: the number of events that lower the neurons before this leak.
    pub leaks: Vec<Vec<u16>>,
    /// Number of rungs that raise all neurons again at the end of a step. Each neuron that fired in the step then
    /// receives leaks of its own. 0 if spikes subtract the threshold.
    pub lift: u16,
    /// The leaks that reduce a potential by a share of its value; `None` if all neurons receive fewer than two leaks in
    /// a step.
    pub share: Option<Share>,
}

/// Leaks at several heights of a step, which together reduce a potential by a share of its value.
///
/// The leaks come from the lowest height to the highest. Leaks below a potential move it down, and only then do those
/// above move it up. Thus a leak meets the potential lower, by one leak for each leak before. If leaks of `a` are `s`
/// apart, a potential that is higher by `s + a` meets one more leak from above and one less from below. Therefore a
/// step takes the share `2 a / (s + a)`. So that a potential of 0 stays, the middle leak is below 0, by `a` for each
/// leak before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    /// Distance between two leaks, in rungs.
    pub spacing: f64,
    /// Number of leaks below the middle leak. The number of leaks above the middle leak is the same.
    pub levels: f64,
    /// Height of the middle leak, in rungs.
    pub middle: f64,
}

impl Share {
    /// Returns the leaks for neurons that keep `keep` of their potential in a step and reach potentials of up to
    /// `reach` rungs, if two leaks are about `distance` rungs apart. `None` if that takes too many leaks.
    fn new(keep: f64, reach: f64, distance: f64) -> Option<Self> {
        let lost = (1.0 - keep).max(0.01);
        let leak = (lost * distance * LARGEST_RUNG / 2.0).round().max(1.0) / LARGEST_RUNG;
        let spacing = 2.0 * leak / lost - leak;
        let levels = (reach / (spacing + leak)).ceil();
        (2.0 * levels < MAX_LEAKS).then_some(Self { spacing, levels, middle: -levels * leak })
    }

    /// Returns the heights of the leaks, in rungs, by step and leak. The list covers [`TURNS`] steps, after which the
    /// heights repeat.
    fn heights(self) -> Vec<Vec<i32>> {
        let levels = self.levels as i32;
        let leak = if levels > 0 { -self.middle / self.levels } else { 0.0 };
        let of_turn = |turn: i32| {
            let part = f64::from(turn) / f64::from(TURNS);
            let height = |level: i32| {
                (self.middle + f64::from(level) * self.spacing + part * (self.spacing + leak))
                    .round()
            };
            (-levels..=levels).map(|level| height(level) as i32).collect()
        };
        [0, 1, -1].map(of_turn).into()
    }

    /// Returns the leak at which a neuron with rungs of `rung` keeps `keep` of its potential in a step.
    pub(super) fn leak(self, keep: f64, rung: u8) -> f64 {
        (1.0 - keep) / (1.0 + keep) * self.spacing * f64::from(rung)
    }

    /// Returns where a potential of 0 lies after the leaks of a step. Each leak moves the neuron's potential by `leak`;
    /// each event that raises the neuron (a rung) moves it by `rung`.
    pub(super) fn drift(self, leak: u8, rung: u8) -> f64 {
        let (leak, rung) = (f64::from(leak), f64::from(rung));
        2.0 * leak / (self.spacing * rung + leak) * (self.levels * leak + self.middle * rung)
    }
}

impl Shape {
    pub(super) fn rungs(&self) -> u16 {
        self.above + self.below
    }

    pub(super) fn turn(&self, step: usize) -> &[u16] {
        if self.leaks.is_empty() { &[] } else { &self.leaks[step % self.leaks.len()] }
    }

    /// Returns the number of events that a spike sends.
    pub(super) fn events_a_spike(&self) -> u16 {
        self.rows.iter().sum()
    }

    /// Returns the weight nearest to `weight` that the rows can hold.
    pub(super) fn held(&self, weight: f64) -> i16 {
        let most = f64::from(self.events_a_spike());
        weight.round().clamp(-8.0 * most, 7.0 * most) as i16
    }

    /// Returns the number of events in a step of a network with `layers` layers. The number includes neither spikes nor
    /// the leaks that only the neurons that fired receive.
    pub(super) fn events(&self, layers: usize) -> usize {
        let leaks: usize = self.leaks.iter().map(Vec::len).sum();
        let bias = usize::from(self.has_bias) * usize::from(self.events_a_spike());
        usize::from(self.rungs()) * (layers + 1) + leaks / self.leaks.len().max(1) + bias
    }
}

/// Returns the number of rows of synapses that the network needs if each weight is split into `rows` rows.
pub(super) fn rows_of(trained: &Trained, has_bias: bool, rows: usize) -> usize {
    let last = trained.layers.len() - 1;
    let senders = trained.layers.iter().enumerate().map(|(at, layer)| {
        let groups = usize::from(at < last) + usize::from(!layer.recurrent.is_empty());
        groups * layer.neurons.len()
    });
    let sources = trained.inputs() + usize::from(has_bias) + senders.sum::<usize>();
    sources * rows + trained.layers.len() + 2
}

/// Returns all shapes to try. `drive` is the largest sum of weights that a step adds to a neuron, and `threshold` the
/// median threshold, both in units of a neuron's largest weight.
pub(super) fn shapes(trained: &Trained, has_bias: bool, drive: f64, threshold: f64) -> Vec<Shape> {
    let neurons = || trained.layers.iter().flat_map(|layer| &layer.neurons);
    if neurons().count() >= NEURONS - 1 {
        // The event that shows when a layer is done acts on one of the last two neurons, which must be free.
        return vec![];
    }
    let kept: Vec<f64> = neurons().map(|neuron| neuron.keep).filter(|keep| *keep < 1.0).collect();
    let resets_to_zero = trained.layers.iter().all(|layer| !layer.reset.subtracts());
    let mut shapes: Vec<Shape> = Vec::new();
    for rows in ROWS_TRIED {
        if rows_of(trained, has_bias, rows.len()) > ROWS {
            continue;
        }
        let largest = f64::from(rows.iter().sum::<u16>());
        let (raised, threshold) = ((SPARE * drive * largest).ceil().max(1.0), threshold * largest);
        let mut add = |share: Option<Share>, leaks: Vec<Vec<i32>>| {
            let lowest = leaks.iter().flatten().min().map_or(0, |lowest| -lowest.min(&0));
            let highest = leaks.iter().flatten().max().copied().unwrap_or(0);
            let has_bias = has_bias || share.is_some();
            let below = highest.max(raised as i32 - lowest);
            let room = f64::from(MAX_POTENTIAL) / LARGEST_RUNG;
            if f64::from(below) > room || f64::from(lowest) + threshold.max(1.0) > room {
                return;
            }
            let fallen = |heights: Vec<i32>| {
                heights.into_iter().map(|height| (height + lowest) as u16).collect()
            };
            let shape = Shape {
                rows,
                has_bias,
                above: lowest as u16,
                below: below as u16,
                leaks: leaks.into_iter().map(fallen).collect(),
                lift: if resets_to_zero { below as u16 } else { 0 },
                share,
            };
            if rows_of(trained, has_bias, rows.len()) <= ROWS && !shapes.contains(&shape) {
                shapes.push(shape);
            }
        };
        if kept.is_empty() && neurons().all(|neuron| neuron.leak == 0.0) {
            add(None, vec![]);
            continue;
        }
        add(None, vec![vec![0]]);
        if kept.is_empty() {
            continue;
        }
        let keep = kept.iter().sum::<f64>() / kept.len() as f64;
        for reach in REACHES {
            for distance in DISTANCES {
                if let Some(share) = Share::new(keep, reach * threshold, distance) {
                    add(Some(share), share.heights());
                }
            }
        }
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Leaks at several heights leave the share of a potential that they are made for, also of one below 0.
    #[test]
    fn leaks_leave_a_share_of_a_potential() {
        for (keep, distance) in [(0.5, 3.0), (0.8, 6.0), (0.9, 3.0), (0.9, 6.0), (0.95, 12.0)] {
            let (rung, share) = (7, Share::new(keep, 40.0, distance).unwrap());
            let leak = share.leak(keep, rung).round() as i32;
            assert!(share.drift(leak as u8, rung).abs() < 1e-9);
            for potential in (-280..=280).step_by(7) {
                let mut sum = 0;
                for heights in share.heights() {
                    sum += heights.iter().fold(potential, |potential, height| {
                        let away: i32 = potential - height * i32::from(rung);
                        potential - away.signum() * away.abs().min(leak)
                    });
                }
                let (mean, expected) =
                    (f64::from(sum) / f64::from(TURNS), keep * f64::from(potential));
                assert!((mean - expected).abs() <= f64::from(leak), "{keep} {potential} {mean}");
            }
        }
    }
}
