//! The shape of a network whose neurons compare their potentials with their thresholds once a step. A shape is what all
//! neurons of the network share: the rows of synapses for each weight, and the sequence of events in a step.

use super::super::super::Trained;
use super::{LARGEST_RUNG, MAX_POTENTIAL, NEURONS, ROWS};

/// Ways of splitting each weight into rows of synapses, to be tried in turn. A way has one number for each row: the
/// number of events that a spike sends on this row. Each way can represent all integers from its smallest to its
/// largest possible weight.
const ROWS_TRIED: [&[u16]; 5] = [&[1], &[4, 1], &[8, 1], &[8, 8, 1], &[24, 8, 1]];
/// Factor by which the number of rungs is larger than this recording needs. A rung is an event that raises the neurons.
/// The additional rungs are for other recordings, in which a step may add more to a potential.
const SPARE: f64 = 1.5;
/// Differences in height to try between neighbouring leaks, in units of the amount by which one rung (an event) raises
/// a neuron.
const DISTANCES: [f64; 3] = [3.0, 6.0, 12.0];
/// Limits to try for the absolute potential, in units of the median threshold. Up to the limit, leaks reduce a
/// potential by a share of its value. Beyond the limit, they reduce it by a fixed amount.
const REACHES: [f64; 2] = [1.0, 2.0];
/// Number of steps after which the heights of the leaks repeat. Until then, each step has leaks at other heights.
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
    /// Number of rungs (events that raise the neurons) that follow those of [`below`](Self::below). They raise a neuron
    /// at rest from 0 to a positive potential. On the chip, the neuron's threshold is higher by the same amount.
    pub above: u16,
    /// Number of rungs (events that raise the neurons) that raise a neuron at rest to 0. A neuron at rest begins a step
    /// below 0, at the downward offset.
    pub below: u16,
    /// The leaks that all neurons receive: one list for each step of a cycle, which then repeats. A list has one entry
    /// for each leak: the number of events in the step that lower the neurons before the leak comes.
    pub leaks: Vec<Vec<u16>>,
    /// Number of rungs (events that raise the neurons) that raise all neurons again at the end of a step. Additional
    /// leaks then act on each neuron that fired in the step. 0 if spikes subtract the threshold.
    pub lift: u16,
    /// The leaks that reduce a potential by a share of its value. `None` if no step has more than one leak that acts on
    /// all neurons.
    pub share: Option<Share>,
}

/// Leaks at several heights, which together reduce a potential by a share of its value in each step. The height of a
/// leak is the potential towards which the leak moves a neuron.
///
/// The lowest leak acts first. The leaks below a potential move it down, each by an amount `a`. Then the leaks above
/// the potential move it up, each by `a`. Neighbouring leaks are `s` apart. From one leak to the next, the height rises
/// by `s` and the potential falls by `a`. A potential that is higher by `s + a` therefore meets one more leak that
/// moves it down, and one fewer that moves it up. In sum, a step takes the share `2 a / (s + a)` of the potential.
///
/// A potential of 0 must stay 0. For this purpose, the height of the middle leak is below 0, by `a` for each leak that
/// acts before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    /// Difference in height between neighbouring leaks, in units of the amount by which one rung (an event) raises a
    /// neuron.
    pub spacing: f64,
    /// Number of leaks below the middle leak. The number of leaks above the middle leak is the same.
    pub levels: f64,
    /// Potential towards which the middle leak moves a neuron, in units of the amount by which one rung (an event)
    /// raises a neuron.
    pub middle: f64,
}

impl Share {
    /// Returns the leaks for neurons that keep the share `keep` of their potential in a step, and reach potentials of
    /// up to `reach`. Neighbouring leaks are about `distance` apart. The unit of `reach` and `distance` is the amount
    /// by which one rung (an event) raises a neuron. Returns `None` if more than [`MAX_LEAKS`] leaks are necessary.
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

    /// Returns the amount by which each leak must move a neuron so that the neuron keeps the share `keep` of its
    /// potential in a step. `rung` is the amount by which each rung (an event) raises the neuron.
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

    /// Rounds `weight` to an integer, and clips it to the range of weights that the rows of synapses can represent.
    pub(super) fn held(&self, weight: f64) -> i16 {
        let most = f64::from(self.events_a_spike());
        weight.round().clamp(-8.0 * most, 7.0 * most) as i16
    }

    /// Returns the number of events in a step of a network with `layers` layers. Two kinds of events are not counted:
    /// spikes, and the leaks that a neuron receives only after it has fired.
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

    /// Leaks at several heights reduce a potential to the share `keep` of its value, also if the potential is below 0.
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
