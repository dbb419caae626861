//! The search for the parameters of neurons that compare their potentials with their thresholds once a step.

use super::super::super::trained::{Layer, Neuron, fires_at};
use super::super::super::{Distance, Trains};
use super::super::climb::climb;
use super::neuron::{Added, GatedNeuron};
use super::shape::Shape;
use super::{LARGEST_RUNG, MAX_LEAK, MAX_POTENTIAL};
use crate::network::Reset;

/// Values to try for a neuron's largest weight on the chip. Each value is for one event, and is multiplied by the
/// number of events that a spike sends. A value above 7 clips the largest weights to the chip's range, but rounds the
/// smaller weights more finely. The last value rounds all weights to 0 if a spike sends fewer than 5 events. The neuron
/// then stays silent.
const LARGEST: [f64; 10] = [7.0, 6.0, 8.0, 5.0, 9.0, 4.0, 3.0, 12.0, 1.0, 0.1];
/// Amounts to try first for a rung, an event that raises the neurons' potentials.
const RUNGS: [u8; 4] = [7, 5, 3, 2];
/// Number of initial choices of a neuron's parameters from which the search climbs to better ones.
pub(super) const CLIMBS: usize = 2;
/// Number of initial choices of a neuron's parameters that a rough search tries. It tries the choices that change the
/// neuron least, and improves none of them. The network that it finds serves to rate a [shape](Shape).
const RATED: usize = 6;

/// The spikes that act on a layer, listed by step. First come the inputs that fire in the step. In a recurrent layer,
/// the layer's own neurons that fired one step earlier follow: neuron 0 has the first number after those of the inputs.
pub(super) struct Drive {
    ends: Vec<usize>,
    spikes: Vec<u16>,
}

impl Drive {
    pub(super) fn new(inputs: &Trains, layer: &Layer, fired: &Trains) -> Self {
        let (mut ends, mut spikes) = (Vec::new(), Vec::new());
        let first = layer.inputs() as u16;
        for (step, inputs) in inputs.iter().enumerate() {
            spikes.extend(inputs);
            if let (Some(last), false) = (step.checked_sub(1), layer.recurrent.is_empty()) {
                spikes.extend(fired[last].iter().map(|own| first + own));
            }
            ends.push(spikes.len());
        }
        Self { ends, spikes }
    }
}

/// The aim of a search: the spikes that a neuron should fire in response to the spikes that act on it.
pub(super) struct Aim<'a> {
    pub drive: &'a Drive,
    /// For each step, whether the neuron should fire.
    pub target: &'a [bool],
    /// For each step, the potential that the neuron should compare with its threshold, as a multiple of the threshold.
    pub potentials: &'a [f64],
    pub shape: &'a Shape,
}

/// The parameters of a neuron that the search varies.
#[derive(Clone, Copy, PartialEq)]
struct Choice {
    /// Factor that converts a weight on the chip to the units of the trained network.
    unit: f64,
    threshold: u16,
    leak: u8,
    rung: u8,
    /// Change of the number of leaks that the neuron alone receives after a spike. The number of leaks is the result of
    /// [`own_leaks`] plus this change.
    more: i16,
    /// Change of the neuron's bias, in the chip's units. The bias on the chip is the sum of three amounts: the trained
    /// bias, this change, and a correction for leaks that would otherwise move a potential of 0.
    bias: i16,
}

/// Searches for the parameters with which the spikes of neuron `at` are nearest to the target of `aim`. Returns the
/// distance between the spikes and the target, and the neuron. `climbs` is the number of initial choices of parameters
/// that the search improves. If `climbs` is 0, the search takes the best initial choice as it is.
pub(super) fn search(layer: &Layer, at: usize, aim: &Aim, climbs: usize) -> (f64, GatedNeuron) {
    let threshold = layer.neurons[at].threshold;
    let distance = |choice: Choice, most| {
        made(layer, at, aim.shape, choice).distance(aim, choice.unit / threshold, most)
    };
    let neighbours = |choice: Choice| choice.neighbours(aim.shape);
    let mut first = choices(layer, at, aim.shape);
    if climbs == 0 {
        first.truncate(RATED);
    }
    let (least, best) = climb(first, neighbours, distance, climbs);
    (least, made(layer, at, aim.shape, best))
}

