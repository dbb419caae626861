//! A network in the one form that all frameworks' neurons have, and what it does.

use super::super::Trains;
use super::number::Number;
use super::rule::{Current, Fires, Reset, Rule};

/// A network in these numbers.
#[derive(Clone, Debug)]
pub(super) struct Net<K: Number> {
    pub layers: Vec<Layer<K>>,
}

/// Neurons, and what leads to them.
#[derive(Clone, Debug)]
pub(super) struct Layer<K: Number> {
    /// The name in its file.
    pub name: String,
    /// By input, then neuron.
    pub weights: Vec<Vec<K>>,
    pub own: Own<K>,
    pub neurons: Vec<Neuron<K>>,
    pub rule: Rule,
}

/// What leads a layer's spikes back to it, a step later.
#[derive(Clone, Debug)]
pub(super) enum Own<K> {
    None,
    /// By the neuron that fired, then neuron.
    Full(Vec<Vec<K>>),
    /// Each to itself.
    OneToOne(Vec<K>),
}

/// The crate's form of a neuron: `I = a I + x + bias`, then `u = b v + I + inner`; without a current `u = b v + x + bias`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neuron<K: Number> {
    /// The share of the current that a step leaves.
    pub current: Option<K::Factor>,
    /// The share of the potential that a step leaves.
    pub decay: K::Factor,
    pub bias: K,
    /// What is added behind the current.
    pub inner: K,
    /// Neurons that never fire have none.
    pub spike: Option<Spike<K>>,
}

/// When a neuron fires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spike<K> {
    pub threshold: K,
    /// The value that the potential is set to, or what is subtracted from it.
    pub reset: K,
}

impl<K: Number> Neuron<K> {
    /// Takes a step with the sum of bias and inputs, and tells if the neuron fires and if a number left its range.
    #[inline]
    pub(super) fn step(&self, rule: &Rule, v: &mut K, current: &mut K, sum: K) -> (bool, bool) {
        let mut is_outside = false;
        let input = match self.current {
            None => sum,
            Some(decay) => {
                let before = *current;
                let next = before.scaled(decay).plus(sum);
                (*current, is_outside) = next.bounded();
                (if rule.current == Current::Old { before } else { next }).plus(self.inner)
            }
        };
        let (next, fires) = self.fire(rule, *v, input);
        let (next, outside) = next.bounded();
        *v = next;
        (fires, is_outside || outside)
    }

    fn fire(&self, rule: &Rule, v: K, input: K) -> (K, bool) {
        let integrate = |v: K| v.scaled(self.decay).plus(input);
        let Some(Spike { threshold, reset }) = self.spike else { return (integrate(v), false) };
        let fires = |v: K| v > threshold || rule.fires == Fires::At && v == threshold;
        match rule.reset {
            Reset::ToValue => {
                let u = integrate(v);
                (if fires(u) { reset } else { u }, fires(u))
            }
            Reset::ToValueLate => {
                let u = integrate(if fires(v) { reset } else { v });
                (u, fires(u))
            }
            Reset::ToValueHeld => {
                let u = if fires(v) { reset } else { integrate(v) };
                (u, fires(u))
            }
            Reset::Subtract => {
                let u = integrate(v);
                (if fires(u) { u.minus(reset) } else { u }, fires(u))
            }
            Reset::SubtractLate => {
                let u = integrate(v);
                let u = if fires(v) { u.minus(reset) } else { u };
                (u, fires(u))
            }
            Reset::SubtractNoDelay => {
                let u = integrate(v);
                let less = u.minus(reset);
                let fires = fires(if fires(v) { less } else { u });
                (if fires { less } else { u }, fires)
            }
        }
    }
}

/// What a layer keeps from step to step.
#[derive(Clone)]
pub(super) struct State<K> {
    pub potentials: Vec<K>,
    currents: Vec<K>,
    pub fired: Vec<u16>,
}

impl<K: Number> Layer<K> {
    pub(super) fn inputs(&self) -> usize {
        self.weights.len()
    }

