//! The shape of a network whose neurons compare their potentials with their thresholds once a step. A shape is what all
//! neurons of the network share: the number of rows of synapses for each weight, and the sequence of events in a step.

use super::super::super::Trained;
use super::{LARGEST_RUNG, NEURONS, ROWS};

/// Maximum number of leaks that a step sends while a neuron at rest has a potential above 0. The step sends the same
/// number of leaks while the potential is below 0, and one leak while it is at or near 0.
const LEVELS: u16 = 6;
/// Numbers of rows of synapses to try for each weight.
const ROWS_TRIED: [u16; 4] = [1, 2, 4, 8];
/// Number of rungs (events that raise the neurons) in a shape, as a multiple of the number that the recording needs.
/// The spare rungs serve other recordings, in which a step may add more to a potential.
const SPARE: f64 = 1.5;
/// Maximum number of rungs (events that raise the neurons) between two leaks.
const WIDEST: f64 = 12.0;

/// The sequence of events in each step, which is the same for all neurons. An offset downwards first keeps the neurons
/// from firing. Then events called *rungs* raise the neurons, each by a fixed amount, until they can fire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// Number of rows of synapses that each input or sending neuron has. Each of its weights is split over these rows.
    pub rows: u16,
    /// Number of rungs that raise a neuron at rest from 0 to the potential at which it compares with its threshold.
    /// They follow the rungs that [`below`](Self::below) counts.
    pub above: u16,
    /// Number of rungs that raise a neuron at rest from the offset to 0.
    pub below: u16,
    /// The leaks that all neurons receive: one list for each step. After the last list, the next step uses the first
    /// list again. A list has one entry for each leak: the number of events that lower the neurons before this leak.
    pub leaks: Vec<Vec<u16>>,
    /// Number of rungs that raise all neurons again at the end of a step. Each neuron that fired in the step then
    /// receives leaks of its own. 0 if spikes subtract the threshold.
    pub lift: u16,
    /// Number of rungs between two leaks of a step. Several leaks in a step together reduce a potential by a share of
    /// its value. 0 if a step sends fewer than two leaks to all neurons.
    pub spacing: u16,
}

impl Shape {
    pub(super) fn rungs(&self) -> u16 {
        self.above + self.below
    }

    pub(super) fn turn(&self, step: usize) -> &[u16] {
        if self.leaks.is_empty() { &[] } else { &self.leaks[step % self.leaks.len()] }
    }

    /// Returns the number of events in a step of a network with `layers` layers. Does not count spikes, or leaks that
    /// are sent only to neurons that fired.
    pub(super) fn events(&self, layers: usize) -> usize {
        let leaks: usize = self.leaks.iter().map(Vec::len).sum();
        usize::from(self.rungs()) * (layers + 1) + leaks / self.leaks.len().max(1)
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
    let lost: Vec<f64> =
        neurons().map(|neuron| 1.0 - neuron.keep).filter(|lost| *lost > 0.0).collect();
    let resets_to_zero = trained.layers.iter().all(|layer| !layer.reset.subtracts());
    let mut shapes = Vec::new();
    for rows in ROWS_TRIED {
        if rows_of(trained, has_bias, rows.into()) > ROWS {
            break;
        }
        let unit = LARGEST_RUNG * f64::from(rows);
        let raised = (SPARE * drive * unit / LARGEST_RUNG).ceil().clamp(1.0, 200.0) as u16;
        let mut add = |above: u16, below: u16, leaks: Vec<Vec<u16>>, spacing: u16| {
            let lift = if resets_to_zero { below } else { 0 };
            let shape = Shape { rows, above, below, leaks, lift, spacing };
            if !shapes.contains(&shape) {
                shapes.push(shape);
            }
        };
        if lost.is_empty() && neurons().all(|neuron| neuron.leak == 0.0) {
            add(0, raised, vec![], 0);
            continue;
        }
        add(0, raised, vec![vec![0]], 0);
        if lost.is_empty() {
            continue;
        }
        let mean = lost.iter().sum::<f64>() / lost.len() as f64;
        for strength in [1.0, 2.0] {
            // Leaks of this strength that are `spacing` rungs apart remove about the share that the original loses.
            let spacing = (2.0 * strength / mean / LARGEST_RUNG).round().clamp(1.0, WIDEST) as u16;
            let levels = (threshold * unit / LARGEST_RUNG / f64::from(spacing)).ceil();
            let levels = levels.clamp(1.0, LEVELS.into()) as u16;
            let shift = spacing / 3;
            let above = levels * spacing + shift;
            let below = above.max(raised.saturating_sub(above));
            let turns =
                if shift > 0 { vec![0, i32::from(shift), -i32::from(shift)] } else { vec![0] };
            let leaks = turns.into_iter().map(|shift| {
                let levels = i32::from(levels);
                let height = |level: i32| level * i32::from(spacing) + shift;
                (-levels..=levels)
                    .rev()
                    .map(|level| (i32::from(above) - height(level)) as u16)
                    .collect()
            });
            add(above, below, leaks.collect(), spacing);
        }
    }
    shapes
}
