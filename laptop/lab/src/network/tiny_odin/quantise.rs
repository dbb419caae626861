//! Quantises a network from double precision to tinyODIN's integers. The neurons of the quantised network compare their
//! potentials with their thresholds after every spike.

use super::super::trained::{Layer, Neuron, fires_at};
use super::super::{Distance, Trained, Trains};
use super::climb::climb;
use crate::Spot;
use crate::network::fault::{FitKind, Result, ensure};
use rayon::prelude::*;
use spikewire_chips::{Describe, Input, TinyOdinInput, TinyOdinNeuron};
use std::collections::{BTreeSet, VecDeque};
use std::sync::atomic::{AtomicUsize, Ordering};

const NEURONS: usize = 256;
const ROWS: usize = 256;
const MAX_THRESHOLD: f64 = 2047.0;
const MAX_LEAK: f64 = 127.0;
/// Values to try for a neuron's largest weight on the chip. A value above 7 clips the largest weights to the chip's
/// range, but rounds the smaller weights more finely.
const LARGEST: [f64; 20] = [
    7.0, 6.0, 8.0, 5.0, 9.0, 4.0, 10.0, 3.0, 12.0, 2.0, 14.0, 1.0, 16.0, 6.5, 5.5, 4.5, 3.5, 7.5,
    8.5, 20.0,
];
/// Number of initial choices of a neuron's parameters from which the search climbs to better ones.
const CLIMBS: usize = 2;
/// Leaks to try for a neuron, as multiples of a reference amount. The reference is the amount that the trained neuron
/// loses in the time between two leaks of the chip, if its potential starts at half its threshold.
const LEAKS: [f64; 7] = [1.0, 0.5, 0.75, 1.5, 2.0, 3.0, 0.0];
/// Maximum number of neurons of each layer with which the search compares different intervals between two leaks.
const SURVEYED: usize = 32;
/// A value that stands for a leak where a function expects a weight. It is below all weights of the chip.
const LEAK: i8 = i8::MIN;
/// Maximum number of spikes of a layer that are simulated in a step. The limit ends steps in which a layer's recurrent
/// spikes make the layer fire without end.
const MOST_SPIKES: usize = 10_000;
/// Intervals to try between two leaks, in steps. A leak moves the potential of every neuron towards 0.
const STEPS: [usize; 6] = [1, 2, 3, 4, 8, 16];

/// A network in tinyODIN's integers. On the chip, the neurons are numbered layer by layer, from the first layer to the
/// last. If the network has a bias, the last input is for the bias. This input must fire in every step.
#[derive(Clone, Debug)]
pub(super) struct Quantised {
    /// The layers.
    pub layers: Vec<ChipLayer>,
    /// Number of inputs, without the one for the bias.
    inputs: usize,
    /// Whether the network has a bias.
    pub has_bias: bool,
    /// Whether spikes of the chip's neurons act on other neurons or on themselves. This is the case if the network has
    /// several layers or a recurrent layer.
    is_recurrent: bool,
    /// Number of steps between two leaks of all neurons.
    pub steps_a_leak: usize,
}

#[derive(Clone, Debug)]
pub(super) struct ChipLayer {
    /// Name of the layer in the network's file.
    pub name: String,
    /// Number of inputs of the layer. For the first layer, this is the number of the network's inputs; for any other
    /// layer, the number of neurons of the layer before.
    inputs: usize,
    pub neurons: Vec<ChipNeuron>,
}

/// A neuron, and the weights that lead to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ChipNeuron {
    /// The weights that lead to the neuron, one for each input of the layer. In a recurrent layer, one weight for each
    /// neuron of the layer follows.
    pub weights: Vec<i8>,
    /// Weight that the neuron receives in every step.
    pub bias: i8,
    /// Potential at which the neuron fires.
    pub threshold: u16,
    /// Amount by which a leak moves the potential towards 0.
    pub leak: u8,
    /// Number of weights that exceeded the chip's range and were clipped.
    pub clipped: usize,
}

