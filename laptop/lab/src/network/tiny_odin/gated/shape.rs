//! The steps that all neurons of a gated network share: rows of a weight, rungs, leaks.

use super::super::super::Trained;
use super::{LARGEST_RUNG, NEURONS, ROWS};

/// Leaks on one side of a potential of 0, at most.
const LEVELS: u16 = 6;
/// Rows of a weight that are tried.
const ROWS_TRIED: [u16; 4] = [1, 2, 4, 8];
/// Rungs for other recordings, which may bring more at once.
const SPARE: f64 = 1.5;
/// Rungs from one leak to the next, at most.
const WIDEST: f64 = 12.0;

/// The steps that neurons share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// Rows of an input or a neuron that sends spikes: bits of its weights.
    pub rows: u16,
    /// Events that raise a neuron above 0 before it compares, and up to 0.
    pub above: u16,
    pub below: u16,
    /// By turn of the steps: after how many events of the fall there is a leak.
    pub leaks: Vec<Vec<u16>>,
    /// Events that lift neurons that fired to 0 for leaks of their own; 0 where a spike subtracts.
    pub lift: u16,
    /// Rungs from leak to leak.
    pub spacing: u16,
}

impl Shape {
    pub(super) fn rungs(&self) -> u16 {
        self.above + self.below
    }

    pub(super) fn turn(&self, step: usize) -> &[u16] {
        if self.leaks.is_empty() { &[] } else { &self.leaks[step % self.leaks.len()] }
    }

    /// Events of a step beside its spikes and the leaks of neurons that fired.
    pub(super) fn events(&self, layers: usize) -> usize {
        let leaks: usize = self.leaks.iter().map(Vec::len).sum();
        usize::from(self.rungs()) * (layers + 1) + leaks / self.leaks.len().max(1)
    }
}

/// Rows that a network takes whose weights take so many each.
pub(super) fn rows_of(trained: &Trained, has_bias: bool, rows: usize) -> usize {
    let last = trained.layers.len() - 1;
    let senders = trained.layers.iter().enumerate().map(|(at, layer)| {
        let groups = usize::from(at < last) + usize::from(!layer.recurrent.is_empty());
        groups * layer.neurons.len()
    });
    let sources = trained.inputs() + usize::from(has_bias) + senders.sum::<usize>();
    sources * rows + trained.layers.len() + 2
}

/// All shapes that are tried, for a network that adds so much at most within a step, with its largest weight as 1, and
/// whose usual threshold is so many of its largest weights.
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
