//! Finds the rule by which a framework trained a network, from outputs that the framework recorded. A NIR file does not
//! contain the rule, and a wrong one gives other spikes without an error.

use super::super::nir::Chain;
use super::net::{Layer, Net, Recurrent};
use super::rule::{Asked, Current, Decay, Fires, Framework, Reset};
use super::{Flown, Model, Trains};
use crate::Error;
use crate::network::NetworkKind;
use crate::network::bring::Outputs;
use crate::network::fault::Result;
use catalogue::run::Spell;

/// Frameworks whose rules are tried if the user names none.
const FRAMEWORKS: [Framework; 6] = [
    Framework::SnnTorch,
    Framework::Norse,
    Framework::SpikingJelly,
    Framework::Rockpool,
    Framework::Sinabs,
    Framework::Nir,
];

const RESETS: [Reset; 7] = [
    Reset::SubtractLate,
    Reset::ToValue,
    Reset::SubtractNoDelay,
    Reset::ToValueLate,
    Reset::Subtract,
    Reset::ToValueHeld,
    Reset::NoReset,
];

/// Durations of a step that are tried if neither the user nor the framework gives one: what snnTorch and `SpikingJelly`
/// write into a file, and Norse's default.
const STEPS: [f64; 2] = [1e-4, 1e-3];

/// Most layers for which resets that differ from layer to layer are tried: with 7 resets, 343 combinations.
const MIXED: usize = 3;

/// Largest difference between potentials of outputs that counts as equal, relative to the largest potential recorded.
/// Frameworks add in another order, which changes the last digits: 5e-6 in the files of the tests.
const EQUAL: f64 = 1e-4;

/// Largest relative difference between two numbers of a network that are the same but for rounding.
const NEAR: f64 = 1e-4;

/// The rule that gives the recorded outputs, complete.
#[derive(Debug)]
pub struct Found {
    /// The rule's parts, with none left open.
    pub asked: Asked,
    /// Whether potentials that equal a threshold occur in the recording. If not, the recording cannot show whether
    /// neurons fire at their threshold, and [`Fires::Above`] was taken.
    pub shows_fires: bool,
}

impl Found {
    /// Returns the settings that give this rule, as the user writes them. The function `spell` converts the name of a
    /// setting to the spelling that the user knows.
    pub fn settings(&self, spell: Spell) -> String {
        let settings = self.asked.settings(spell);
        if self.shows_fires {
            return settings;
        }
        let fires = spell("fires");
        format!("{settings} (no potential equals a threshold: `{fires} at` would do so too)")
    }
}

/// Returns the rule that gives the recorded `outputs` in every step, among all rules that agree with the parts in
/// `asked`.
///
/// # Errors
/// Returns an error if no rule gives these outputs, or if several do. The error names the rules.
pub(in super::super) fn find(
    chain: &Chain,
    asked: &Asked,
    inputs: &Trains,
    outputs: &Outputs,
) -> Result<Found> {
    let mut search = Search::new(chain, inputs, outputs);
    search.same_reset_in_all_layers(asked);
    if search.fitting.is_empty() {
        search.mixed_resets(asked);
    }
    let Search { mut fitting, nearest, refused, .. } = search;
    if fitting.len() > 1 {
        let rules = fitting.into_iter().map(|(found, _)| found.asked).collect();
        return Err(NetworkKind::SeveralRules { rules, steps: inputs.len() }.into());
    }
    if let Some((found, _)) = fitting.pop() {
        return Ok(found);
    }
    // A part that the user gave may be wrong: any but the step, any but the framework, or several.
    let only_step = Asked { dt: asked.dt, ..Asked::default() };
    let only_framework = Asked { framework: asked.framework, ..Asked::default() };
    for free in [only_step, only_framework, Asked::default()] {
        if *asked != free
            && let Ok(Found { asked: fits, .. }) = find(chain, &free, inputs, outputs)
        {
            return Err(NetworkKind::OtherRule { fits: Box::new(fits) }.into());
        }
    }
    match (nearest, refused) {
        (Some(Tried { asked, steps }), _) => {
            let nearest = Box::new(asked);
            Err(NetworkKind::NoRule { nearest, step: steps + 1, steps: inputs.len() }.into())
        }
        (None, Some(error)) => Err(error),
        (None, None) => Err(NetworkKind::NoNeurons.into()),
    }
}