/// Quantises a network for the chip, layer by layer. Finds, for each neuron, the scale of the weights, the threshold
/// and the leak that bring the neuron's spikes nearest to those in double precision. The inputs of each further layer
/// are the spikes of the quantised layer before it, in the order in which the chip fires them. Calls `progress` with
/// the number of finished searches and the total number of searches. Each neuron takes one or more searches.
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
    check_room(trained, has_bias)?;
    let leaks = trained
        .layers
        .iter()
        .flat_map(|layer| &layer.neurons)
        .any(|neuron| neuron.keep < 1.0 || neuron.leak > 0.0);
    let tried = if leaks { &STEPS[..] } else { &STEPS[..1] };
    let count = |layer: &Layer| layer.neurons.len();
    // The interval between leaks is rated on some neurons of each layer, evenly spaced.
    let some = |layer: &Layer| (0..count(layer)).step_by(count(layer).div_ceil(SURVEYED));
    let surveyed: usize = trained.layers.iter().map(|layer| some(layer).len()).sum();
    let all: usize = trained.layers.iter().map(count).sum();
    let total = if tried.len() > 1 { surveyed * tried.len() } else { 0 } + all;
    let done = AtomicUsize::new(0);
    let searched = |layer: &Layer, neuron, aim: &Aim, climbs| {
        let found = search(layer, neuron, aim, climbs);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
        found
    };

    let mut steps_a_leak = 1;
    if tried.len() > 1 {
        let survey = |steps_a_leak: usize| -> f64 {
            let drives = std::iter::once(inputs).chain(fired);
            let layers = trained.layers.iter().zip(fired).zip(drives);
            let of_layer = |((layer, fired), before): ((&Layer, &Trains), &Trains)| -> f64 {
                let drive = Drive::new(before, layer, fired);
                let targets = targets(fired, count(layer));
                let surveyed: Vec<usize> = some(layer).collect();
                let distance = |&neuron: &usize| {
                    let aim = Aim { drive: &drive, target: &targets[neuron], steps_a_leak };
                    searched(layer, neuron, &aim, 0).0
                };
                surveyed.par_iter().map(distance).collect::<Vec<_>>().iter().sum()
            };
            layers.map(of_layer).sum()
        };
        let rough = tried.iter().map(|&steps| (survey(steps), steps));
        // `min_by` returns the first of equals: leaks come often if the interval makes no difference.
        let best = rough.min_by(|(one, _), (other, _)| one.total_cmp(other));
        steps_a_leak = best.map_or(1, |(_, steps)| steps);
    }
    let (mut layers, mut before) = (Vec::new(), inputs.clone());
    for (layer, fired) in trained.layers.iter().zip(fired) {
        let drive = Drive::new(&before, layer, fired);
        let targets = targets(fired, count(layer));
        let chosen = |neuron: usize| {
            let aim = Aim { drive: &drive, target: &targets[neuron], steps_a_leak };
            searched(layer, neuron, &aim, CLIMBS).1
        };
        let neurons: Vec<ChipNeuron> = (0..count(layer)).into_par_iter().map(chosen).collect();
        let own = (!layer.recurrent.is_empty()).then(|| layer.inputs());
        let layer = ChipLayer { name: layer.name.clone(), inputs: layer.inputs(), neurons };
        before = layer.fired(&before, own, steps_a_leak);
        layers.push(layer);
    }
    let is_recurrent =
        layers.len() > 1 || trained.layers.iter().any(|layer| !layer.recurrent.is_empty());
    Ok(Quantised { layers, inputs: trained.inputs(), has_bias, is_recurrent, steps_a_leak })
}

fn check_room(trained: &Trained, has_bias: bool) -> Result<()> {
    let mut neurons = 0;
    for layer in &trained.layers {
        let count = layer.neurons.len();
        neurons += count;
        let kind = || FitKind::Neurons { most: NEURONS, layer: count, needed: neurons };
        ensure!(neurons <= NEURONS, kind().at(Spot::Part(layer.name.clone())));
    }
    let loops = trained.layers.iter().any(|layer| !layer.recurrent.is_empty());
    let senders = if trained.layers.len() > 1 || loops { neurons } else { 0 };
    let inputs = trained.inputs() + usize::from(has_bias);
    let kind = || FitKind::Rows { most: ROWS, inputs, has_bias, senders };
    ensure!(senders + inputs <= ROWS, kind().at(Spot::Part(trained.layers[0].name.clone())));
    Ok(())
}