/// Returns the initial choices of parameters for neuron `at`. The first choices are those that differ least from the
/// trained parameters. If several choices give the same spikes, the search takes the first of them, because the
/// smallest difference is the most likely to suit other recordings.
fn choices(layer: &Layer, at: usize, shape: &Shape) -> Vec<Choice> {
    let own = layer.recurrent.get(at).into_iter().flatten();
    let weights = layer.weights[at].iter().chain(own).chain(&layer.bias[at..=at]);
    let weights: Vec<f64> = weights.copied().collect();
    let largest = weights.iter().fold(0.0_f64, |most, weight| most.max(weight.abs()));
    let Neuron { keep, threshold, leak: amount } = layer.neurons[at];
    let rungs = if shape.share.is_some() { &RUNGS[..2] } else { &RUNGS };
    let mut choices: Vec<(f64, Choice)> = Vec::new();
    for most in LARGEST {
        let most = most * f64::from(shape.events_a_spike());
        let unit = if largest > 0.0 { largest / most } else { threshold / LARGEST_RUNG };
        let threshold = fires_at(threshold / unit, layer.fires);
        let rounded = weights
            .iter()
            .map(|weight| (f64::from(shape.held(weight / unit)) * unit - weight).powi(2));
        let rounded: f64 = rounded.sum();
        for &rung in rungs {
            let room = MAX_POTENTIAL - shape.above * u16::from(rung);
            let threshold = threshold.min(room.into()) as u16;
            // The amount that a leak removes: the one at which the neuron loses its share of a potential or, with less
            // than two leaks a step, the amount that it loses at half its threshold.
            let of_share = match shape.share {
                Some(leaks) => leaks.leak(keep, rung),
                None => (1.0 - keep) / 2.0 * f64::from(threshold),
            };
            let lost = amount / unit + of_share;
            // If no step has leaks for all neurons, only the leaks after a spike remain, which may be as large as
            // possible.
            let leaks = if shape.leaks.is_empty() {
                [f64::from(MAX_LEAK); 2]
            } else {
                [lost.floor(), lost.ceil()].map(|leak| leak.min(MAX_LEAK.into()))
            };
            for leak in leaks.map(|leak| leak as u8) {
                let choice = Choice { unit, threshold, leak, rung, more: 0, bias: 0 };
                if choices.iter().all(|(_, other)| *other != choice) {
                    let change = rounded + ((f64::from(leak) - lost) * unit).powi(2);
                    choices.push((change, choice));
                }
            }
        }
    }
    choices.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    choices.into_iter().map(|(_, choice)| choice).collect()
}

impl Choice {
    fn neighbours(self, shape: &Shape) -> Vec<Self> {
        let Self { unit, threshold, leak, rung, more, bias } = self;
        let with = |threshold_by: i16, leak_by: i8, rung_by: i8, more_by: i16, unit_by: f64| {
            let rung = rung.saturating_add_signed(rung_by).clamp(1, LARGEST_RUNG as u8);
            let room = MAX_POTENTIAL - shape.above * u16::from(rung);
            Self {
                unit: unit * unit_by,
                threshold: threshold.saturating_add_signed(threshold_by).clamp(1, room),
                leak: leak.saturating_add_signed(leak_by).min(MAX_LEAK),
                rung,
                more: more + more_by,
                bias,
            }
        };
        let wide = (threshold / 16).max(2) as i16;
        let mut all = vec![
            with(1, 0, 0, 0, 1.0),
            with(-1, 0, 0, 0, 1.0),
            with(wide, 0, 0, 0, 1.0),
            with(-wide, 0, 0, 0, 1.0),
            with(0, 0, 0, 0, 1.05),
            with(0, 0, 0, 0, 1.0 / 1.05),
            with(0, 0, 1, 0, 1.0),
            with(0, 0, -1, 0, 1.0),
        ];
        if !shape.leaks.is_empty() {
            all.extend([
                with(0, 1, 0, 0, 1.0),
                with(0, -1, 0, 0, 1.0),
                with(1, -1, 0, 0, 1.0),
                with(-1, 1, 0, 0, 1.0),
            ]);
        }
        if shape.has_bias {
            all.extend([Self { bias: bias + 1, ..self }, Self { bias: bias - 1, ..self }]);
        }
        if shape.lift == 0 {
            all.extend([with(0, 0, 0, 1, 1.0), with(0, 0, 0, -1, 1.0), with(0, 0, 0, 4, 1.0)]);
        }
        all
    }
}

