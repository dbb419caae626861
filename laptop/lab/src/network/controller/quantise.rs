//! Converts a network from double precision to the number types of the controller.

use super::super::{Distance, Trains};
use super::net::{Layer, Net, Neuron, Recurrent, Spike};
use super::number::ONE;
use super::rule::Rule;
use rayon::prelude::*;
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Scales to try for a neuron's weights, as multiples of the scale at which the largest weight becomes 127. Multiples
/// above 1 clip the largest weights, so that the others are rounded less.
const SCALES: [f64; 14] =
    [1.0, 0.97, 0.94, 0.91, 0.88, 0.85, 0.8, 0.75, 0.7, 1.05, 1.1, 1.2, 1.4, 1.8];
/// Largest absolute value of a weight after it was converted to an integer.
const LARGEST: f64 = 127.0;
/// Maximum number of bits by which a layer's weights are shifted left. The shift gives potentials more binary digits
/// than weights. A smaller shift is used if thresholds, biases or reset values would otherwise leave their range.
const SHIFT: u32 = 8;
/// Largest absolute value of a bias, threshold or reset value after it was converted to an integer.
const MOST: f64 = (1 << 27) as f64;
/// Largest distance from an integer of a number that is taken for it, in units of the integers. Products of doubles that
/// mean an integer are off by less.
const EXACT: f64 = 1e-6;
/// Maximum number of steps of the recording that are simulated in the search for scales.
const STEPS: usize = 4_000;

/// Returns the network with each number rounded to `f32`.
pub(super) fn float(net: &Net<f64>) -> Net<f32> {
    let row = |row: &Vec<f64>| row.iter().map(|&weight| weight as f32).collect::<Vec<_>>();
    let layer = |layer: &Layer<f64>| Layer {
        name: layer.name.clone(),
        weights: layer.weights.iter().map(row).collect(),
        own: match &layer.own {
            Recurrent::None => Recurrent::None,
            Recurrent::Full(rows) => Recurrent::Full(rows.iter().map(row).collect()),
            Recurrent::OneToOne(own) => Recurrent::OneToOne(row(own)),
        },
        neurons: layer
            .neurons
            .iter()
            .map(|neuron| Neuron {
                current: neuron.current.map(|decay| decay as f32),
                decay: neuron.decay as f32,
                bias: neuron.bias as f32,
                inner: neuron.inner as f32,
                spike: neuron.spike.map(|Spike { threshold, reset }| Spike {
                    threshold: threshold as f32,
                    reset: reset as f32,
                }),
            })
            .collect(),
        rule: layer.rule,
    };
    Net { layers: net.layers.iter().map(layer).collect() }
}

/// A network in integers, with weights of 8 bits.
pub(super) struct Integers {
    pub net: Net<i32>,
    /// Left shift of each layer's weights, in bits.
    pub shifts: Vec<u32>,
    /// For each layer, the number of weights that exceeded 8 bits and were clipped.
    pub clipped: Vec<usize>,
    /// For each neuron of the last layer, the factor that converts its integer potential to the units of the trained
    /// network.
    pub units: Vec<f64>,
}