/// A rule, and the number of steps from the first in which it gives the recorded outputs.
struct Tried {
    asked: Asked,
    steps: usize,
}

/// The search over all rules.
struct Search<'a> {
    chain: &'a Chain,
    inputs: &'a Trains,
    outputs: &'a Outputs,
    /// Largest difference between two potentials that count as equal.
    equal: f64,
    /// The rules that give all recorded outputs, each with the network that it leads to. Two rules that lead to the same
    /// network, but for the last digits of its numbers, are one: the first.
    fitting: Vec<(Found, Net<f64>)>,
    /// The rule that gives the recorded outputs for most steps.
    nearest: Option<Tried>,
    /// Why the first rule cannot be applied to this file.
    refused: Option<Error>,
}

impl<'a> Search<'a> {
    fn new(chain: &'a Chain, inputs: &'a Trains, outputs: &'a Outputs) -> Self {
        let mut largest = 0.0_f64;
        if let Outputs::Potentials(steps) = outputs {
            for potential in steps.iter().flatten() {
                largest = largest.max(potential.abs());
            }
        }
        let equal = EQUAL * largest;
        Self { chain, inputs, outputs, equal, fitting: Vec::new(), nearest: None, refused: None }
    }

    /// Tries every rule that resets all layers alike, or as the user asked.
    fn same_reset_in_all_layers(&mut self, asked: &Asked) {
        for asked in without_resets(asked, self.chain.has_currents()) {
            if asked.resets.is_empty() {
                for reset in RESETS {
                    self.try_rule(&Asked { resets: vec![reset], ..asked.clone() });
                }
            } else {
                self.try_rule(&asked);
            }
        }
    }

    /// Tries every rule whose layers reset differently, if the user left the resets open and there are few layers.
    fn mixed_resets(&mut self, asked: &Asked) {
        let layers = self.chain.stages.len();
        if !(2..=MIXED).contains(&layers) {
            return;
        }
        for asked in without_resets(asked, self.chain.has_currents()) {
            if !asked.resets.is_empty() {
                continue;
            }
            // `number` counts through all combinations: its digits, to the base of 7, are the resets of the layers.
            for mut number in 0..RESETS.len().pow(layers as u32) {
                let mut resets = Vec::new();
                for _ in 0..layers {
                    resets.push(RESETS[number % RESETS.len()]);
                    number /= RESETS.len();
                }
                self.try_rule(&Asked { resets, ..asked.clone() });
            }
        }
    }

    /// Tries a rule that is complete except for the comparison with the threshold: both comparisons, if the user left
    /// the choice open.
    fn try_rule(&mut self, asked: &Asked) {
        let above = Asked { fires: Some(Fires::Above), ..asked.clone() };
        let at = Asked { fires: Some(Fires::At), ..asked.clone() };
        let found = match asked.fires {
            Some(_) => {
                if !self.gives_outputs(asked) {
                    return;
                }
                Found { asked: asked.clone(), shows_fires: true }
            }
            None => match (self.gives_outputs(&above), self.gives_outputs(&at)) {
                (true, fits_at) => Found { asked: above.clone(), shows_fires: !fits_at },
                (false, true) => Found { asked: at, shows_fires: true },
                (false, false) => return,
            },
        };
        if let Ok(model) = Model::of_nir(self.chain.clone(), &found.asked)
            && !self.fitting.iter().any(|(_, other)| are_alike(&model.net, other))
        {
            self.fitting.push((found, model.net));
        }
    }

    /// Runs the network by a complete rule, in the controller's `f32`. Returns whether all outputs are those recorded.
    fn gives_outputs(&mut self, asked: &Asked) -> bool {
        let mut flown = match Model::of_nir(self.chain.clone(), asked) {
            Ok(model) => model.as_flown(),
            Err(error) => {
                self.refused.get_or_insert(error);
                return false;
            }
        };
        let steps = self.inputs.len();
        let mut equal = 0;
        while equal < steps {
            flown.step(&self.inputs[equal]);
            if !self.is_recorded(equal, &flown) {
                break;
            }
            equal += 1;
        }
        if self.nearest.as_ref().is_none_or(|nearest| nearest.steps < equal) {
            self.nearest = Some(Tried { asked: asked.clone(), steps: equal });
        }
        equal == steps
    }

