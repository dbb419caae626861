//! Quantises a network from double precision to the integers of `ReckOn`.

use super::super::trained::{Layer, Neuron, Readout, fires_at};
use super::super::{Distance, Trained, Trains};
use super::place::Places;
use crate::Spot;
use crate::network::Fires;
use crate::network::fault::{FitKind, Result, ensure};
use rayon::prelude::*;
use spikewire_chips::{DescribeReckOn, ReckOnPair, ReckOnShared};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The integer that stands for a factor of 1, by which a step multiplies a neuron's potential.
const KEEP: f64 = 32_768.0;
/// The integer that stands for a factor of 1, by which a step multiplies an output's potential.
const OUTPUT_KEEP: f64 = 128.0;
/// Smallest factor by which a step can multiply the potential of the chip's neurons.
const LEAST_KEEP: f64 = 0.875;
const LARGEST: f64 = 127.0;
/// Largest potential, in the chip's units, that a neuron may reach in the recording. The rest of the 16-bit range is
/// left for other recordings.
const ROOM: f64 = 0.8 * 32_767.0;
/// Scales of weights to try for a pair: two neurons of the chip that share a leak and a threshold. The scales are
/// multiples of the largest scale at which the pair's weights and potentials fit the chip.
const SCALES: [f64; 8] = [1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.6];
/// Number of left shifts that the chip offers for weights: 0 to 7.
const SHIFTS: u8 = 8;
/// Weight, left shift and decay factor of an output that reports the spikes of one neuron. Each step halves the
/// output's potential, so that the potential's bits say in which of the last steps the neuron fired.
const FOLLOWS: (i8, u8, u8) = (64, 7, 64);
/// For an output that reports the spikes of one neuron: the bit of its potential that is 1 if the neuron fired in the
/// latest step.
pub(super) const FIRED: u32 = 12;

/// A network in the integers of `ReckOn`.
#[derive(Clone, Debug)]
pub(super) struct Quantised {
    pub(super) places: Places,
    pub(super) pairs: Vec<ReckOnPair>,
    /// The weights of inputs: one row for each input, with one weight for each neuron of the chip. The bias is the last
    /// input, if the network has a bias.
    pub(super) inputs: Vec<Vec<i8>>,
    /// The weights between neurons: one row for each sending neuron, with one weight for each receiving neuron.
    pub(super) recurrent: Vec<Vec<i8>>,
    /// The weights of outputs: one row for each neuron, with one weight for each output.
    pub(super) outputs: Vec<Vec<i8>>,
    pub(super) shared: ReckOnShared,
    /// Index of the input that carries the bias. This input must fire in every step. `None` if the network has no bias.
    pub(super) bias: Option<usize>,
    /// For each layer: its name and its number of neurons.
    pub(super) layers: Vec<(String, usize)>,
    /// Value of an output's potential of 1 on the chip, in the units of the trained network; `None` if the outputs
    /// report the spikes of neurons.
    pub(super) unit: Option<f64>,
    /// For each layer, how rounding changed its weights. If the outputs' weights were trained, the last entry is for
    /// these weights.
    pub(super) changes: Vec<Change>,
    /// Differences between the leaks on the chip and the trained leaks. The leaks differ because two neurons of a pair
    /// share one, and all outputs share one. The first figure is the number of neurons and outputs whose leak differs.
    /// The second figure is the largest difference between a decay factor on the chip and the trained factor.
    pub(super) shared_keeps: (usize, f64),
}

/// How rounding changed the weights of a layer, or those of the outputs.
#[derive(Clone, Debug, Default)]
pub(super) struct Change {
    pub(super) name: String,
    pub(super) weights: usize,
    /// Number of weights that exceeded the chip's range and were clipped.
    pub(super) clipped: usize,
    /// Number of weights other than 0 that were rounded to 0.
    pub(super) vanished: usize,
    /// Two sums: of the squares of the weights, and of the squares of the amounts by which rounding changed them.
    sums: [f64; 2],
}

impl Change {
    /// Returns the root mean square of the amounts by which rounding changed the weights, divided by the root mean
    /// square of the weights.
    pub(super) fn relative(&self) -> f64 {
        let [weights, changes] = self.sums;
        if weights > 0.0 { (changes / weights).sqrt() } else { 0.0 }
    }

    /// Rounds `weight * scale` to a weight of the chip, and adds the change of the weight to these statistics.
    fn weight(&mut self, weight: f64, scale: f64) -> i8 {
        let rounded = (weight * scale).round();
        let held = rounded.clamp(-LARGEST - 1.0, LARGEST);
        self.weights += 1;
        self.clipped += usize::from(held != rounded);
        self.vanished += usize::from(held == 0.0 && weight != 0.0);
        let change = held / scale - weight;
        self.sums[0] += weight * weight;
        self.sums[1] += change * change;
        held as i8
    }
}

