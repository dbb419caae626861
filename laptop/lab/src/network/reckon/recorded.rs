//! The network in double precision, split into the parts that the chip's neurons have, with the spikes of the recording.

use super::super::controller::Reset;
use super::super::trained::{Layer, Neuron};
use super::super::{Trained, Trains};
use super::part::{Part, Seat};
use super::place::Places;
use super::quantise::{LEAST_KEEP, Source, keep_of};
use std::collections::BTreeMap;

/// Safety factor for gates. A gate is an input that lowers a neuron to keep it from firing. It lowers the neuron by
/// this factor times the amount that suffices in the recording.
const SPARE: f64 = 1.5;
/// Share of its threshold by which a neuron stays below it after a gate has lowered it, at least: room for rounded
/// weights and leaks.
const MARGIN: f64 = 0.1;
/// The weight, in units of the threshold, with which a spike makes a neuron fire that only repeats it. After the spike,
/// less than a third of the threshold is left.
const REPEATS: f64 = 1.2;

/// The spikes that act on a part of a layer in a step. For each part, a step begins when it compares.
pub(super) struct Drive {
    /// Numbers of the network's inputs that fire. No input occurs twice.
    pub(super) inputs: Vec<u16>,
    /// Spikes of the chip's neurons, by the tick at which they act, and the number of the neuron that fires.
    pub(super) spikes: Vec<(usize, usize)>,
}

/// A part of all neurons of a layer, if all neurons fire as in double precision.
pub(super) struct Group {
    /// Number of ticks from a comparison of this part to the inputs of the next step.
    pub(super) ahead: usize,
    pub(super) drives: Vec<Drive>,
    /// For each step, the neurons whose part fires.
    pub(super) fired: Trains,
    /// For each neuron, the largest absolute potential of the part, in the units of the trained network.
    peaks: Vec<f64>,
    /// For each neuron, the highest potential at the end of a step, in the units of the trained network.
    rests: Vec<f64>,
}

/// A network in double precision, with its potentials and its spikes in the recording.
pub(super) struct Recorded<'a> {
    trained: &'a Trained,
    places: &'a Places,
    ticks: usize,
    groups: BTreeMap<(usize, Part), Group>,
}

impl<'a> Recorded<'a> {
    /// Runs the layers of a network on the spikes of the layers before them.
    pub(super) fn new(
        trained: &'a Trained,
        places: &'a Places,
        ticks: usize,
        inputs: &Trains,
        fired: &[Trains],
    ) -> Self {
        let before = std::iter::once(inputs).chain(fired);
        let mut groups = BTreeMap::new();
        for (at, ((layer, before), fired)) in
            trained.layers.iter().zip(before).zip(fired).enumerate()
        {
            let Potentials { reached, next, rests, overs } = potentials(layer, before);
            for &part in Part::of(layer) {
                let (fired, peaks) = match part {
                    Part::Main => (fired.clone(), reached.clone()),
                    Part::Over => (overs.clone(), next.clone()),
                    Part::Return => (overs.clone(), vec![]),
                    Part::Relay => (
                        std::iter::once(vec![])
                            .chain(fired.iter().cloned())
                            .take(fired.len())
                            .collect(),
                        vec![],
                    ),
                };
                let rests = rests.clone();
                let group = Group { ahead: part.ahead(), drives: vec![], fired, peaks, rests };
                groups.insert((at, part), group);
            }
        }
        let mut recorded = Self { trained, places, ticks, groups };
        let keys: Vec<(usize, Part)> = recorded.groups.keys().copied().collect();
        for (layer, part) in keys {
            let drives = recorded.drives(layer, part.ahead(), inputs);
            if let Some(group) = recorded.groups.get_mut(&(layer, part)) {
                group.drives = drives;
            }
        }
        recorded
    }

    /// Returns the part of a layer to which the neuron of the chip belongs.
    pub(super) fn group(&self, seat: Seat) -> &Group {
        &self.groups[&(seat.layer, seat.part)]
    }

    /// Returns the spikes that act on the layer with index `at` in each step, which begins `ahead` ticks before the
    /// inputs of the step.
    fn drives(&self, at: usize, ahead: usize, inputs: &Trains) -> Vec<Drive> {
        let own = |fired: &Vec<u16>| {
            let mut own = fired.clone();
            own.sort_unstable();
            own.dedup();
            own
        };
        let first =
            |fired| Drive { inputs: if at == 0 { own(fired) } else { vec![] }, spikes: vec![] };
        let mut drives: Vec<Drive> = inputs.iter().map(first).collect();
        for (&(layer, part), group) in &self.groups {
            // A spike acts one tick after the comparison of its own neuron, and one layer is a tick after the other.
            let tick = match (at.checked_sub(layer), part) {
                (Some(0), _) => 1 + ahead - part.ahead(),
                (Some(1), Part::Main) => ahead,
                _ => continue,
            };
            for (step, fired) in group.fired.iter().enumerate() {
                let Some(drive) = drives.get_mut(step + tick / self.ticks) else { continue };
                let number =
                    |&neuron: &u16| self.places.of(Seat { layer, part, neuron: neuron.into() });
                drive.spikes.extend(fired.iter().map(|neuron| (tick % self.ticks, number(neuron))));
            }
        }
        drives
    }