/// The spikes that act on a layer, listed by step. First come the inputs that fire in the step. In a recurrent layer,
/// the layer's own neurons that fire in the same step follow: neuron 0 has the first number after those of the inputs.
struct Drive {
    /// For each step, the index in `spikes` just after the step's last spike.
    ends: Vec<usize>,
    spikes: Vec<u16>,
}

impl Drive {
    /// Lists the spikes that act on a layer, in the order in which the chip applies them. In each step, the inputs come
    /// first. In a recurrent layer, its own spikes of the same step follow, as `fired` lists them.
    fn new(inputs: &Trains, layer: &Layer, fired: &Trains) -> Self {
        let (mut ends, mut spikes) = (Vec::new(), Vec::new());
        let first = layer.inputs() as u16;
        for (inputs, fired) in inputs.iter().zip(fired) {
            spikes.extend(inputs);
            if !layer.recurrent.is_empty() {
                spikes.extend(fired.iter().map(|own| first + own));
            }
            ends.push(spikes.len());
        }
        Self { ends, spikes }
    }
}

/// Returns, for each neuron, the number of its spikes in each step.
fn targets(fired: &Trains, neurons: usize) -> Vec<Vec<u16>> {
    let mut counts = vec![vec![0; fired.len()]; neurons];
    for (step, fired) in fired.iter().enumerate() {
        for &neuron in fired {
            counts[usize::from(neuron)][step] += 1;
        }
    }
    counts
}

impl ChipLayer {
    /// Runs the layer as the chip does: all neurons compare their potentials with their thresholds after each spike,
    /// and the spikes of the layer's own neurons wait in a queue. Returns the neurons that fire in each step. `own` is
    /// the index of the first recurrent weight in [`weights`](ChipNeuron::weights), or `None` if the layer is not
    /// recurrent. `steps_a_leak` is the number of steps between two leaks.
    fn fired(&self, inputs: &Trains, own: Option<usize>, steps_a_leak: usize) -> Trains {
        let mut potentials = vec![0_i32; self.neurons.len()];
        let mut act = |weight: &dyn Fn(&ChipNeuron) -> i8, out: &mut Vec<u16>| {
            for ((at, neuron), potential) in (0..).zip(&self.neurons).zip(&mut potentials) {
                *potential = neuron.driven(*potential, weight(neuron));
                if *potential >= i32::from(neuron.threshold) {
                    *potential = 0;
                    out.push(at);
                }
            }
        };
        let has_bias = self.neurons.iter().any(|neuron| neuron.bias != 0);
        let step = |(step, inputs): (usize, &Vec<u16>)| {
            let mut out = Vec::new();
            if step > 0 && step.is_multiple_of(steps_a_leak) {
                act(&|_| LEAK, &mut out);
            }
            if has_bias {
                act(&|neuron| neuron.bias, &mut out);
            }
            let (mut waiting, mut seen) = (VecDeque::new(), 0);
            let mut inputs = inputs.iter().copied();
            loop {
                // The chip takes an input before it takes the next spike from its queue.
                waiting.extend(inputs.next());
                if let Some(own) = own {
                    waiting.extend(out[seen..].iter().map(|&neuron| own as u16 + neuron));
                    seen = out.len();
                }
                let Some(spike) = waiting.pop_front() else { break };
                act(&|neuron| neuron.weights[usize::from(spike)], &mut out);
                if out.len() > MOST_SPIKES {
                    break;
                }
            }
            out
        };
        inputs.iter().enumerate().map(step).collect()
    }
}

/// The parameters of a neuron that the search varies.
#[derive(Clone, Copy)]
struct Choice {
    /// Factor that converts a weight on the chip to the units of the trained network.
    unit: f64,
    threshold: u16,
    leak: u8,
}

/// The aim of a search: the spikes that a neuron should fire in response to the spikes that act on it.
struct Aim<'a> {
    drive: &'a Drive,
    /// For each step, the number of spikes that the neuron should have.
    target: &'a [u16],
    steps_a_leak: usize,
}