/// A neuron of the trained network, and the weights that lead to the neuron. Weights and potentials are in units of the
/// neuron's threshold.
struct Source {
    layer: usize,
    neuron: usize,
    keep: f64,
    /// The weight of each input; then the bias, if the network has a bias.
    inputs: Vec<f64>,
    /// For each neuron that sends spikes to this one: the number of the chip's neuron that holds the sender, and the
    /// weight.
    recurrent: Vec<(usize, f64)>,
    has_bias: bool,
    /// Largest absolute potential that the neuron reaches in double precision.
    peak: f64,
}

fn largest(weights: impl Iterator<Item = f64>) -> f64 {
    weights.fold(0.0, |most, weight| most.max(weight.abs()))
}

impl Source {
    fn largest(&self) -> [f64; 2] {
        [
            largest(self.inputs.iter().copied()),
            largest(self.recurrent.iter().map(|(_, weight)| *weight)),
        ]
    }
}

/// Returns the scale of a pair of neurons: the largest factor by which the pair's weights and potentials can be
/// multiplied so that all of them fit the chip. `shifts` are the chip's left shifts of input weights and of weights
/// between neurons.
fn scale(pair: &[Source], shifts: [u8; 2]) -> f64 {
    let room = largest(pair.iter().map(|source| source.peak.max(1.0)));
    let of_kind = |kind: usize| {
        let most = largest(pair.iter().map(|source| source.largest()[kind]));
        if most > 0.0 { LARGEST * f64::from(1 << shifts[kind]) / most } else { f64::INFINITY }
    };
    (ROOM / room).min(of_kind(0)).min(of_kind(1))
}

/// Returns a measure of how much rounding changes a pair: two neurons of the chip that share a leak and a threshold.
/// The measure sums the squared changes of the weights and the squared losses of potential. A neuron loses potential
/// because the chip rounds each leak.
fn change(pair: &[Source], shifts: [u8; 2]) -> f64 {
    let scale = scale(pair, shifts);
    let [inputs, recurrent] = shifts.map(|shift| scale / f64::from(1 << shift));
    let squared = |weight: f64, scale: f64| ((weight * scale).round() / scale - weight).powi(2);
    let of_source = |source: &Source| {
        let inputs: f64 = source.inputs.iter().map(|&weight| squared(weight, inputs)).sum();
        let own: f64 = source.recurrent.iter().map(|&(_, weight)| squared(weight, recurrent)).sum();
        let lost = 0.5 / (1.0 - source.keep).max(0.01) / scale;
        inputs + own + lost * lost
    };
    pair.iter().map(of_source).sum()
}

