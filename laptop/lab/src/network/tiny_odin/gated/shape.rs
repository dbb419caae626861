//! The shape of a network whose neurons compare their potentials with their thresholds once a step. The shape is the
//! same for all neurons of the network. It describes how each weight is split into synapses, and which events make up a
//! step.

use super::super::super::Trained;
use super::{LARGEST_RUNG, MAX_POTENTIAL, NEURONS, ROWS};

/// Ways of splitting each weight into rows of synapses, to be tried in turn. A way has one number for each row: the
/// number of events that a spike sends on this row. Each way can represent all integers from its smallest to its
/// largest possible weight.
const ROWS_TRIED: [&[u16]; 5] = [&[1], &[4, 1], &[8, 1], &[8, 8, 1], &[24, 8, 1]];
/// Safety factor for the number of rungs, the events that raise the neurons in a step. A step has this factor times as
/// many rungs as the recording needs. In other recordings, a step may add more to a potential.
const SPARE: f64 = 1.5;
/// Differences in height between neighbouring leaks, to be tried in turn. The unit is the amount by which one rung (an
/// event) raises a neuron.
const DISTANCES: [f64; 3] = [3.0, 6.0, 12.0];
/// Sizes to try for the range in which leaks reduce a potential by a share of its value. The unit is the median
/// threshold. Potentials whose absolute value is beyond the range are reduced by a fixed amount.
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
    /// For each row of synapses, the number of events that a spike sends on the row. Each input has these rows, and so
    /// has each neuron that sends spikes to other neurons. A weight is a sum over the rows: the synapse in each row,
    /// times the row's number of events.
    pub rows: &'static [u16],
    /// Whether the network has a bias. The bias is an input that fires in every step.
    pub has_bias: bool,
    /// Number of rungs (events that raise the neurons) after the first [`below`](Self::below) rungs of a step. These
    /// later rungs raise a neuron at rest from 0 to a positive potential. The threshold that the chip stores is higher
    /// by the same amount.
    pub above: u16,
    /// Number of rungs from the downward offset to 0. A rung is an event that raises the neurons. A neuron at rest
    /// begins a step at the offset, and this number of rungs raises it to 0.
    pub below: u16,
    /// The leaks that all neurons receive: one list for each step of a cycle of steps. A list has one entry for each
    /// leak: 0 if the leak comes before the step's first event that lowers the neurons, 1 if it comes between the first
    /// and the second such event, and so on.
    pub leaks: Vec<Vec<u16>>,
    /// Number of events at the end of a step that raise all neurons again, by one rung each. Then additional leaks act
    /// on each neuron that fired in the step, and the same number of events lowers all neurons. This number is 0 if
    /// spikes subtract the threshold.
    pub lift: u16,
    /// The leaks that reduce a potential by a share of its value. `None` if each step has at most one leak for all
    /// neurons.
    pub share: Option<Share>,
}

/// Leaks that together reduce a potential by a share of its value in each step. Each leak moves a neuron's potential by
/// a fixed amount towards another potential, which is the leak's *height*. The leaks of a step differ in height.
///
/// The lowest leak acts first. The leaks below a potential move it down, each by an amount `a`. Then the leaks above
/// the potential move it up, each by `a`. The heights of neighbouring leaks differ by `s`. From one leak below a
/// potential to the next, the distance between potential and height therefore shrinks by `s + a`. A potential that is
/// higher by `s + a` meets one more leak that moves it down, and one fewer that moves it up. In sum, a step takes the
/// share `2 a / (s + a)` of the potential.
///
/// A potential of 0 must stay 0. The leaks below the middle leak act first, and each moves this potential down by `a`.
/// The height of the middle leak is the negative potential that results. The leaks above the middle leak then move the
/// potential back up to 0.
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

    /// Returns the heights of the leaks: one list for each of [`TURNS`] steps, after which the lists repeat. The height
    /// of a leak is the potential towards which the leak moves a neuron. The unit is the amount by which one rung (an
    /// event) raises the neuron.
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

    /// Returns the amount by which the leaks of a step move a potential of 0. `leak` is the amount by which a single
    /// leak moves the potential. `rung` is the amount by which one rung (an event) raises the potential.
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

/// Returns all shapes to try. `drive` is the largest sum of positive weights that a step adds to a neuron. `threshold`
/// is the median threshold. Both are in units of a neuron's largest weight.
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
