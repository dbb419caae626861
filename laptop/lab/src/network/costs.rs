//! Measures the effect of each part of a chip's arithmetic by itself: the network runs in double precision except for
//! that part.

use super::controller::Fires;
use super::trained::{Layer, Neuron};
use super::{Distance, Trained, Trains};
use std::fmt::{self, Display};

/// A part of a chip's arithmetic that differs from double precision and changes a network's spikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// Comparison of potentials with thresholds after each spike that arrives, instead of once in each step.
    Order,
    /// Leaks that subtract a fixed amount, instead of a share of the potential.
    Leak,
    /// The chip's reset, which either sets the potential to 0 or subtracts the threshold.
    Reset,
    /// Rounding of each neuron's weights to whole numbers.
    Weights {
        /// Largest absolute value of a weight after rounding.
        largest: f64,
    },
}

impl Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order => write!(f, "comparing after each spike"),
            Self::Leak => write!(f, "leaks by fixed amounts"),
            Self::Reset => write!(f, "the chip's reset"),
            Self::Weights { largest } => write!(f, "weights of -{largest} to {largest}"),
        }
    }
}

/// Fixed leaks to try, as multiples of the amount that the trained neuron loses in a step if its potential is half its
/// threshold.
const LEAKS: [f64; 12] = [0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0, 1.25, 1.5, 2.0, 3.0];

impl Cost {
    /// Runs the network on `inputs`, and returns the spikes of the last layer. The arithmetic is double precision,
    /// except for the part of the chip's arithmetic that this cost stands for. If this part has parameters, such as
    /// fixed leaks, they are chosen first, on a recording with the inputs `tuned`. The choice makes each layer's spikes
    /// in this recording as near as possible to those in `fired`.
    pub(super) fn alone(
        self,
        trained: &Trained,
        (tuned, fired): (&Trains, &[Trains]),
        inputs: &Trains,
    ) -> Trains {
        let (mut before, mut drive) = (inputs.clone(), tuned);
        for (layer, own) in trained.layers.iter().zip(fired) {
            let exact = match self {
                Self::Weights { largest } => Some(rounded(layer, largest)),
                Self::Reset => Some(layer.clone().reset_by_chip()),
                Self::Order | Self::Leak => None,
            };
            if let Some(layer) = exact {
                before = layer.follow(&before, |_, _| ());
                drive = own;
                continue;
            }
            let count = layer.neurons.len();
            let leaks = (0..count).map(|at| match self {
                Self::Leak => Some(leak(layer, at, drive, own)),
                _ => None,
            });
            let leaks: Vec<Option<f64>> = leaks.collect();
            before = run(layer, &leaks, self == Self::Order, &before);
            drive = own;
        }
        before
    }
}

fn rounded(layer: &Layer, largest: f64) -> Layer {
    let mut layer = layer.clone();
    for at in 0..layer.neurons.len() {
        let own = layer.recurrent.get_mut(at).into_iter().flatten();
        let all = layer.weights[at].iter_mut().chain(own).chain(&mut layer.bias[at..=at]);
        let mut all: Vec<&mut f64> = all.collect();
        let most = all.iter().fold(0.0_f64, |most, weight| most.max(weight.abs()));
        let unit = if most > 0.0 { most / largest } else { 1.0 };
        for weight in &mut all {
            **weight = (**weight / unit).round() * unit;
        }
    }
    layer
}

/// Chooses a fixed leak for neuron `at`: an amount by which each step moves the potential towards 0. Tries several
/// leaks, and returns the one that makes the neuron's spikes nearest to those in `fired`. `drive` contains the input
/// spikes of the layer.
fn leak(layer: &Layer, at: usize, drive: &Trains, fired: &Trains) -> f64 {
    let Neuron { keep, threshold, .. } = layer.neurons[at];
    let distance = |amount: f64| {
        let mut distance = Distance::default();
        let (mut potential, mut before): (f64, &[u16]) = (0.0, &[]);
        for (inputs, fired) in drive.iter().zip(fired) {
            let does = step(layer, at, Some(amount), false, inputs, before, &mut potential);
            let meant = fired.iter().filter(|own| usize::from(**own) == at).count();
            distance.step(does.into(), meant);
            before = fired;
        }
        distance.value()
    };
    let amounts = LEAKS.map(|part| part * (1.0 - keep) * threshold / 2.0);
    let rated = amounts.map(|amount| (distance(amount), amount));
    let best = rated.into_iter().min_by(|(one, _), (other, _)| one.total_cmp(other));
    best.map_or(0.0, |(_, amount)| amount)
}

fn run(layer: &Layer, leaks: &[Option<f64>], by_spike: bool, inputs: &Trains) -> Trains {
    let mut potentials = vec![0.0; layer.neurons.len()];
    let mut before: Vec<u16> = Vec::new();
    let of_step = |inputs: &Vec<u16>| {
        let mut out = Vec::new();
        for (at, potential) in potentials.iter_mut().enumerate() {
            if step(layer, at, leaks[at], by_spike, inputs, &before, potential) {
                out.push(at as u16);
            }
        }
        before.clone_from(&out);
        out
    };
    inputs.iter().map(of_step).collect()
}

/// Runs one step of the layer's neuron `at`, and returns whether the neuron fires. `inputs` lists the layer's inputs
/// that fire in the step, and `before` lists the layer's neurons that fired in the step before. A spike resets the
/// neuron in the same step. If `leak` is given, a fixed leak of this amount replaces the trained leak. If `by_spike` is
/// true, the neuron compares its potential with its threshold after each spike that arrives. Otherwise, it compares
/// once, after all spikes of the step.
fn step(
    layer: &Layer,
    at: usize,
    leak: Option<f64>,
    by_spike: bool,
    inputs: &[u16],
    before: &[u16],
    potential: &mut f64,
) -> bool {
    let threshold = layer.neurons[at].threshold;
    *potential = match leak {
        Some(amount) => potential.signum() * (potential.abs() - amount).max(0.0),
        None => layer.neurons[at].left(*potential),
    };
    let mut fired = false;
    let mut compare = |potential: &mut f64| {
        let is_over = match layer.fires {
            Fires::Above => *potential > threshold,
            Fires::At => *potential >= threshold,
        };
        if is_over {
            *potential = if layer.reset.subtracts() { *potential - threshold } else { 0.0 };
            fired = true;
        }
    };
    let back = layer.recurrent.get(at);
    let own = before.iter().filter_map(|&from| back.map(|back| back[usize::from(from)]));
    let driven = inputs.iter().map(|&input| layer.weights[at][usize::from(input)]);
    for weight in std::iter::once(layer.bias[at]).chain(own).chain(driven) {
        *potential += weight;
        if by_spike {
            compare(potential);
        }
    }
    compare(potential);
    fired
}