/// Returns neuron `at` in the chip's integers, with the parameters in `choice`.
fn made(layer: &Layer, at: usize, shape: &Shape, choice: Choice) -> GatedNeuron {
    let Choice { unit, threshold, leak, rung, more, .. } = choice;
    let mut clipped = 0;
    let mut quantised = |weight: &f64| {
        let held = shape.held(weight / unit);
        clipped += usize::from(f64::from(held) != (weight / unit).round());
        held
    };
    let own = layer.recurrent.get(at).into_iter().flatten();
    let weights = layer.weights[at].iter().chain(own).map(&mut quantised).collect();
    let drift = shape.share.map_or(0.0, |leaks| leaks.drift(leak, rung));
    let bias = quantised(&(layer.bias[at] + (f64::from(choice.bias) - drift) * unit));
    let own_leaks = own_leaks(layer, at, shape, choice)
        .saturating_add(more.into())
        .clamp(0, i32::from(MAX_POTENTIAL)) as u16;
    GatedNeuron { weights, bias, threshold, leak, rung, own_leaks, clipped }
}

/// Returns the number of additional leaks that neuron `at` receives in a step in which it fires. The chip's reset sets
/// the potential to 0, and later events of the step move it. If the trained network also resets to 0, the additional
/// leaks bring the potential back to 0. If it subtracts the threshold, they bring the potential near the value that the
/// subtraction would leave.
fn own_leaks(layer: &Layer, at: usize, shape: &Shape, choice: Choice) -> i32 {
    let Choice { threshold, leak, rung, .. } = choice;
    if leak == 0 || shape.rungs() == 0 {
        return 0;
    }
    let (above, rung, leak) = (i32::from(shape.above), f64::from(rung), f64::from(leak));
    let above = f64::from(above) * rung;
    let keep = layer.neurons[at].keep;
    if shape.lift > 0 {
        let beyond = (f64::from(shape.rungs()) - 1.0) * rung;
        let levels = shape.leaks.iter().map(Vec::len).max().unwrap_or(0);
        let farthest = above.max(beyond.min(f64::from(threshold)));
        return (farthest / leak).ceil() as i32 + levels as i32;
    }
    // After a spike, the whole rungs in the excess over the threshold remain. Leaks before that have acted on it as on
    // a potential far below 0.
    let late =
        if layer.reset == Reset::SubtractLate { f64::from(threshold) * (1.0 - keep) } else { 0.0 };
    let passed = if shape.share.is_some() { (1.0 - keep) * above } else { 0.0 };
    ((above - passed + rung / 2.0 - late) / leak).round().max(0.0) as i32
}

impl GatedNeuron {
    /// Runs the neuron on the spikes that act on it in `aim`, and returns the distance between the neuron's spikes and
    /// the target of `aim`, plus the squared errors of its potentials in units of its threshold, each step's at most 1.
    /// (Of several neurons with the same spikes, that with the nearest potentials is the most likely to suit other
    /// recordings.) `unit` converts the chip's potentials to those units. Returns infinity as soon as the result reaches
    /// `most`.
    fn distance(&self, aim: &Aim, unit: f64, most: f64) -> f64 {
        let mut distance = Distance::default();
        let (mut potential, mut first, mut errors) = (0_i32, 0, 0.0);
        let ends = aim.drive.ends.iter().zip(aim.target);
        for (step, (&end, &target)) in ends.enumerate() {
            let mut added = Added::default();
            added.add(self.bias);
            for &spike in &aim.drive.spikes[first..end] {
                added.add(self.weights[usize::from(spike)]);
            }
            first = end;
            let error = f64::from(potential + added.all) * unit - aim.potentials[step];
            errors += error.powi(2).min(1.0);
            let fires = self.step(aim.shape, aim.shape.turn(step), &mut potential, added);
            distance.step(fires.into(), target.into());
            if distance.so_far() + errors >= most {
                return f64::INFINITY;
            }
        }
        distance.value() + errors
    }
}