/// Searches for the parameters with which the spikes of neuron `at` are nearest to the target of `aim`. Returns the
/// distance between the spikes and the target, and the neuron. `climbs` is the number of initial choices of parameters
/// that the search improves. If `climbs` is 0, the search takes the best initial choice as it is.
fn search(layer: &Layer, at: usize, aim: &Aim, climbs: usize) -> (f64, ChipNeuron) {
    let own = layer.recurrent.get(at).into_iter().flatten();
    let weights: Vec<f64> = layer.weights[at].iter().chain(own).copied().collect();
    let bias = layer.bias[at];
    let neuron = |choice: Choice| ChipNeuron::new(&weights, bias, choice);
    let distance = |choice, most| neuron(choice).distance(aim, most);
    let first = choices(layer, at, aim.steps_a_leak);
    let (least, best) = climb(first, Choice::neighbours, distance, climbs);
    (least, neuron(best))
}

/// Returns the initial choices of parameters for neuron `at`. The choices combine several scales of the neuron's
/// weights with several leaks. The threshold is multiplied by the same factor as the weights.
fn choices(layer: &Layer, at: usize, steps_a_leak: usize) -> Vec<Choice> {
    let own = layer.recurrent.get(at).into_iter().flatten();
    let weights = layer.weights[at].iter().chain(own).chain(&layer.bias[at..=at]);
    let largest = weights.fold(0.0_f64, |most, weight| most.max(weight.abs()));
    let Neuron { keep, threshold, leak } = layer.neurons[at];
    let mut choices = Vec::new();
    for most in LARGEST {
        let unit = if largest > 0.0 { largest / most } else { 1.0 };
        let threshold = fires_at(threshold / unit, layer.fires).min(MAX_THRESHOLD);
        let lost = (1.0 - keep.powi(steps_a_leak as i32)) * threshold / 2.0
            + leak / unit * steps_a_leak as f64;
        let leaks = LEAKS.iter().map(|part| (part * lost).round().min(MAX_LEAK) as u8);
        let leaks: BTreeSet<u8> = leaks.collect();
        let of_leak = |leak| Choice { unit, threshold: threshold as u16, leak };
        choices.extend(leaks.into_iter().map(of_leak));
    }
    choices
}

impl Choice {
    fn neighbours(self) -> [Self; 10] {
        let Self { unit, threshold, leak } = self;
        let threshold = |by| threshold.saturating_add_signed(by).clamp(1, MAX_THRESHOLD as u16);
        let leak = |by| leak.saturating_add_signed(by).min(MAX_LEAK as u8);
        [
            Self { threshold: threshold(1), ..self },
            Self { threshold: threshold(-1), ..self },
            Self { leak: leak(1), ..self },
            Self { leak: leak(-1), ..self },
            Self { threshold: threshold(2), ..self },
            Self { threshold: threshold(-2), ..self },
            Self { unit: unit * 1.05, ..self },
            Self { unit: unit / 1.05, ..self },
            Self { threshold: threshold(1), leak: leak(-1), ..self },
            Self { threshold: threshold(-1), leak: leak(1), ..self },
        ]
    }
}

impl ChipNeuron {
    fn new(weights: &[f64], bias: f64, choice: Choice) -> Self {
        let Choice { unit, threshold, leak } = choice;
        let mut clipped = 0;
        let mut quantised = |weight: &f64| {
            let rounded = (weight / unit).round();
            clipped += usize::from(!(-8.0..=7.0).contains(&rounded));
            rounded.clamp(-8.0, 7.0) as i8
        };
        let weights = weights.iter().map(&mut quantised).collect();
        let bias = quantised(&bias);
        Self { weights, bias, threshold, leak, clipped }
    }

    /// Returns the potential after `weight` was added to it, or after a leak if `weight` is [`LEAK`].
    fn driven(&self, potential: i32, weight: i8) -> i32 {
        if weight == LEAK {
            potential.signum() * (potential.abs() - i32::from(self.leak)).max(0)
        } else {
            (potential + i32::from(weight)).clamp(-2048, 2047)
        }
    }