    /// Returns a neuron of the chip, and the weights that lead to it.
    pub(super) fn source(&self, seat: Seat) -> Source {
        let Self { trained, places, ticks, .. } = *self;
        let Seat { layer: at, part, neuron } = seat;
        let layer = &trained.layers[at];
        let Neuron { keep, threshold, .. } = layer.neurons[neuron];
        let number = |part, neuron| places.of(Seat { layer: at, part, neuron });
        let kept = keep_of(keep, ticks);
        // What the chip adds at the tick after a comparison is less at the next one, which is `ticks` ticks later.
        let grown = kept.powi(1 - ticks as i32);
        let mut source = Source {
            seat,
            keep,
            threshold,
            inputs: vec![0.0; trained.inputs()],
            bias: 0.0,
            raise: 0.0,
            gate: 0.0,
            recurrent: vec![],
            peak: 0.0,
        };
        // All weights are in units of the threshold. `Over` compares what is left of a potential one tick before the
        // inputs of the next step, so that its threshold is lower.
        let unit = match part {
            Part::Main => 1.0 / threshold,
            Part::Over => grown / threshold,
            Part::Return => {
                source.keep = LEAST_KEEP.powi(ticks as i32);
                source.recurrent.push((number(Part::Over, neuron), REPEATS));
                source.peak = 2.0 * REPEATS;
                return source;
            }
            Part::Relay => {
                source.keep = LEAST_KEEP.powi(ticks as i32);
                // If a step has two ticks, the spike arrives at the tick at which it is repeated.
                let weight = REPEATS * LEAST_KEEP.powi(2 - ticks as i32);
                source.gate = if ticks > 2 { SPARE * weight } else { 0.0 };
                source.recurrent.push((number(Part::Main, neuron), weight));
                source.peak = 2.0 * weight + source.gate;
                return source;
            }
        };
        let row = layer.weights[neuron].iter().map(|weight| weight * unit);
        match at.checked_sub(1) {
            None => source.inputs = row.collect(),
            Some(before) => {
                let of = |(from, weight)| (places.of(Seat::main(before, from)), weight);
                source.recurrent.extend(row.enumerate().map(of));
            }
        }
        let back = layer.recurrent.get(neuron).into_iter().flatten().map(|weight| weight * unit);
        let peak = self.group(seat).peaks[neuron] * unit;
        let undelayed = layer.reset == Reset::SubtractNoDelay;
        let mut own: Vec<(usize, f64)> = vec![];
        if undelayed {
            own.extend(
                back.clone().enumerate().map(|(from, weight)| (number(Part::Relay, from), weight)),
            );
        }
        if part == Part::Over {
            // The second weight undoes the neuron's own reset.
            own.push((number(Part::Main, neuron), -kept * grown));
            own.push((number(Part::Over, neuron), 1.0));
            source.raise = layer.bias[neuron] / threshold;
            source.gate = (SPARE * peak - 1.0).max(0.5);
        } else if undelayed {
            own.push((number(Part::Main, neuron), 1.0 - kept));
            own.push((number(Part::Over, neuron), -1.0));
            own.push((number(Part::Return, neuron), kept));
            source.bias = layer.bias[neuron] / threshold;
            // A neuron may rest at up to twice its threshold without firing, also where the recording shows none.
            let rest = self.group(seat).rests[neuron] * unit;
            source.gate = (SPARE * rest * kept - 1.0).max(2.0 * kept - 1.0 + MARGIN);
        } else {
            // The layer's own spikes, and a reset that subtracts, act at the tick after the layer has compared. Until
            // it compares again, less is left of them than in training, where they act when the neuron compares.
            let mut all: Vec<f64> = back.map(|weight| weight * grown).collect();
            all.resize(layer.neurons.len(), 0.0);
            if layer.reset.subtracts() {
                all[neuron] += 1.0 - grown;
            }
            source.bias = layer.bias[neuron] / threshold;
            if ticks > 1 && all.iter().any(|weight| *weight != 0.0) {
                let sum = |fired: &Vec<u16>| -> f64 {
                    fired.iter().map(|&from| all[usize::from(from)]).sum()
                };
                let added = self.group(seat).fired.iter().map(sum).fold(0.0, f64::max);
                let left =
                    if layer.reset.subtracts() { (peak * kept - 1.0).max(kept) } else { kept };
                source.gate = SPARE * (left + added);
            }
            let all = all.into_iter().enumerate();
            own.extend(all.map(|(from, weight)| (number(Part::Main, from), weight)));
        }
        source.recurrent.extend(own.into_iter().filter(|(_, weight)| *weight != 0.0));
        source.peak = peak + source.gate;
        source
    }
}

/// The potentials of a layer in double precision.
struct Potentials {
    /// For each neuron, the largest absolute potential that it compares with its threshold.
    reached: Vec<f64>,
    /// For each neuron, the largest absolute potential of [`Part::Over`].
    next: Vec<f64>,
    /// For each neuron, the highest potential at the end of a step.
    rests: Vec<f64>,
    /// For each step, the neurons whose potential is above the threshold at the beginning.
    overs: Trains,
}

/// Runs a layer on the spikes `before` of the layer before it.
fn potentials(layer: &Layer, before: &Trains) -> Potentials {
    let count = layer.neurons.len();
    let [mut peaks, mut highest, mut rests, mut potentials] =
        [(); 4].map(|()| vec![0.0_f64; count]);
    let mut overs: Trains = vec![];
    layer.follow(before, |at, reached| {
        if at == 0 {
            overs.push(vec![]);
        }
        let threshold = layer.neurons[at].threshold;
        let was_over = layer.is_over(at, potentials[at]);
        if was_over && let Some(overs) = overs.last_mut() {
            overs.push(at as u16);
        }
        let next = reached + if was_over { threshold } else { 0.0 };
        potentials[at] = next - if layer.is_over(at, reached) { threshold } else { 0.0 };
        peaks[at] = peaks[at].max(reached.abs());
        highest[at] = highest[at].max(next.abs());
        rests[at] = rests[at].max(potentials[at]);
    });
    Potentials { reached: peaks, next: highest, rests, overs }
}