    /// Weights that are added in a step with so many spikes of inputs, and of its own in the step before.
    pub(super) fn operations(&self, inputs: usize, own: usize) -> usize {
        let back = match self.own {
            Own::None => 0,
            Own::Full(_) => own * self.neurons.len(),
            Own::OneToOne(_) => own,
        };
        inputs * self.neurons.len() + back
    }

    fn step(&self, state: &mut State<K>, inputs: &[u16]) -> u32 {
        let before = std::mem::take(&mut state.fired);
        let mut saturated = 0;
        for (at, neuron) in self.neurons.iter().enumerate() {
            // In the crate's order: the bias comes first.
            let mut sum = neuron.bias;
            for &input in inputs {
                sum = sum.plus(self.weights[usize::from(input)][at]);
            }
            match &self.own {
                Own::None => {}
                Own::Full(own) => {
                    for &fired in &before {
                        sum = sum.plus(own[usize::from(fired)][at]);
                    }
                }
                Own::OneToOne(own) => {
                    if before.binary_search(&(at as u16)).is_ok() {
                        sum = sum.plus(own[at]);
                    }
                }
            }
            let (v, current) = (&mut state.potentials[at], &mut state.currents[at]);
            let (fires, outside) = neuron.step(&self.rule, v, current, sum);
            saturated += u32::from(outside);
            if fires {
                state.fired.push(at as u16);
            }
        }
        saturated
    }
}

/// What a network did.
#[derive(Default)]
pub(super) struct Done<K> {
    /// The neurons that fired, by layer and step.
    pub fired: Vec<Trains>,
    /// The last layer's potentials, by step.
    pub potentials: Vec<Vec<K>>,
    /// Weights added, by step.
    pub operations: Vec<u64>,
    /// Numbers that left their range.
    pub saturated: u32,
}

impl<K: Number> Net<K> {
    /// How neurons fire, a line for all or one for each layer that does.
    pub(super) fn rules(&self) -> Vec<String> {
        let fires = |layer: &&Layer<K>| layer.neurons.iter().any(|neuron| neuron.spike.is_some());
        let firing: Vec<_> = self.layers.iter().filter(fires).collect();
        match firing[..] {
            [] => vec![],
            [first, ..] if firing.iter().all(|layer| layer.rule == first.rule) => {
                vec![format!("a neuron {}", first.rule)]
            }
            _ => firing
                .iter()
                .map(|layer| format!("{}: a neuron {}", layer.name, layer.rule))
                .collect(),
        }
    }

    pub(super) fn state(&self) -> Vec<State<K>> {
        let rest = |layer: &Layer<K>| {
            let zeros = vec![K::default(); layer.neurons.len()];
            State { potentials: zeros.clone(), currents: zeros, fired: Vec::new() }
        };
        self.layers.iter().map(rest).collect()
    }

    /// Takes a step. Returns the number of weights added, and of numbers that left their range.
    pub(super) fn step(&self, state: &mut [State<K>], inputs: &[u16]) -> (usize, u32) {
        let (mut operations, mut saturated) = (0, 0);
        let mut drive = inputs.to_vec();
        for (layer, state) in self.layers.iter().zip(state) {
            operations += layer.operations(drive.len(), state.fired.len());
            saturated += layer.step(state, &drive);
            drive.clone_from(&state.fired);
        }
        (operations, saturated)
    }

    pub(super) fn run(&self, inputs: &Trains) -> Done<K> {
        let mut state = self.state();
        let mut done = Done {
            fired: vec![Vec::new(); self.layers.len()],
            potentials: Vec::new(),
            operations: Vec::new(),
            saturated: 0,
        };
        for inputs in inputs {
            let (operations, saturated) = self.step(&mut state, inputs);
            done.operations.push(operations as u64);
            done.saturated += saturated;
            for (fired, state) in done.fired.iter_mut().zip(&state) {
                fired.push(state.fired.clone());
            }
            done.potentials.extend(state.last().map(|last| last.potentials.clone()));
        }
        done
    }
}