/// Quantises a network for the chip. First chooses the left shifts of weights at which rounding changes the weights
/// least. Then chooses, for each pair of neurons, the scale at which the pair's spikes are nearest to those in double
/// precision; all other neurons are assumed to fire as in double precision. Calls `progress` with the number of
/// finished neurons and the total number of neurons.
///
/// # Errors
/// Returns an error if the network does not fit the chip.
pub(super) fn quantise(
    trained: &Trained,
    inputs: &Trains,
    fired: &[Trains],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Quantised> {
    let has_bias = trained.layers.iter().any(|layer| layer.bias.iter().any(|bias| *bias != 0.0));
    let places = Places::new(trained, has_bias)?;
    let resets_to_zero = !trained.layers.iter().any(|layer| layer.reset.subtracts());
    ensure!(
        resets_to_zero || trained.layers.iter().all(|layer| layer.reset.subtracts()),
        FitKind::MixedResets
    );
    let mut neurons = trained.layers.iter().flat_map(|layer| &layer.neurons);
    ensure!(neurons.all(|neuron| neuron.leak == 0.0), FitKind::LeakByAmount { owner: "ReckOn's" });
    let at = trained.layers.first().map_or(Fires::Above, |layer| layer.fires);
    let peaks = peaks(trained, inputs, fired);
    let pairs: Vec<Vec<Source>> = places
        .pairs()
        .map(|pair| {
            let of = |(layer, neuron): (usize, usize)| {
                source(trained, &places, has_bias, layer, neuron, peaks[layer][neuron])
            };
            pair.into_iter().map(of).collect()
        })
        .collect();
    let all = (0..SHIFTS).flat_map(|input| (0..SHIFTS).map(move |own| [input, own]));
    let change = |&shifts: &[u8; 2]| pairs.iter().map(|pair| change(pair, shifts)).sum::<f64>();
    let changes: Vec<([u8; 2], f64)> = all.map(|shifts| (shifts, change(&shifts))).collect();
    let best = changes.iter().min_by(|(_, one), (_, other)| one.total_cmp(other));
    let shifts = best.map_or([0; 2], |(shifts, _)| *shifts);

    let drives = drives(trained, inputs, fired);
    let done = AtomicUsize::new(0);
    let total: usize = trained.layers.iter().map(|layer| layer.neurons.len()).sum();
    let chosen = pairs.par_iter().map(|pair| {
        let keep = mean_keep(pair);
        let candidates = SCALES.map(|part| part * scale(pair, shifts));
        let distance = |scale: f64| -> f64 {
            let of = |source: &Source| {
                Held::new(
                    source,
                    keep,
                    scale,
                    shifts,
                    Firing { resets_to_zero, fires: at },
                    &places,
                )
                .distance(
                    &drives[source.layer],
                    &fired[source.layer],
                    source.neuron,
                )
            };
            pair.iter().map(of).sum()
        };
        let tried = candidates
            .into_iter()
            .filter(|scale| fires_at(*scale, at) <= f64::from(i16::MAX))
            .map(|scale| (scale, distance(scale)));
        let best = tried.min_by(|(_, one), (_, other)| one.total_cmp(other));
        progress(done.fetch_add(pair.len(), Ordering::Relaxed) + pair.len(), total);
        (keep, best.map_or(1.0, |(scale, _)| scale))
    });
    let chosen: Vec<(u16, f64)> = chosen.collect();

    let count = places.neurons.len();
    let mut network = Quantised {
        pairs: Vec::new(),
        inputs: vec![vec![0; count]; trained.inputs() + usize::from(has_bias)],
        recurrent: vec![vec![0; count]; count],
        outputs: Vec::new(),
        shared: ReckOnShared { shifts: [shifts[0], shifts[1], 0], keep: 0, resets_to_zero },
        bias: has_bias.then(|| trained.inputs()),
        layers: trained.layers.iter().map(|l| (l.name.clone(), l.neurons.len())).collect(),
        unit: None,
        changes: trained
            .layers
            .iter()
            .map(|layer| Change { name: layer.name.clone(), ..Change::default() })
            .collect(),
        shared_keeps: (0, 0.0),
        places,
    };
    for (pair, &(keep, scale)) in pairs.iter().zip(&chosen) {
        network.pairs.push(ReckOnPair { keep, threshold: fires_at(scale, at) as i16 });
        for source in pair {
            network.put(source, scale, shifts);
            network.tell_keep(source.keep, f64::from(keep) / KEEP, 1e-4);
        }
    }
    match &trained.readout {
        Some(readout) => network.read_out(readout, &trained.potentials(fired))?,
        None => network.follow(trained.layers.len() - 1),
    }
    Ok(network)
}

fn mean_keep(pair: &[Source]) -> u16 {
    let mean = pair.iter().map(|source| source.keep).sum::<f64>() / pair.len().max(1) as f64;
    (mean.max(LEAST_KEEP) * KEEP).round() as u16
}

fn source(
    trained: &Trained,
    places: &Places,
    has_bias: bool,
    at: usize,
    neuron: usize,
    peak: f64,
) -> Source {
    let layer = &trained.layers[at];
    let Neuron { keep, threshold, .. } = layer.neurons[neuron];
    let part = |weight: &f64| weight / threshold;
    let row = layer.weights[neuron].iter().map(part);
    let mut inputs = vec![0.0; trained.inputs()];
    let mut recurrent: Vec<(usize, f64)> = Vec::new();
    match at.checked_sub(1) {
        None => inputs = row.collect(),
        Some(before) => {
            recurrent
                .extend(row.enumerate().map(|(from, weight)| (places.of(before, from), weight)));
        }
    }
    let own = layer.recurrent.get(neuron).into_iter().flatten().map(part);
    recurrent.extend(own.enumerate().map(|(from, weight)| (places.of(at, from), weight)));
    if has_bias {
        inputs.push(layer.bias[neuron] / threshold);
    }
    Source { layer: at, neuron, keep, inputs, recurrent, has_bias, peak: peak / threshold }
}

/// Returns the largest absolute potential that each neuron reaches in double precision, by layer and neuron.
fn peaks(trained: &Trained, inputs: &Trains, fired: &[Trains]) -> Vec<Vec<f64>> {
    let before = std::iter::once(inputs).chain(fired);
    let of_layer = |(layer, before): (&Layer, &Trains)| {
        let mut peaks = vec![0.0_f64; layer.neurons.len()];
        layer.follow(before, |at, potential| peaks[at] = peaks[at].max(potential.abs()));
        peaks
    };
    trained.layers.iter().zip(before).map(of_layer).collect()
}

/// The spikes that act on a layer in a step.
struct Drive {
    /// Numbers of the network's inputs that fire. No input occurs twice.
    inputs: Vec<u16>,
    /// Neurons that fire, each as layer and index. Neurons of the layer before fire in the same step, neurons of the
    /// layer itself in the step before.
    neurons: Vec<(usize, usize)>,
}

/// Returns the spikes that act on each layer in each step, if all neurons fire as in double precision.
fn drives(trained: &Trained, inputs: &Trains, fired: &[Trains]) -> Vec<Vec<Drive>> {
    let of_layer = |(at, layer): (usize, &Layer)| {
        let of_step = |step: usize| {
            let mut drive = Drive { inputs: vec![], neurons: vec![] };
            match at.checked_sub(1) {
                None => {
                    drive.inputs.clone_from(&inputs[step]);
                    drive.inputs.sort_unstable();
                    drive.inputs.dedup();
                }
                Some(before) => drive
                    .neurons
                    .extend(fired[before][step].iter().map(|&neuron| (before, neuron.into()))),
            }
            if let (Some(last), false) = (step.checked_sub(1), layer.recurrent.is_empty()) {
                drive.neurons.extend(fired[at][last].iter().map(|&neuron| (at, neuron.into())));
            }
            drive
        };
        (0..inputs.len()).map(of_step).collect()
    };
    trained.layers.iter().enumerate().map(of_layer).collect()
}

/// The rule by which all neurons of the chip fire and reset.
#[derive(Clone, Copy)]
struct Firing {
    resets_to_zero: bool,
    fires: Fires,
}

/// A neuron in the chip's integers, for a simulation of this neuron alone.
struct Held<'a> {
    keep: i32,
    threshold: i32,
    inputs: Vec<i32>,
    recurrent: Vec<i32>,
    bias: i32,
    resets_to_zero: bool,
    places: &'a Places,
}

