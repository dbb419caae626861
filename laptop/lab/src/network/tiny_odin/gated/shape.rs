//! The events of a step that all neurons of a gated network share: rows of a weight, rungs, leaks.

use super::super::super::Trained;
use super::{LARGEST_RUNG, NEURONS, ROWS};

/// Maximum number of leaks on one side of a potential of 0.
const LEVELS: u16 = 6;
/// Numbers of rows for a weight that are tried.
const ROWS_TRIED: [u16; 4] = [1, 2, 4, 8];
/// Factor by which there are more rungs than this recording needs, as others may add more in a step.
const SPARE: f64 = 1.5;
/// Maximum number of rungs between two leaks.
const WIDEST: f64 = 12.0;

/// The events of a step that neurons share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// Number of rows for each input or sending neuron; a weight is the sum of its rows.
    pub rows: u16,
    /// Number of rungs that raise a neuron above 0 before it compares; `below` is the number that raise it up to 0.
    pub above: u16,
    pub below: u16,
    /// For each turn of steps, after how many events of the fall there is a leak; the turns are repeated.
    pub leaks: Vec<Vec<u16>>,
    /// Number of events that lift neurons that fired up to 0, for their own leaks; 0 if a spike subtracts.
    pub lift: u16,
    /// Number of rungs between two leaks.
    pub spacing: u16,
}

impl Shape {
    pub(super) fn rungs(&self) -> u16 {
        self.above + self.below
    }

    pub(super) fn turn(&self, step: usize) -> &[u16] {
        if self.leaks.is_empty() { &[] } else { &self.leaks[step % self.leaks.len()] }
    }

    /// Returns the number of events of a step, without its spikes and without the leaks of neurons that fired.
    pub(super) fn events(&self, layers: usize) -> usize {
        let leaks: usize = self.leaks.iter().map(Vec::len).sum();
        usize::from(self.rungs()) * (layers + 1) + leaks / self.leaks.len().max(1)
    }
}

/// Returns the number of rows that a network needs if each weight takes `rows`.
pub(super) fn rows_of(trained: &Trained, has_bias: bool, rows: usize) -> usize {
    let last = trained.layers.len() - 1;
    let senders = trained.layers.iter().enumerate().map(|(at, layer)| {
        let groups = usize::from(at < last) + usize::from(!layer.recurrent.is_empty());
        groups * layer.neurons.len()
    });
    let sources = trained.inputs() + usize::from(has_bias) + senders.sum::<usize>();
    sources * rows + trained.layers.len() + 2
}

/// Returns all shapes to try. `drive` is the most that a step adds to a neuron, and `threshold` the usual threshold,
/// both in units of the largest weight.
pub(super) fn shapes(trained: &Trained, has_bias: bool, drive: f64, threshold: f64) -> Vec<Shape> {
    let neurons = || trained.layers.iter().flat_map(|layer| &layer.neurons);
    if neurons().count() >= NEURONS - 1 {
        // One of the last two must be free, to show when a layer is done.
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
            // So many rungs apart, leaks of this strength take a share of the potential.
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
