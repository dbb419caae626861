//! From numbers in double precision to what tinyODIN holds.

use super::trained::{Layer, Neuron};
use super::{Distance, Trained, Trains};
use anyhow::{Result, ensure};
use rayon::prelude::*;
use spikewire::chip::{Describe, Input, TinyOdinInput, TinyOdinNeuron};
use std::collections::BTreeSet;

const NEURONS: usize = 256;
const ROWS: usize = 256;
const MAX_THRESHOLD: f64 = 2047.0;
const MAX_LEAK: f64 = 127.0;
/// What the largest weight may become: above 7 it is clipped, for the sake of the others.
const LARGEST: [f64; 20] = [
    7.0, 6.0, 8.0, 5.0, 9.0, 4.0, 10.0, 3.0, 12.0, 2.0, 14.0, 1.0, 16.0, 6.5, 5.5, 4.5, 3.5, 7.5,
    8.5, 20.0,
];
/// From how many of them the search goes on.
const CLIMBS: usize = 2;
/// Of the leak at half the threshold, which parts are tried.
const LEAKS: [f64; 7] = [1.0, 0.5, 0.75, 1.5, 2.0, 3.0, 0.0];
/// Steps from one leak to the next, of all neurons, that are tried.
const STEPS: [usize; 6] = [1, 2, 3, 4, 8, 16];

/// A network as tinyODIN holds it: the layers' neurons one after the other, then, if a layer has a bias, an input more
/// that every step must be told.
#[derive(Clone, Debug)]
pub(crate) struct Quantised {
    /// The layers.
    pub layers: Vec<ChipLayer>,
    /// Inputs without the bias.
    inputs: usize,
    /// Whether there is a bias.
    pub has_bias: bool,
    /// How many steps go from one leak of all neurons to the next.
    pub steps_a_leak: usize,
}

/// A layer's neurons.
#[derive(Clone, Debug)]
pub(crate) struct ChipLayer {
    /// As its file calls it.
    pub name: String,
    /// In order.
    pub neurons: Vec<ChipNeuron>,
}

/// A neuron, and what leads to it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChipNeuron {
    /// By input.
    pub weights: Vec<i8>,
    /// What every step adds.
    pub bias: i8,
    /// Where it fires.
    pub threshold: u16,
    /// What a leak takes.
    pub leak: u8,
    /// How many weights were larger than the chip's.
    pub clipped: usize,
}

/// Brings a network onto the chip, layer by layer: for each neuron the scale of its weights, its threshold and its
/// leak with which its spikes are nearest to the original's, driven by what the chip's layer before fires.
///
/// # Errors
/// It does not fit.
pub(crate) fn quantise(trained: &Trained, inputs: &Trains, fired: &[Trains]) -> Result<Quantised> {
    let has_bias = trained.layers.iter().any(|layer| layer.bias.iter().any(|bias| *bias != 0.0));
    check_room(trained, has_bias)?;
    let leaks =
        trained.layers.iter().flat_map(|layer| &layer.neurons).any(|neuron| neuron.keep < 1.0);
    let tried = if leaks { &STEPS[..] } else { &STEPS[..1] };
    let layers = |steps_a_leak, climbs| {
        let (mut distance, mut layers) = (0.0, Vec::new());
        let mut before = inputs.clone();
        for (layer, fired) in trained.layers.iter().zip(fired) {
            let search = |neuron| {
                let target = spikes_of(neuron, fired);
                search(layer, neuron, &Aim { inputs: &before, target, steps_a_leak }, climbs)
            };
            let searched: Vec<(f64, ChipNeuron)> =
                (0..layer.neurons.len()).into_par_iter().map(search).collect();
            distance += searched.iter().map(|(distance, _)| distance).sum::<f64>();
            let neurons: Vec<_> = searched.into_iter().map(|(_, neuron)| neuron).collect();
            before = fired_by(&neurons, &before, steps_a_leak);
            layers.push(ChipLayer { name: layer.name.clone(), neurons });
        }
        (distance, layers)
    };
    let rough = tried.iter().map(|&steps| (layers(steps, 0).0, steps));
    // The first of equals, so that leaks come often where it does not matter.
    let best = rough.min_by(|(one, _), (other, _)| one.total_cmp(other));
    let steps_a_leak = best.map_or(1, |(_, steps)| steps);
    let (_, layers) = layers(steps_a_leak, CLIMBS);
    Ok(Quantised { layers, inputs: trained.inputs(), has_bias, steps_a_leak })
}