impl<'a> Held<'a> {
    fn new(
        source: &Source,
        keep: u16,
        scale: f64,
        shifts: [u8; 2],
        rule: Firing,
        places: &'a Places,
    ) -> Self {
        let mut change = Change::default();
        let mut held = |weight: f64, shift: u8| {
            i32::from(change.weight(weight, scale / f64::from(1 << shift))) << shift
        };
        let inputs: Vec<i32> =
            source.inputs.iter().map(|&weight| held(weight, shifts[0])).collect();
        let mut recurrent = vec![0; places.neurons.len()];
        for &(from, weight) in &source.recurrent {
            recurrent[from] = held(weight, shifts[1]);
        }
        let bias = inputs.last().copied().filter(|_| source.has_bias).unwrap_or(0);
        Self {
            keep: keep.into(),
            threshold: fires_at(scale, rule.fires) as i32,
            inputs,
            recurrent,
            bias,
            resets_to_zero: rule.resets_to_zero,
            places,
        }
    }

    /// Runs the neuron on the spikes in `drives`. Returns the distance between its spikes and the spikes in `fired` of
    /// the neuron with index `neuron`.
    fn distance(&self, drives: &[Drive], fired: &Trains, neuron: usize) -> f64 {
        let (mut potential, mut distance) = (0_i32, Distance::default());
        let mut is_over = false;
        for (drive, meant) in drives.iter().zip(fired) {
            let first = drive.inputs.iter().map(|&input| self.inputs[usize::from(input)]);
            let own = drive.neurons.iter().map(|&(l, n)| self.recurrent[self.places.of(l, n)]);
            let added: i32 = first.chain(own).sum();
            let kept = match (is_over, self.resets_to_zero) {
                (false, _) => (potential * self.keep) >> 15,
                (true, true) => 0,
                (true, false) => ((potential * self.keep) >> 15) - self.threshold,
            };
            potential = (kept + added + self.bias).clamp(i16::MIN.into(), i16::MAX.into());
            is_over = potential >= self.threshold;
            let meant = meant.iter().filter(|fired| usize::from(**fired) == neuron).count();
            distance.step(is_over.into(), meant);
        }
        distance.value()
    }
}

impl Quantised {
    /// Returns the delay of the chip's outputs: the number of ticks from the inputs of a step to the answer that shows
    /// their effect.
    pub(super) fn late(&self) -> usize {
        self.layers.len() + 1
    }