/// Quantises a network to integers. `fired` and `potentials` are the network's spikes and potentials in double
/// precision. Chooses for each neuron the scale of its weights at which its spikes are nearest to `fired`. For a neuron
/// that never fires, chooses the scale at which its potentials are nearest to `potentials`. Calls `progress` with the
/// number of finished neurons and the total number of neurons.
pub(super) fn integers(
    net: &Net<f64>,
    inputs: &Trains,
    fired: &[Trains],
    potentials: &[Vec<f64>],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Integers {
    let total = net.layers.iter().map(|layer| layer.neurons.len()).sum();
    let done = AtomicUsize::new(0);
    let (mut layers, mut shifts, mut clipped) = (Vec::new(), Vec::new(), Vec::new());
    let (mut before, mut units) = (inputs.clone(), Vec::new());
    for (layer, fired) in net.layers.iter().zip(fired) {
        let shift = layer.shift();
        let one = |at: usize| {
            let target: Vec<f64> = match layer.neurons[at].spike {
                Some(_) => fired.iter().map(|fired| f64::from(u8::from(has(fired, at)))).collect(),
                None => potentials.iter().map(|step| step[at]).collect(),
            };
            let first = Column::new(layer, at, SCALES[0], shift);
            if first.is_exact {
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
                return first;
            }
            let tried = SCALES.iter().map(|share| Column::new(layer, at, *share, shift));
            let distance =
                |column: &Column| column.distance(layer.rule, &before, fired, &target, at);
            let tried = tried.map(|column| (distance(&column), column));
            // `min_by` returns the first of equal distances; the first scale clips nothing.
            let (_, best) =
                tried.min_by(|(a, _), (b, _)| a.total_cmp(b)).expect("there are scales");
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
            best
        };
        let columns: Vec<Column> = (0..layer.neurons.len()).into_par_iter().map(one).collect();
        clipped.push(columns.iter().map(|column| column.clipped).sum());
        units = columns.iter().map(|column| column.unit).collect();
        let whole = layer.of(&columns);
        let alone = Net { layers: vec![whole] };
        before = alone.run(&before).fired.pop().unwrap_or_default();
        layers.extend(alone.layers);
        shifts.push(shift);
    }
    Integers { net: Net { layers }, shifts, clipped, units }
}

fn has(fired: &[u16], neuron: usize) -> bool {
    fired.binary_search(&(neuron as u16)).is_ok()
}

/// A neuron in integers, and the weights that lead to the neuron.
struct Column {
    /// The weight of each input, after the layer's left shift.
    weights: Vec<i32>,
    /// The recurrent weights that lead to the neuron, after the left shift. There is one weight for each neuron of the
    /// layer. If neurons do not act on one another, the list contains only the weight from the neuron to itself.
    own: Vec<i32>,
    neuron: Neuron<i32>,
    clipped: usize,
    /// Whether the integers are exactly the trained numbers, as in networks that were trained with them.
    is_exact: bool,
    /// Factor that converts an integer potential to the units of the trained network.
    unit: f64,
}

impl Layer<f64> {
    fn own_weights(&self, at: usize) -> Vec<f64> {
        match &self.own {
            Recurrent::None => vec![],
            Recurrent::Full(rows) => rows.iter().map(|row| row[at]).collect(),
            Recurrent::OneToOne(own) => vec![own[at]],
        }
    }

    /// Returns the scale (the factor for weights) at which the largest weight of neuron `at` becomes 127.
    fn scale(&self, at: usize) -> f64 {
        let own = self.own_weights(at);
        let weights = self.weights.iter().map(|row| row[at]).chain(own);
        let largest = weights.fold(0.0_f64, |most, weight| most.max(weight.abs()));
        let number = self.neurons[at].largest();
        match (largest > 0.0, number > 0.0) {
            (true, _) => LARGEST / largest,
            // The neuron has no weights that differ from 0, so any scale will do.
            (false, true) => LARGEST / number,
            (false, false) => 1.0,
        }
    }

    /// Returns the largest left shift of the layer's weights at which thresholds, biases and reset values stay in their
    /// range.
    fn shift(&self) -> u32 {
        let numbers = (0..self.neurons.len()).map(|at| self.neurons[at].largest() * self.scale(at));
        let most = numbers.fold(0.0, f64::max);
        (0..=SHIFT).rev().find(|shift| most * f64::from(1 << shift) <= MOST).unwrap_or(0)
    }

    fn of(&self, columns: &[Column]) -> Layer<i32> {
        let rows = |count: usize, weight: &dyn Fn(&Column, usize) -> i32| {
            (0..count)
                .map(|row| columns.iter().map(|column| weight(column, row)).collect())
                .collect()
        };
        let own = match &self.own {
            Recurrent::None => Recurrent::None,
            Recurrent::Full(_) => {
                Recurrent::Full(rows(columns.len(), &|column, row| column.own[row]))
            }
            Recurrent::OneToOne(_) => {
                Recurrent::OneToOne(columns.iter().map(|column| column.own[0]).collect())
            }
        };
        Layer {
            name: self.name.clone(),
            weights: rows(self.inputs(), &|column, row| column.weights[row]),
            own,
            neurons: columns.iter().map(|column| column.neuron).collect(),
            rule: self.rule,
        }
    }
}

impl Neuron<f64> {
    fn largest(&self) -> f64 {
        let spike = self.spike.unwrap_or(Spike { threshold: 0.0, reset: 0.0 });
        [self.bias, self.inner, spike.threshold, spike.reset]
            .into_iter()
            .fold(0.0, |most, n| most.max(n.abs()))
    }
}

impl Column {
    fn new(layer: &Layer<f64>, at: usize, share: f64, shift: u32) -> Self {
        let neuron = &layer.neurons[at];
        let finer = f64::from(1 << shift);
        // If the threshold is far above the weights, its range limits the scale, and the weights become small.
        let scale = (layer.scale(at) * share).min(MOST / finer / neuron.largest().max(1e-300));
        let (mut clipped, is_exact) = (0, Cell::new(true));
        let rounded = |number: f64| {
            let rounded = number.round();
            is_exact.set(is_exact.get() && (number - rounded).abs() < EXACT);
            rounded
        };
        let mut weight = |weight: f64| {
            let rounded = rounded(weight * scale);
            clipped += usize::from(rounded.abs() > LARGEST);
            (rounded.clamp(-LARGEST, LARGEST) as i32) << shift
        };
        let weights = layer.weights.iter().map(|row| weight(row[at])).collect();
        let own = layer.own_weights(at).into_iter().map(&mut weight).collect();
        let whole = |number: f64| rounded(number * scale * finer) as i32;
        let part = |decay: f64| rounded(decay * ONE) as u32;
        let neuron = Neuron {
            current: neuron.current.map(part),
            decay: part(neuron.decay),
            bias: whole(neuron.bias),
            inner: whole(neuron.inner),
            spike: neuron.spike.map(|Spike { threshold, reset }| Spike {
                threshold: whole(threshold),
                reset: whole(reset),
            }),
        };
        let is_exact = is_exact.get();
        Self { weights, own, neuron, clipped, is_exact, unit: 1.0 / (scale * finer) }
    }

    /// Runs neuron `at` in integers, and returns the distance of its spikes or potentials from `target`. `own` contains
    /// the spikes of the neuron's layer in double precision, which act on the neuron through recurrent weights.
    fn distance(
        &self,
        rule: Rule,
        inputs: &Trains,
        own: &Trains,
        target: &[f64],
        at: usize,
    ) -> f64 {
        let (mut v, mut current) = (0, 0);
        let (mut distance, mut squares) = (Distance::default(), 0.0);
        let mut before: &[u16] = &[];
        for ((inputs, own), &target) in inputs.iter().zip(own).zip(target).take(STEPS) {
            let mut sum = self.neuron.bias;
            for &input in inputs {
                sum = sum.wrapping_add(self.weights[usize::from(input)]);
            }
            match self.own[..] {
                [] => {}
                // A single weight leads from the neuron to itself; or the layer has one neuron, for which that is the
                // same.
                [one] => sum = sum.wrapping_add(if has(before, at) { one } else { 0 }),
                _ => {
                    for &fired in before {
                        sum = sum.wrapping_add(self.own[usize::from(fired)]);
                    }
                }
            }
            let (fires, _) = self.neuron.step(&rule, &mut v, &mut current, sum);
            if self.neuron.spike.is_some() {
                distance.step(fires.into(), target as usize);
            } else {
                squares += (f64::from(v) * self.unit - target).powi(2);
            }
            before = own;
        }
        distance.value() + squares
    }
}
