//! Networks for tinyODIN whose neurons compare their potentials with their thresholds once a step. A step starts with
//! all potentials below their true values by an offset, so that no neuron fires while the step's inputs arrive. Then a
//! series of events, each called a *rung*, raises the neurons. Neurons whose potentials thereby reach their thresholds
//! fire. Further events lower all neurons to the offset again. `spikewire_chips::Steps` documents the whole sequence.

mod emit;
mod neuron;
mod run;
mod search;
mod shape;

use super::super::bring::agreement;
use super::super::chip::{OnChip, Ran, Remarks, Stepped, written};
use super::super::costs::Cost;
use super::super::trained::Layer;
use super::super::{Trained, Trains};
use crate::network::fault::Result;
use neuron::{Added, GatedNeuron};
use rayon::prelude::*;
use search::{Aim, CLIMBS, Drive, search};
use shape::{Shape, rows_of, shapes};
use spikewire_chips::{Describe, Input, NetworkBytes, TinyOdinInput, TinyOdinNeuron};

const NEURONS: usize = 256;
const ROWS: usize = 256;
const LARGEST_RUNG: f64 = 7.0;
const MAX_LEAK: u8 = 127;
const MAX_POTENTIAL: u16 = 2047;
const LEAST_POTENTIAL: i32 = -2048;
/// Amount by which a rung raises the witness, over all layers.
const WITNESS_RUNG: usize = LARGEST_RUNG as usize;
/// Number of [shapes](Shape) for which the search for parameters is thorough. A rough search with all shapes selects
/// them.
const CHOSEN: usize = 2;
/// Increase in agreement that justifies one more event in each step. Agreement with the original is the share of active
/// steps in which the same outputs fire. A step is active if an output fires in either network.
const PRICE: f64 = 1e-4;

/// A network in tinyODIN's integers, whose neurons compare their potentials with their thresholds once a step.
#[derive(Clone, Debug)]
pub(super) struct Gated {
    shape: Shape,
    layers: Vec<GatedLayer>,
    inputs: usize,
}

#[derive(Clone, Debug)]
struct GatedLayer {
    /// Name of the layer in the network's file.
    name: String,
    inputs: usize,
    /// Whether the layer is recurrent.
    loops: bool,
    neurons: Vec<GatedNeuron>,
}