    /// Runs the neuron on the spikes in `aim.drive`. Returns the distance between the neuron's spikes and the spikes in
    /// `aim.target`. Returns infinity as soon as the distance reaches `most`.
    fn distance(&self, aim: &Aim, most: f64) -> f64 {
        let mut distance = Distance::default();
        let threshold = i32::from(self.threshold);
        let (mut potential, mut until_leak, mut first) = (0_i32, aim.steps_a_leak, 0);
        for (&end, &target) in aim.drive.ends.iter().zip(aim.target) {
            if until_leak == 0 {
                until_leak = aim.steps_a_leak;
                potential = self.driven(potential, LEAK);
            }
            until_leak -= 1;
            let mut fired = 0;
            let mut act = |weight| {
                potential = self.driven(potential, weight);
                if potential >= threshold {
                    potential = 0;
                    fired += 1;
                }
            };
            if self.bias != 0 {
                act(self.bias);
            }
            for &spike in &aim.drive.spikes[first..end] {
                act(self.weights[usize::from(spike)]);
            }
            first = end;
            distance.step(fired, usize::from(target));
            if fired != usize::from(target) && distance.so_far() >= most {
                return f64::INFINITY;
            }
        }
        distance.value()
    }
}

impl Quantised {
    /// Returns the layer that the chip's neuron `neuron` belongs to, and its index in the layer; `None` if the neuron
    /// is not in use.
    pub(super) fn place(&self, neuron: usize) -> Option<(usize, usize)> {
        let mut first = 0;
        for (at, layer) in self.layers.iter().enumerate() {
            if neuron < first + layer.neurons.len() {
                return Some((at, neuron - first));
            }
            first += layer.neurons.len();
        }
        None
    }

    /// Returns whether any neuron leaks.
    pub(super) fn leaks(&self) -> bool {
        self.layers.iter().flat_map(|layer| &layer.neurons).any(|neuron| neuron.leak > 0)
    }

    /// Returns the number of neurons in all layers.
    pub(super) fn count(&self) -> usize {
        self.layers.iter().map(|layer| layer.neurons.len()).sum()
    }

    fn at(&self, neuron: usize) -> Option<(usize, &ChipNeuron)> {
        let (layer, place) = self.place(neuron)?;
        Some((layer, self.layers[layer].neurons.get(place)?))
    }
}

impl Describe<TinyOdinInput> for Quantised {
    fn neurons(&self) -> u16 {
        self.count() as u16
    }

    fn neuron(&self, neuron: u8) -> TinyOdinNeuron {
        match self.at(neuron.into()) {
            Some((_, &ChipNeuron { threshold, leak, .. })) => {
                TinyOdinNeuron { threshold, leak, ..TinyOdinNeuron::REST }
            }
            None => TinyOdinInput::DISABLED,
        }
    }

    fn inputs(&self) -> u16 {
        (self.inputs + usize::from(self.has_bias)) as u16
    }

    fn virtual_input(&self, _: u16) -> Option<(u8, i8)> {
        None
    }

    fn input_weight(&self, input: u16, post: u8) -> i8 {
        match self.at(post.into()) {
            Some((_, neuron)) if usize::from(input) == self.inputs => neuron.bias,
            Some((0, neuron)) if usize::from(input) < self.inputs => {
                neuron.weights[usize::from(input)]
            }
            _ => 0,
        }
    }

    fn is_recurrent(&self) -> bool {
        self.is_recurrent
    }

    fn weight(&self, pre: u8, post: u8) -> i8 {
        match (self.place(pre.into()), self.at(post.into())) {
            (Some((from, place)), Some((to, neuron))) if from + 1 == to => neuron.weights[place],
            (Some((from, place)), Some((to, neuron))) if from == to => {
                neuron.weights.get(self.layers[to].inputs + place).copied().unwrap_or(0)
            }
            _ => 0,
        }
    }

