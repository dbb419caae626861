//! Rounds the weights of a neuron to the chip's integers, all together.

use super::quantise::{KEEP, LARGEST, Rule, Source};
use super::recorded::{Drive, Group};
use std::collections::BTreeMap;

/// Rounds a number to an integer in the range of the chip's weights.
pub(super) fn clipped(number: f64) -> f64 {
    number.round().clamp(-LARGEST - 1.0, LARGEST)
}

/// Returns the amount that a neuron loses in a step because the chip rounds its potential down at each tick, on
/// average. `keep` is the chip's integer for the share that the neuron keeps in a tick.
fn lost(keep: u16, ticks: usize) -> f64 {
    let kept = f64::from(keep) / KEEP;
    if kept < 1.0 { (0..ticks as i32).map(|tick| 0.5 * kept.powi(tick)).sum() } else { 0.0 }
}

/// Returns two amounts: the amount by which gates lower a neuron, and the amount by which they raise the neuron again.
/// Gates are inputs that keep the neuron from firing at some ticks. Between the lowering and the raising, the neuron
/// leaks in `ticks - 1` ticks. These leaks undo part of the lowering, and the second amount undoes the rest. In
/// addition, the gates raise the neuron by `more`.
///
/// Both amounts are multiples of `1 << shift`. The first is at least `gate`. It is chosen so that the gates together
/// come as near as possible to `more`.
fn gates(gate: f64, more: f64, keep: u16, ticks: usize, shift: u8) -> (i32, i32) {
    if gate == 0.0 {
        return (0, 0);
    }
    let (unit, kept) = (f64::from(1 << shift), (f64::from(keep) / KEEP).powi(ticks as i32 - 1));
    let least = (gate / unit).ceil() as i32;
    let exact = |lowered: i32| f64::from(lowered) * kept + more / unit;
    let wrong = |lowered: i32| (exact(lowered) - exact(lowered).round()).abs();
    let all = least..=least + least / 4 + 8;
    let lowered = all.min_by(|one, other| wrong(*one).total_cmp(&wrong(*other))).unwrap_or(least);
    (lowered << shift, (exact(lowered).round() as i32) << shift)
}

/// Products of the traces that spikes leave in a neuron, summed over the steps of the recording. The trace of a weight
/// is the part of the potential that a weight of 1 contributes when the neuron compares it with its threshold. The
/// products tell how much the potentials change if the weights change.
///
/// The weights are listed in this order: those of the inputs, the bias, and those of [`Source::recurrent`].
pub(super) struct Traces {
    /// The products, by pairs of weights. If the neuron has gates, the part of each trace that is the same in every
    /// step is left out, because the gates make up for it.
    products: Vec<Vec<f64>>,
    /// For each weight, the constant trace that is nearest to its trace, as a share of the trace of the bias.
    means: Vec<f64>,
    steps: f64,
}

impl Traces {
    /// Limit of the work: the number of steps that are summed, times the number of products in a step. Of long
    /// recordings only the first steps are summed, but at least 100.
    const WORK: usize = 20_000_000;

    pub(super) fn new(source: &Source, keep: u16, rule: Rule, group: &Group) -> Self {
        let Group { ahead, drives, fired, .. } = group;
        let inputs = source.inputs.len();
        let senders = source.recurrent.iter().map(|(from, _)| *from);
        let at: BTreeMap<usize, usize> = senders.zip(inputs + 1..).collect();
        let count = inputs + 1 + source.recurrent.len();
        let kept = f64::from(keep) / KEEP;
        // The share that is left, when the neuron compares again, of what acts at a tick after it has compared.
        let left = |tick: usize| kept.powi((rule.ticks - tick) as i32);
        let (mut traces, mut products) = (vec![0.0; count], vec![vec![0.0; count]; count]);
        let steps = drives.len().min((Self::WORK / (count * count)).max(100));
        let mut before: Option<&Drive> = None;
        for (step, drive) in drives[..steps].iter().enumerate() {
            let has_fired = |step: usize| fired[step].contains(&(source.seat.neuron as u16));
            let is_reset = rule.resets_to_zero && step.checked_sub(1).is_some_and(has_fired);
            let kept = if is_reset { 0.0 } else { left(0) };
            for trace in &mut traces {
                *trace *= kept;
            }
            traces[inputs] += 1.0;
            for (drive, is_now) in
                before.map(|drive| (drive, false)).into_iter().chain([(drive, true)])
            {
                let share = |tick: usize| match (tick, is_now) {
                    (0, true) => 1.0,
                    (0, false) | (_, true) => 0.0,
                    (tick, false) => left(tick),
                };
                for input in &drive.inputs {
                    traces[usize::from(*input)] += share(*ahead);
                }
                for (tick, from) in &drive.spikes {
                    if let Some(weight) = at.get(from) {
                        traces[*weight] += share(*tick);
                    }
                }
            }
            before = Some(drive);
            for (row, one) in products.iter_mut().zip(&traces) {
                row.iter_mut().zip(&traces).for_each(|(sum, other)| *sum += one * other);
            }
        }
        // A weight that did not act in the recording may act in another one.
        let steps = steps.max(1) as f64;
        for (weight, row) in products.iter_mut().enumerate() {
            row[weight] += 0.01 * steps;
        }
        let constant = products[inputs].clone();
        let means: Vec<f64> = constant.iter().map(|product| product / constant[inputs]).collect();
        if source.gate > 0.0 {
            for (row, one) in products.iter_mut().zip(&constant) {
                row.iter_mut().zip(&means).for_each(|(product, mean)| *product -= one * mean);
            }
        }
        Self { products, means, steps }
    }
}