/// Quantises the network in two searches. The first search is rough: it tries all [shapes](Shape), with parameters that
/// follow almost directly from the trained ones. The second search is thorough: it takes the [`CHOSEN`] shapes with the
/// best ratings, and brings the spikes in this recording nearer to those of the original. The rating of a shape is the
/// agreement with the original, minus [`PRICE`] for each event in a step.
///
/// Returns the best network of the rough search, then the networks of the thorough search. Returns an empty list if the
/// chip has no room for any shape.
///
/// Calls `progress` with the number of finished parts of this work and the total number of parts.
pub(super) fn quantise(
    trained: &Trained,
    inputs: &Trains,
    fired: &[Trains],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Vec<Gated> {
    let has_bias = trained.layers.iter().any(|layer| layer.bias.iter().any(|bias| *bias != 0.0));
    if rows_of(trained, has_bias, 1) > ROWS {
        return vec![];
    }
    let targets: Vec<Vec<Vec<bool>>> = trained
        .layers
        .iter()
        .zip(fired)
        .map(|(layer, fired)| targets(fired, layer.neurons.len()))
        .collect();
    let potentials = potentials(trained, inputs, fired);
    let goal = Goal { targets: &targets, potentials: &potentials, fired };
    let (drive, threshold) = sizes(trained, inputs, fired);
    let shapes = shapes(trained, has_bias, drive, threshold);
    let find = |shape, climbs| Gated::find(trained, inputs, goal, shape, climbs);
    let rate = |network: &Gated| {
        let agrees = fired.last().and_then(|fired| agreement(fired, &network.outputs(inputs)));
        agrees.unwrap_or(1.0) - PRICE * network.shape.events(trained.layers.len()) as f64
    };
    let total = shapes.len() + CHOSEN.min(shapes.len());
    let mut rough: Vec<(f64, Gated)> = Vec::new();
    for shape in shapes {
        let network = find(shape, 0);
        rough.push((rate(&network), network));
        progress(rough.len(), total);
    }
    rough.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let tried = rough.len();
    rough.truncate(CHOSEN);
    let careful = rough.iter().enumerate().map(|(at, (_, network))| {
        let found = find(network.shape.clone(), CLIMBS);
        progress(tried + at + 1, total);
        found
    });
    let careful: Vec<Gated> = careful.collect();
    rough.into_iter().take(1).map(|(_, network)| network).chain(careful).collect()
}

/// Returns the largest sum of positive weights that a step adds to a neuron, and the median threshold of the neurons.
/// Each neuron's sum and threshold are in units of the neuron's largest weight.
fn sizes(trained: &Trained, inputs: &Trains, fired: &[Trains]) -> (f64, f64) {
    let (mut most, mut thresholds) = (0.0_f64, Vec::new());
    for ((layer, own), before) in
        trained.layers.iter().zip(fired).zip(std::iter::once(inputs).chain(fired))
    {
        for (at, neuron) in layer.neurons.iter().enumerate() {
            let back = layer.recurrent.get(at);
            let all = layer.weights[at]
                .iter()
                .chain(back.into_iter().flatten())
                .chain(&layer.bias[at..=at]);
            let largest = all.fold(0.0_f64, |most, weight| most.max(weight.abs()));
            if largest == 0.0 {
                continue;
            }
            thresholds.push(neuron.threshold / largest);
            let of_step = |step: usize| {
                let first: f64 = before[step]
                    .iter()
                    .map(|&from| layer.weights[at][usize::from(from)].max(0.0))
                    .sum();
                let own: f64 = match (back, step.checked_sub(1)) {
                    (Some(back), Some(last)) => {
                        own[last].iter().map(|&from| back[usize::from(from)].max(0.0)).sum()
                    }
                    _ => 0.0,
                };
                first + own + layer.bias[at].max(0.0)
            };
            let drive = (0..inputs.len()).map(of_step).fold(0.0, f64::max);
            most = most.max(drive / largest);
        }
    }
    thresholds.sort_by(f64::total_cmp);
    (most, thresholds.get(thresholds.len() / 2).copied().unwrap_or(1.0))
}

/// Returns, for each neuron, whether it fires in each step.
fn targets(fired: &Trains, neurons: usize) -> Vec<Vec<bool>> {
    let mut all = vec![vec![false; fired.len()]; neurons];
    for (step, fired) in fired.iter().enumerate() {
        for &neuron in fired {
            all[usize::from(neuron)][step] = true;
        }
    }
    all
}

/// Returns, for each layer and neuron, the potential that the neuron compares with its threshold in each step, as a
/// multiple of the threshold.
fn potentials(trained: &Trained, inputs: &Trains, fired: &[Trains]) -> Vec<Vec<Vec<f64>>> {
    let of_layer = |(layer, before): (&Layer, &Trains)| {
        let mut all = vec![Vec::with_capacity(before.len()); layer.neurons.len()];
        layer.follow(before, |neuron, potential| {
            all[neuron].push(potential / layer.neurons[neuron].threshold);
        });
        all
    };
    trained.layers.iter().zip(std::iter::once(inputs).chain(fired)).map(of_layer).collect()
}

/// What the network should do in the recording, by layer.
#[derive(Clone, Copy)]
struct Goal<'a> {
    /// For each neuron, whether it fires in each step.
    targets: &'a [Vec<Vec<bool>>],
    /// For each neuron, the potential that it compares with its threshold in each step, as a multiple of the threshold.
    potentials: &'a [Vec<Vec<f64>>],
    fired: &'a [Trains],
}

impl Gated {
    /// Quantises the network with the shape `shape`, layer by layer. The inputs of each further layer are the spikes of
    /// the quantised layer before it. The search for each neuron improves the `climbs` best initial choices of
    /// parameters. If `climbs` is 0, the search takes the best initial choice as it is.
    fn find(trained: &Trained, inputs: &Trains, goal: Goal, shape: Shape, climbs: usize) -> Self {
        let mut network = Self { shape, layers: Vec::new(), inputs: trained.inputs() };
        let mut before = inputs.clone();
        for (at, layer) in trained.layers.iter().enumerate() {
            let drive = Drive::new(&before, layer, &goal.fired[at]);
            let of = |neuron: usize| {
                let (target, potentials) =
                    (&goal.targets[at][neuron], &goal.potentials[at][neuron]);
                let aim = Aim { drive: &drive, target, potentials, shape: &network.shape };
                search(layer, neuron, &aim, climbs).1
            };
            let neurons = (0..layer.neurons.len()).into_par_iter().map(of).collect();
            let (name, loops) = (layer.name.clone(), !layer.recurrent.is_empty());
            network.layers.push(GatedLayer { name, inputs: layer.inputs(), loops, neurons });
            before = network.layers[at].run(&network.shape, &before);
        }
        let mut neurons = network.layers.iter().flat_map(|layer| &layer.neurons);
        network.shape.has_bias = neurons.any(|neuron| neuron.bias != 0);
        network
    }