    fn output(&self, neuron: u8) -> Option<u16> {
        let (layer, place) = self.place(neuron.into())?;
        (layer + 1 == self.layers.len()).then_some(place as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Fires, Reset};

    /// Makes random inputs with at most one spike in a step. If a step had several spikes, the chip's neuron might fire
    /// at the first spike. The weights of the other spikes would then remain in the neuron's potential.
    fn some(inputs: u16, steps: u32) -> Trains {
        let fires = |step: u32, input: u16| {
            let mixed = (step * 257 + u32::from(input) * 7919).wrapping_mul(0x9E37_79B9);
            mixed >> 24 < 70
        };
        let one = |step| (0..inputs).filter(|&input| fires(step, input)).take(1).collect();
        (0..steps).map(one).collect()
    }

    fn layer(weights: Vec<Vec<f64>>, keep: f64, threshold: f64) -> Layer {
        let count = weights.len();
        Layer {
            name: "one".to_owned(),
            weights,
            recurrent: vec![],
            bias: vec![0.0; count],
            neurons: vec![Neuron { keep, threshold, leak: 0.0 }; count],
            reset: Reset::ToValue,
            fires: Fires::Above,
        }
    }

    /// If the trained weights are whole numbers in the chip's range, and neurons do not leak, the chip's neurons fire
    /// in the same steps as the trained ones.
    #[test]
    fn whole_weights_without_a_leak_lose_nothing() {
        let weights = vec![vec![3.0, 7.0, 1.0], vec![2.0, 0.0, 5.0]];
        let trained = Trained::new(vec![layer(weights, 1.0, 20.0)]).unwrap();
        let inputs = some(3, 400);
        let fired = trained.run(&inputs);
        let quantised = quantise(&trained, &inputs, &fired, &|_, _| ()).unwrap();
        for (at, neuron) in quantised.layers[0].neurons.iter().enumerate() {
            let target = &targets(&fired[0], 2)[at];
            assert!(target.iter().sum::<u16>() > 10);
            let drive = &Drive::new(&inputs, &trained.layers[0], &fired[0]);
            let aim = Aim { drive, target, steps_a_leak: quantised.steps_a_leak };
            assert_eq!(neuron.distance(&aim, f64::INFINITY), 0.0, "{neuron:?}");
            assert_eq!((neuron.leak, neuron.clipped), (0, 0));
        }
        assert_eq!(quantised.layers[0].neurons[0].weights, [3, 7, 1]);
        assert_eq!(quantised.layers[0].neurons[0].threshold, 21, "fires at, not above");
    }

    #[test]
    fn a_leak_by_shares_becomes_one_by_steps_that_is_nearer_than_none() {
        let trained = Trained::new(vec![layer(vec![vec![0.4, 0.31, -0.12]], 0.9, 1.0)]).unwrap();
        let inputs = some(3, 2_000);
        let fired = trained.run(&inputs);
        let quantised = quantise(&trained, &inputs, &fired, &|_, _| ()).unwrap();
        let neuron = &quantised.layers[0].neurons[0];
        let target = &targets(&fired[0], 1)[0];
        let drive = &Drive::new(&inputs, &trained.layers[0], &fired[0]);
        let aim = Aim { drive, target, steps_a_leak: quantised.steps_a_leak };
        let distance = |leak| ChipNeuron { leak, ..neuron.clone() }.distance(&aim, f64::INFINITY);
        assert!(neuron.leak > 0);
        let (with, without) = (distance(neuron.leak), distance(0));
        assert!(with < 0.8 * without, "{with}, {without}");
    }

    #[test]
    fn all_that_the_chip_holds_is_within_its_ranges() {
        for (weight, threshold) in [(1e-9, 1.0), (1e9, 1.0), (1.0, 1e9), (0.0, 1.0), (1.0, 1e-12)] {
            let weights = vec![vec![weight, -weight]];
            let trained = Trained::new(vec![layer(weights, 0.5, threshold)]).unwrap();
            let inputs = some(2, 50);
            let quantised = quantise(&trained, &inputs, &trained.run(&inputs), &|_, _| ()).unwrap();
            assert!(TinyOdinInput::neuron_bytes::<(), ()>(&quantised.neuron(0)).is_ok());
            assert!((0..2).all(|input| (-8..=7).contains(&quantised.input_weight(input, 0))));
        }
    }

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let refused = |layers: Vec<Layer>| {
            let trained = Trained::new(layers).unwrap();
            let inputs = vec![vec![]];
            let fired = trained.run(&inputs);
            quantise(&trained, &inputs, &fired, &|_, _| ()).unwrap_err().to_string()
        };
        let wide = layer(vec![vec![1.0]; 257], 1.0, 1.0);
        assert!(refused(vec![wide]).starts_with("one: the chip has 256 neurons"));
        let one = layer(vec![vec![1.0; 200]; 50], 1.0, 1.0);
        let two = layer(vec![vec![1.0; 50]; 10], 1.0, 1.0);
        let said = refused(vec![one, two]);
        assert!(
            said.contains("200 inputs with 60 neurons that send spikes to neurons need 260"),
            "{said}"
        );
    }
}