    fn put(&mut self, source: &Source, scale: f64, shifts: [u8; 2]) {
        let at = self.places.of(source.layer, source.neuron);
        let change = &mut self.changes[source.layer];
        let [inputs, recurrent] = shifts.map(|shift| scale / f64::from(1 << shift));
        for (row, &weight) in self.inputs.iter_mut().zip(&source.inputs) {
            if weight != 0.0 {
                row[at] = change.weight(weight, inputs);
            }
        }
        for &(from, weight) in &source.recurrent {
            if weight != 0.0 {
                self.recurrent[from][at] = change.weight(weight, recurrent);
            }
        }
    }

    fn tell_keep(&mut self, trained: f64, held: f64, tolerance: f64) {
        let (count, most) = &mut self.shared_keeps;
        let difference = (trained - held).abs();
        *count += usize::from(difference > tolerance);
        *most = most.max(difference);
    }

    /// Sets the weights, the shift and the leak of the outputs in a network whose outputs are potentials instead of
    /// spikes.
    ///
    /// # Errors
    /// Returns an error if the outputs' leak is too strong for the chip. The mean share of the potential that the
    /// outputs keep in a step then rounds to 0.
    fn read_out(&mut self, readout: &Readout, potentials: &[Vec<f64>]) -> Result<()> {
        let Readout { name, weights, keep } = readout;
        let mean = keep.iter().sum::<f64>() / keep.len() as f64;
        let held = (mean * OUTPUT_KEEP).round();
        let kind = FitKind::OutputLeak { keep: mean };
        ensure!(held >= 1.0, kind.at(Spot::Part(name.clone())));
        for &keep in keep {
            self.tell_keep(keep, held / OUTPUT_KEEP, 0.5 / OUTPUT_KEEP);
        }
        let most = largest(weights.iter().flatten().copied()).max(f64::MIN_POSITIVE);
        let room = ROOM / largest(potentials.iter().flatten().copied()).max(most);
        let fits = |shift: &u8| LARGEST * f64::from(1 << shift) / most <= room;
        let shift = (0..SHIFTS).rev().find(fits).unwrap_or(0);
        let scale = (LARGEST * f64::from(1 << shift) / most).min(room);
        let mut change = Change { name: name.clone(), ..Change::default() };
        let last = self.layers.len() - 1;
        self.outputs = vec![vec![0; weights.len()]; self.places.neurons.len()];
        for (output, row) in weights.iter().enumerate() {
            for (neuron, &weight) in row.iter().enumerate() {
                self.outputs[self.places.of(last, neuron)][output] =
                    change.weight(weight, scale / f64::from(1 << shift));
            }
        }
        self.changes.push(change);
        self.shared.shifts[2] = shift;
        self.shared.keep = held as u8;
        // The chip sends a potential after it has leaked once more.
        self.unit = Some(OUTPUT_KEEP / held / scale);
        Ok(())
    }

    /// Adds, for each neuron of layer `last`, an output that reports the neuron's spikes.
    fn follow(&mut self, last: usize) {
        let (weight, shift, keep) = FOLLOWS;
        let outputs = self.layers[last].1;
        self.outputs = vec![vec![0; outputs]; self.places.neurons.len()];
        for output in 0..outputs {
            self.outputs[self.places.of(last, output)][output] = weight;
        }
        self.shared.shifts[2] = shift;
        self.shared.keep = keep;
    }
}

fn at(rows: &[Vec<i8>], row: u16, column: u16) -> i8 {
    let row = rows.get(usize::from(row));
    row.and_then(|row| row.get(usize::from(column))).copied().unwrap_or(0)
}

impl DescribeReckOn for Quantised {
    fn neurons(&self) -> u16 {
        self.places.neurons.len() as u16
    }

    fn inputs(&self) -> u16 {
        self.inputs.len() as u16
    }

    fn outputs(&self) -> u16 {
        self.outputs.first().map_or(0, Vec::len) as u16
    }

    fn pair(&self, pair: u16) -> ReckOnPair {
        self.pairs.get(usize::from(pair)).copied().unwrap_or(ReckOnPair::REST)
    }

    fn input_weight(&self, input: u16, neuron: u16) -> i8 {
        at(&self.inputs, input, neuron)
    }

    fn recurrent_weight(&self, from: u16, to: u16) -> i8 {
        at(&self.recurrent, from, to)
    }

    fn output_weight(&self, neuron: u16, output: u16) -> i8 {
        at(&self.outputs, neuron, output)
    }

    fn shared(&self) -> ReckOnShared {
        self.shared
    }
}