    /// Runs the network without the chip's model, and returns the spikes of the last layer.
    pub(super) fn outputs(&self, inputs: &Trains) -> Trains {
        let of_layer = |before: Trains, layer: &GatedLayer| layer.run(&self.shape, &before);
        self.layers.iter().fold(inputs.clone(), of_layer)
    }

    /// Returns the number of neurons in all layers.
    fn count(&self) -> usize {
        self.layers.iter().map(|layer| layer.neurons.len()).sum()
    }

    /// Returns whether the network has a witness after its layers: a neuron that shows whether the chip has dropped an
    /// event, as `spikewire_chips::Steps` documents. It needs a free neuron, and a weight of 1 or more to raise each layer.
    fn has_witness(&self) -> bool {
        self.count() < usize::from(TinyOdinInput::PROBED) && self.layers.len() <= WITNESS_RUNG
    }

    /// Returns the weight of the synapse in row `row` that leads to the witness.
    fn witness_row(&self, row: usize) -> i8 {
        let (sources, _) = self.rows();
        let layers = self.layers.len();
        let Some(gate) = row.checked_sub(sources.into()) else { return 0 };
        let weight = match gate.checked_sub(layers) {
            // The rows that raise the layers share the rung. The first of them have what does not divide evenly.
            None => (WITNESS_RUNG / layers + usize::from(gate < WITNESS_RUNG % layers)) as i8,
            Some(0) => -(WITNESS_RUNG as i8),
            Some(_) => WITNESS_RUNG as i8,
        };
        if self.has_witness() { weight } else { 0 }
    }

    /// Returns the witness before the first step. Its potential rises by at most 7 for each of 584 rungs, and stays below
    /// the threshold.
    fn witness(&self) -> TinyOdinNeuron {
        let lowered = WITNESS_RUNG as i32 * i32::from(self.shape.rungs());
        let potential = (-lowered).max(LEAST_POTENTIAL) as i16;
        TinyOdinNeuron { threshold: MAX_POTENTIAL, leak: 0, potential, is_disabled: false }
    }

    /// Finds the chip's neuron `neuron` in the network. Returns the index of its layer, its index in this layer, and
    /// its parameters. Returns `None` if the network does not use the neuron.
    fn at(&self, neuron: usize) -> Option<(usize, usize, &GatedNeuron)> {
        let mut first = 0;
        for (at, layer) in self.layers.iter().enumerate() {
            if let Some(found) = layer.neurons.get(neuron - first) {
                return Some((at, neuron - first, found));
            }
            first += layer.neurons.len();
        }
        None
    }

    /// Returns two counts of rows of synapses. The first count includes the rows for inputs, bias and neurons. The
    /// second count also includes the rows that raise or lower the potentials of whole layers.
    fn rows(&self) -> (u16, u16) {
        self.with_steps(|steps| (steps.first_rise(), steps.all_rows()))
    }

    /// Returns the weight of the synapse in row `row` that leads to the chip's neuron `post`. `spikewire_chips::Steps`
    /// documents the order of the rows.
    fn row(&self, row: usize, post: usize) -> i8 {
        let Some((layer, _, neuron)) = self.at(post) else {
            return if post == self.count() { self.witness_row(row) } else { 0 };
        };
        let rows = self.shape.rows.len();
        let mut at = row;
        let mut take = |sources: usize| {
            let found = (at < sources * rows).then_some((at / rows, at % rows));
            at = at.wrapping_sub(sources * rows);
            found
        };
        let part = |weight: Option<&i16>, row: usize| {
            GatedNeuron::part(weight.copied().unwrap_or(0), row, self.shape.rows)
        };
        if let Some((from, row)) = take(self.inputs) {
            return part(neuron.weights.get(from).filter(|_| layer == 0), row);
        }
        if let Some((_, row)) = take(self.shape.has_bias.into()) {
            return part(Some(&neuron.bias), row);
        }
        for (source, own) in self.layers.iter().enumerate() {
            if source + 1 < self.layers.len()
                && let Some((from, row)) = take(own.neurons.len())
            {
                return part(neuron.weights.get(from).filter(|_| layer == source + 1), row);
            }
            if own.loops
                && let Some((from, row)) = take(own.neurons.len())
            {
                return part(
                    neuron.weights.get(own.inputs + from).filter(|_| layer == source),
                    row,
                );
            }
        }
        let rung = neuron.rung as i8;
        match at.checked_sub(self.layers.len()) {
            None => i8::from(layer == at) * rung,
            Some(0) => -rung,
            Some(_) => rung,
        }
    }
}