fn check_room(trained: &Trained, has_bias: bool) -> Result<()> {
    let mut neurons = 0;
    for layer in &trained.layers {
        neurons += layer.neurons.len();
        ensure!(
            neurons <= NEURONS,
            "{}: the chip has {NEURONS} neurons, and with this layer's {} the network has {neurons}",
            layer.name,
            layer.neurons.len()
        );
    }
    let own = if trained.layers.len() > 1 { neurons } else { 0 };
    let inputs = trained.inputs() + usize::from(has_bias);
    ensure!(
        own + inputs <= ROWS,
        "{}: the chip has {ROWS} rows of synapses, and {inputs} inputs{} with {own} neurons that send spikes to \
         neurons need {}",
        trained.layers[0].name,
        if has_bias { ", one of them the bias," } else { "" },
        own + inputs
    );
    Ok(())
}

/// Who of these neurons fires, by step.
fn fired_by(neurons: &[ChipNeuron], inputs: &Trains, steps_a_leak: usize) -> Trains {
    let mut fired = vec![Vec::new(); inputs.len()];
    for (at, neuron) in (0..).zip(neurons) {
        neuron.run(inputs, steps_a_leak, |step, count| {
            fired[step].extend(std::iter::repeat_n(at, count));
        });
    }
    fired
}

/// How often a neuron fires, by step.
fn spikes_of(neuron: usize, fired: &Trains) -> Vec<usize> {
    let is_own = |fired: &&u16| usize::from(**fired) == neuron;
    fired.iter().map(|fired| fired.iter().filter(is_own).count()).collect()
}

/// What of a neuron is searched.
#[derive(Clone, Copy)]
struct Choice {
    /// What a weight of 1 on the chip stands for.
    unit: f64,
    threshold: u16,
    leak: u8,
}

/// What a neuron is to do.
struct Aim<'a> {
    inputs: &'a Trains,
    /// How often it fires, by step.
    target: Vec<usize>,
    steps_a_leak: usize,
}

/// The best neuron, and its distance from the original. From the best choices the search goes on, from so many.
fn search(layer: &Layer, at: usize, aim: &Aim, climbs: usize) -> (f64, ChipNeuron) {
    let (weights, bias) = (&layer.weights[at], layer.bias[at]);
    let neuron = |choice: Choice| ChipNeuron::new(weights, bias, choice);
    let distance = |choice| neuron(choice).distance(aim);
    let mut tried: Vec<(f64, Choice)> = choices(layer, at, aim.steps_a_leak)
        .into_iter()
        .map(|choice| (distance(choice), choice))
        .collect();
    // Stable: of equals the first.
    tried.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    for (least, best) in tried.iter_mut().take(climbs) {
        // A step of scale, threshold or leak, for as long as it helps.
        let mut is_better = *least > 0.0;
        while is_better {
            is_better = false;
            for choice in best.neighbours() {
                let distance = distance(choice);
                if distance < *least {
                    (*least, *best, is_better) = (distance, choice, true);
                }
            }
        }
    }
    let best = tried.into_iter().min_by(|(one, _), (other, _)| one.total_cmp(other));
    let (least, best) = best.expect("there is a choice at least");
    (least, neuron(best))
}