    fn is_recorded(&self, step: usize, flown: &Flown) -> bool {
        match self.outputs {
            Outputs::Spikes(spikes) => {
                let mut recorded = spikes[step].clone();
                recorded.sort_unstable();
                flown.fired().last().is_some_and(|fired| fired == recorded)
            }
            Outputs::Potentials(potentials) => {
                let pairs = potentials[step].iter().zip(flown.potentials());
                pairs.fold(0.0, |most: f64, (one, other)| most.max((one - f64::from(*other)).abs()))
                    <= self.equal
            }
        }
    }
}

/// Returns whether two networks of the same graph differ in the last digits of their numbers at most: those by which a
/// gain of 1 is 0.999999 in one framework's file, and 1 in another's reading of it.
fn are_alike(one: &Net<f64>, other: &Net<f64>) -> bool {
    for (one, other) in one.layers.iter().zip(&other.layers) {
        let fires = one.neurons.iter().any(|neuron| neuron.spike.is_some());
        let has_current = one.neurons.iter().any(|neuron| neuron.current.is_some());
        // Norse's whole weights are the weights of the form already: what is left of `Whole` is `New`.
        let takes_old = |layer: &Layer<f64>| layer.rule.current == Current::Old;
        if fires && spiking(one.rule.reset) != spiking(other.rule.reset)
            || has_current && takes_old(one) != takes_old(other)
            || numbers(one).iter().zip(numbers(other)).any(|(a, b)| !is_near(*a, b))
        {
            return false;
        }
    }
    true
}

/// Returns the reset that gives the same spikes and is named first. A potential that a spike sets to a value at once, or at
/// the beginning of the next step, is the same when the next inputs arrive.
fn spiking(reset: Reset) -> Reset {
    if reset == Reset::ToValueLate { Reset::ToValue } else { reset }
}

/// Returns whether two numbers differ in their last digits at most.
fn is_near(one: f64, other: f64) -> bool {
    (one - other).abs() <= NEAR * one.abs().max(other.abs())
}

/// Returns all numbers of a layer.
fn numbers(layer: &Layer<f64>) -> Vec<f64> {
    let mut numbers: Vec<f64> = layer.weights.iter().flatten().copied().collect();
    match &layer.own {
        Recurrent::None => {}
        Recurrent::Full(own) => numbers.extend(own.iter().flatten()),
        Recurrent::OneToOne(own) => numbers.extend(own),
    }
    for neuron in &layer.neurons {
        numbers.extend([neuron.decay, neuron.bias, neuron.inner]);
        numbers.extend(neuron.current);
        numbers.extend(neuron.spike.into_iter().flat_map(|spike| [spike.threshold, spike.reset]));
    }
    numbers
}

/// Returns all rules that agree with `asked`, complete except for the resets and the comparison with the threshold,
/// which are only set if the user or the framework gives them.
fn without_resets(asked: &Asked, has_currents: bool) -> Vec<Asked> {
    let frameworks = match asked.framework {
        Some(framework) => vec![framework],
        None => FRAMEWORKS.to_vec(),
    };
    let mut all = Vec::new();
    for framework in frameworks {
        let says = framework.says();
        let decays = match asked.decay.or(says.decay) {
            Some(decay) => vec![decay],
            None => vec![Decay::Euler, Decay::Exponential],
        };
        let currents = match asked.current.or(says.current) {
            Some(current) => vec![current],
            None if has_currents => vec![Current::New, Current::Old, Current::Whole],
            None => vec![Current::New],
        };
        let steps = match asked.dt.or(says.dt) {
            Some(dt) => vec![dt],
            None => STEPS.to_vec(),
        };
        for decay in &decays {
            for current in &currents {
                for dt in &steps {
                    all.push(Asked {
                        framework: Some(framework),
                        resets: asked.resets.clone(),
                        fires: asked.fires.or(says.fires),
                        decay: Some(*decay),
                        current: Some(*current),
                        dt: Some(*dt),
                    });
                }
            }
        }
    }
    all
}