impl GatedLayer {
    fn run(&self, shape: &Shape, inputs: &Trains) -> Trains {
        let mut potentials = vec![0; self.neurons.len()];
        let mut before: Vec<u16> = Vec::new();
        let step = |(at, inputs): (usize, &Vec<u16>)| {
            let turn = shape.turn(at);
            let mut out = Vec::new();
            for ((number, neuron), potential) in (0..).zip(&self.neurons).zip(&mut potentials) {
                let mut added = Added::default();
                added.add(neuron.bias);
                for &from in inputs {
                    added.add(neuron.weights[usize::from(from)]);
                }
                for &own in before.iter().filter(|_| self.loops) {
                    added.add(neuron.weights[self.inputs + usize::from(own)]);
                }
                if neuron.step(shape, turn, potential, added) {
                    out.push(number);
                }
            }
            before.clone_from(&out);
            out
        };
        inputs.iter().enumerate().map(step).collect()
    }
}

impl Describe<TinyOdinInput> for Gated {
    fn neurons(&self) -> u16 {
        (self.count() + usize::from(self.has_witness())) as u16
    }

    fn neuron(&self, neuron: u8) -> TinyOdinNeuron {
        let Some((_, _, neuron)) = self.at(neuron.into()) else {
            let is_witness = usize::from(neuron) == self.count() && self.has_witness();
            return if is_witness { self.witness() } else { TinyOdinNeuron::DISABLED };
        };
        let (potential, threshold) = neuron.held(&self.shape);
        TinyOdinNeuron { threshold, leak: neuron.leak, potential, is_disabled: false }
    }

    fn inputs(&self) -> u16 {
        self.rows().1
    }

    fn virtual_input(&self, _: u16) -> Option<(u8, i8)> {
        None
    }

    fn input_weight(&self, input: u16, post: u8) -> i8 {
        self.row(input.into(), post.into())
    }

    fn is_recurrent(&self) -> bool {
        false
    }

    fn weight(&self, _: u8, _: u8) -> i8 {
        0
    }

    fn output(&self, neuron: u8) -> Option<u16> {
        let (layer, place, _) = self.at(neuron.into())?;
        (layer + 1 == self.layers.len()).then_some(place as u16)
    }
}

impl OnChip for Gated {
    fn run(&self, inputs: &Trains) -> Result<Ran> {
        super::run::run(self.layers.len(), inputs, |steps, see| run::follow(self, steps, see))
    }

    fn follow(
        &self,
        steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        run::follow(self, steps, see)
    }

    fn clipped(&self) -> Vec<usize> {
        let of_layer = |layer: &GatedLayer| layer.neurons.iter().map(|n| n.clipped).sum();
        self.layers.iter().map(of_layer).collect()
    }

    fn emit(&self, remarks: &Remarks) -> String {
        emit::emit(self, remarks)
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        Ok(written(|bytes| NetworkBytes::write(self, bytes))?)
    }

    fn notes(&self) -> Vec<String> {
        let Shape { rows, leaks, .. } = &self.shape;
        let leaks = leaks.iter().map(Vec::len).max().unwrap_or(0);
        let (sources, all) = self.rows();
        let each =
            if rows.len() == 1 { "a row".to_owned() } else { format!("{} rows", rows.len()) };
        vec![format!(
            "{} of the chip's 256 neurons, {} of its 256 rows: {each} a weight, and {} to compare once a step; {} events \
             a step beside its spikes, {leaks} of them leaks",
            self.count(),
            all,
            all - sources,
            self.shape.events(self.layers.len()),
        )]
    }

    fn costs(&self) -> Vec<Cost> {
        let bits = Cost::Weights { largest: LARGEST_RUNG * f64::from(self.shape.events_a_spike()) };
        if self.shape.share.is_none() { vec![Cost::Leak, bits] } else { vec![bits] }
    }

    fn loss(&self) -> &'static str {
        "the chip's queue of 128 was full"
    }
}