/// Where the search starts: scales, with the threshold that belongs to them and some leaks.
fn choices(layer: &Layer, at: usize, steps_a_leak: usize) -> Vec<Choice> {
    let weights = layer.weights[at].iter().chain(&layer.bias[at..=at]);
    let largest = weights.fold(0.0_f64, |most, weight| most.max(weight.abs()));
    let Neuron { keep, threshold } = layer.neurons[at];
    let mut choices = Vec::new();
    for most in LARGEST {
        let unit = if largest > 0.0 { largest / most } else { 1.0 };
        // It fires at its threshold, where the original fires above; but for what rounding adds.
        let threshold = ((threshold / unit + 1e-9).floor() + 1.0).min(MAX_THRESHOLD);
        let lost = (1.0 - keep.powi(steps_a_leak as i32)) * threshold / 2.0;
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

    /// How far its spikes are from what they should be.
    fn distance(&self, aim: &Aim) -> f64 {
        let mut distance = Distance::default();
        self.run(aim.inputs, aim.steps_a_leak, |step, fired| {
            distance.step(fired, aim.target[step]);
        });
        distance.value()
    }

    /// Says by step how often it fires, in the arithmetic of the chip's neurons.
    fn run(&self, inputs: &Trains, steps_a_leak: usize, mut each: impl FnMut(usize, usize)) {
        let mut potential = 0_i32;
        let threshold = i32::from(self.threshold);
        let leak = i32::from(self.leak);
        let mut until_leak = steps_a_leak;
        for (step, inputs) in inputs.iter().enumerate() {
            if until_leak == 0 {
                until_leak = steps_a_leak;
                potential = potential.signum() * (potential.abs() - leak).max(0);
            }
            until_leak -= 1;
            let mut fired = 0;
            let bias = [self.bias].into_iter().filter(|bias| *bias != 0);
            let driven = inputs.iter().map(|&input| self.weights[usize::from(input)]);
            for weight in bias.chain(driven) {
                potential = (potential + i32::from(weight)).clamp(-2048, 2047);
                if potential >= threshold {
                    potential = 0;
                    fired += 1;
                }
            }
            each(step, fired);
        }
    }
}

impl Quantised {
    /// The layer and the place in it of a neuron of the chip.
    pub(crate) fn place(&self, neuron: usize) -> Option<(usize, usize)> {
        let mut first = 0;
        for (at, layer) in self.layers.iter().enumerate() {
            if neuron < first + layer.neurons.len() {
                return Some((at, neuron - first));
            }
            first += layer.neurons.len();
        }
        None
    }

    /// How many neurons.
    pub(crate) fn count(&self) -> usize {
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
            Some((0, neuron)) => neuron.weights.get(usize::from(input)).copied().unwrap_or(0),
            _ => 0,
        }
    }

    fn is_recurrent(&self) -> bool {
        self.layers.len() > 1
    }

    fn weight(&self, pre: u8, post: u8) -> i8 {
        match (self.place(pre.into()), self.at(post.into())) {
            (Some((from, place)), Some((to, neuron))) if from + 1 == to => neuron.weights[place],
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

    /// Steps of a spike at most: of several the chip's neuron may fire at the first, and keep what the others add.
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
            bias: vec![0.0; count],
            neurons: vec![Neuron { keep, threshold }; count],
        }
    }

    /// What the chip can hold comes out as it is: the neurons fire at the same steps.
    #[test]
    fn whole_weights_without_a_leak_lose_nothing() {
        let weights = vec![vec![3.0, 7.0, 1.0], vec![2.0, 0.0, 5.0]];
        let trained = Trained::new(vec![layer(weights, 1.0, 20.0)]).unwrap();
        let inputs = some(3, 400);
        let fired = trained.run(&inputs);
        let quantised = quantise(&trained, &inputs, &fired).unwrap();
        for (at, neuron) in quantised.layers[0].neurons.iter().enumerate() {
            let target = spikes_of(at, &fired[0]);
            assert!(target.iter().sum::<usize>() > 10);
            let aim = Aim { inputs: &inputs, target, steps_a_leak: quantised.steps_a_leak };
            assert_eq!(neuron.distance(&aim), 0.0, "{neuron:?}");
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
        let quantised = quantise(&trained, &inputs, &fired).unwrap();
        let neuron = &quantised.layers[0].neurons[0];
        let target = spikes_of(0, &fired[0]);
        let aim = Aim { inputs: &inputs, target, steps_a_leak: quantised.steps_a_leak };
        let distance = |leak| ChipNeuron { leak, ..neuron.clone() }.distance(&aim);
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
            let quantised = quantise(&trained, &inputs, &trained.run(&inputs)).unwrap();
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
            quantise(&trained, &inputs, &fired).unwrap_err().to_string()
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