/// A neuron's weights in the chip's integers. They are rounded together, so that the errors of their sum cancel.
pub(super) struct Rounded {
    pub(super) inputs: Vec<i8>,
    pub(super) bias: i8,
    /// The bias that is rounded. If the neuron has no gates, it makes up for the potential that is lost because the
    /// chip rounds down.
    pub(super) exact_bias: f64,
    pub(super) recurrent: Vec<(usize, i8)>,
    /// Amounts by which gates lower and raise the neuron. Gates are inputs that keep the neuron from firing before its
    /// layer compares again. They also make up for the mean error of the other weights, and for the potential that is
    /// lost because the chip rounds down.
    pub(super) gates: (i32, i32),
    /// Mean squared error of the potential, in units of the threshold.
    pub(super) error: f64,
}

impl Rounded {
    /// Maximum number of rounds in which each weight may be moved by 1.
    const ROUNDS: usize = 100;

    pub(super) fn new(
        source: &Source,
        traces: &Traces,
        keep: u16,
        scale: f64,
        shifts: [u8; 2],
        ticks: usize,
    ) -> Self {
        let [input_unit, unit] = shifts.map(|shift| f64::from(1 << shift) / scale);
        let lost = lost(keep, ticks) / scale;
        let (bias, has_gate) = (source.inputs.len(), source.gate > 0.0);
        let own = if has_gate || source.bias == 0.0 { source.bias } else { source.bias + lost };
        let inputs = source.inputs.iter().chain([&own]).map(|weight| (*weight, input_unit));
        let recurrent = source.recurrent.iter().map(|(_, weight)| (*weight, unit));
        let weights: Vec<(f64, f64)> = inputs.chain(recurrent).collect();
        let mut held: Vec<f64> =
            weights.iter().map(|(weight, unit)| clipped(weight / unit)).collect();
        let off = |held: &[f64]| -> Vec<f64> {
            held.iter().zip(&weights).map(|(held, (weight, unit))| held * unit - weight).collect()
        };
        let start = off(&held);
        let slope = |products: &Vec<f64>| products.iter().zip(&start).map(|(p, off)| p * off).sum();
        let mut slopes: Vec<f64> = traces.products.iter().map(slope).collect();
        let (mut is_better, mut rounds) = (true, 0);
        while is_better && rounds < Self::ROUNDS {
            (is_better, rounds) = (false, rounds + 1);
            for (at, (weight, unit)) in weights.iter().enumerate() {
                if *weight == 0.0 || has_gate && at == bias {
                    continue;
                }
                let by = -slopes[at].signum();
                let moved = held[at] + by;
                let products = &traces.products[at];
                let change = 2.0 * by * unit * slopes[at] + unit * unit * products[at];
                if change < -1e-12 && clipped(moved) == moved {
                    (held[at], is_better) = (moved, true);
                    slopes.iter_mut().zip(products).for_each(|(slope, p)| *slope += by * unit * p);
                }
            }
        }
        let off = off(&held);
        let error: f64 = off.iter().zip(&slopes).map(|(off, slope)| off * slope).sum();
        let mean: f64 = off.iter().zip(&traces.means).map(|(off, mean)| off * mean).sum();
        let more = (lost - mean + source.raise) * scale;
        let (inputs, recurrent) = held.split_at(bias + 1);
        Self {
            inputs: inputs[..bias].iter().map(|weight| *weight as i8).collect(),
            bias: held[bias] as i8,
            exact_bias: own,
            recurrent: source
                .recurrent
                .iter()
                .zip(recurrent)
                .map(|((from, _), weight)| (*from, *weight as i8))
                .collect(),
            gates: gates(source.gate * scale, more, keep, ticks, shifts[0]),
            error: error / traces.steps,
        }
    }
}
