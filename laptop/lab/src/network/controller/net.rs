//! A network in the form that `spikewire-network` runs, and its simulation in any number type. The form covers the
//! neurons of all training frameworks that can be read.

use super::super::Trains;
use super::number::Number;
use super::rule::{Current, Fires, Reset, Rule};

/// A network whose numbers have the type `K`.
#[derive(Clone, Debug)]
pub(super) struct Net<K: Number> {
    pub layers: Vec<Layer<K>>,
}

/// A layer: its neurons, and the weights that lead to its neurons.
#[derive(Clone, Debug)]
pub(super) struct Layer<K: Number> {
    /// Name of the layer in the network's file.
    pub name: String,
    /// The weights: one row for each input, with one weight for each neuron.
    pub weights: Vec<Vec<K>>,
    pub own: Recurrent<K>,
    pub neurons: Vec<Neuron<K>>,
    pub rule: Rule,
}

/// Recurrent weights of a layer. Through them, a spike of the layer acts on the layer's own neurons one step later.
#[derive(Clone, Debug)]
pub(super) enum Recurrent<K> {
    None,
    /// Weights between all neurons: one row for each sending neuron, with one weight for each receiving neuron.
    Full(Vec<Vec<K>>),
    /// One weight for each neuron, from the neuron to itself. Neurons do not act on one another.
    OneToOne(Vec<K>),
}

/// A neuron. If it has a current, a step computes `I = a I + x + bias`, then `u = b v + I + inner`. If it has no
/// current, a step computes `u = b v + x + bias`.
///
/// `I` is the current, `v` is the potential before the step, and `u` is the potential after it. `a` and `b` are decay
/// factors. `x` is the sum of the weights of the inputs that fire. `bias` and `inner` are constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neuron<K: Number> {
    /// Factor `a`, by which a step multiplies the current; `None` for a neuron without a current.
    pub current: Option<K::Factor>,
    /// Factor `b`, by which a step multiplies the potential.
    pub decay: K::Factor,
    pub bias: K,
    /// Constant that a step adds to the potential directly, not through the current.
    pub inner: K,
    /// Threshold and reset; `None` for a neuron that never fires.
    pub spike: Option<Spike<K>>,
}

/// The threshold of a neuron, and its reset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spike<K> {
    pub threshold: K,
    /// The potential after a spike or, for a reset that subtracts, the amount that a spike subtracts from the
    /// potential.
    pub reset: K,
}

impl<K: Number> Neuron<K> {
    /// Runs one step. `v` and `current` are the neuron's state; `sum` is the bias plus the weights of all spikes that
    /// arrive. Returns whether the neuron fires, and whether its potential or current had to be limited to the range of
    /// the number type.
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
            Reset::NoReset => {
                let u = integrate(v);
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

/// The state of a layer between two steps.
#[derive(Clone)]
pub struct State<K> {
    /// Potential of each neuron.
    pub potentials: Vec<K>,
    /// Current of each neuron; 0 of neurons without one.
    pub currents: Vec<K>,
    /// Neurons that fired in the last step, in ascending order.
    pub fired: Vec<u16>,
}

impl<K> State<K> {
    /// Returns whether this can be a state of the same layer as `other`.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        let neurons = other.potentials.len();
        self.potentials.len() == neurons
            && self.currents.len() == neurons
            && self.fired.iter().all(|own| usize::from(*own) < neurons)
    }
}

impl<K: Number> Layer<K> {
    pub(super) fn inputs(&self) -> usize {
        self.weights.len()
    }

    /// Returns the number of weight additions in a step of the layer. `inputs` is the number of input spikes, and `own`
    /// is the number of spikes that the layer fired in the step before.
    pub(super) fn operations(&self, inputs: usize, own: usize) -> usize {
        let back = match self.own {
            Recurrent::None => 0,
            Recurrent::Full(_) => own * self.neurons.len(),
            Recurrent::OneToOne(_) => own,
        };
        inputs * self.neurons.len() + back
    }

    fn step(&self, state: &mut State<K>, inputs: &[u16]) -> u32 {
        let before = std::mem::take(&mut state.fired);
        let mut saturated = 0;
        for (at, neuron) in self.neurons.iter().enumerate() {
            // `spikewire-network` starts each sum with the bias; floating point rounds differently in another order.
            let mut sum = neuron.bias;
            for &input in inputs {
                sum = sum.plus(self.weights[usize::from(input)][at]);
            }
            match &self.own {
                Recurrent::None => {}
                Recurrent::Full(own) => {
                    for &fired in &before {
                        sum = sum.plus(own[usize::from(fired)][at]);
                    }
                }
                Recurrent::OneToOne(own) => {
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

/// The result of a run over all steps.
#[derive(Default)]
pub(super) struct Done<K> {
    /// The neurons that fired, by layer, then by step.
    pub fired: Vec<Trains>,
    /// The potentials of the last layer, by step.
    pub potentials: Vec<Vec<K>>,
    /// Number of weight additions, by step.
    pub operations: Vec<u64>,
    /// Number of times that a neuron's potential or current left its range and was limited.
    pub saturated: u32,
}

impl<K: Number> Net<K> {
    /// Describes for the user how neurons fire and reset: in one line if all layers follow the same rule, else in one
    /// line for each layer that fires.
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

    /// Runs one step of all layers. Returns two counts: the weight additions, and the neurons whose potential or
    /// current had to be limited to the range of the number type.
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
