//! Converts a network from its file to the form of `spikewire-network`: time constants become factors for a step, and
//! gains are multiplied into the weights.

use super::super::nir::{Array, Chain, Neurons, Stage, Weights};
use super::super::trained;
use super::net::{Layer, Net, Neuron, Recurrent, Spike};
use super::rule::{Current, Decay, Framework, Needs, Reset, Rule};
use super::{Asked, Model};
use crate::network::NetworkKind;
use crate::network::fault::{Context, FitKind, LayerKind, Result, ensure};

/// Largest absolute value of a number that `spikewire-network` accepts in `f32`.
const LARGEST: f64 = 1e15;

/// Smallest time constant of a synaptic current, in steps, that is taken for exactly one step. A time constant between
/// this value and 1 occurs if a step of the recording is a little longer than a step of the training.
const A_STEP: f64 = 0.98;

/// Rounding error of gains in files of snnTorch and `SpikingJelly`. A gain that differs from 1 by less than this error
/// is taken for exactly 1.
const ROUNDING: f64 = 1e-5;

impl Model {
    /// Converts a network from JSON.
    ///
    /// # Errors
    /// Returns an error if a number is out of its range, or if the controller does not support the network.
    pub(in super::super) fn of_plain(trained: trained::Trained, asked: &Asked) -> Result<Self> {
        let trained::Trained { layers, readout, .. } = trained;
        let resets = asked.resets.len();
        ensure!(resets < 2, NetworkKind::JsonResets { resets });
        ensure!(
            layers.iter().flat_map(|layer| &layer.neurons).all(|neuron| neuron.leak == 0.0),
            FitKind::LeakByAmount { owner: "the controller's" }
        );
        let rule = asked.or_plain();
        let of_layer = |layer: trained::Layer| {
            let trained::Layer { name, weights, recurrent, bias, neurons, .. } = layer;
            let neurons = neurons.iter().zip(bias);
            let neurons = neurons.map(|(&trained::Neuron { keep, threshold, .. }, bias)| {
                let reset = if rule.reset.subtracts() { threshold } else { 0.0 };
                let spike = Some(Spike { threshold, reset });
                Neuron { current: None, decay: keep, bias, inner: 0.0, spike }
            });
            let own = own(&recurrent);
            Layer { name, weights: turned(&weights), own, neurons: neurons.collect(), rule }
        };
        let mut layers: Vec<_> = layers.into_iter().map(of_layer).collect();
        layers.extend(readout.map(|trained::Readout { name, weights, keep }| {
            let silent =
                |decay| Neuron { current: None, decay, bias: 0.0, inner: 0.0, spike: None };
            let neurons = keep.into_iter().map(silent).collect();
            Layer { name, weights: turned(&weights), own: Recurrent::None, neurons, rule }
        }));
        Self::new(Net { layers }, Vec::new())
    }

    /// Converts a network from a NIR graph. `asked` completes what the graph leaves open about how neurons decay, fire
    /// and reset.
    ///
    /// # Errors
    /// Returns an error if part of the rule remains open, or if the rule does not fit the graph.
    pub(in super::super) fn of_nir(chain: Chain, asked: &Asked) -> Result<Self> {
        let has_currents = chain.has_currents();
        let Chain { stages, readout, sum, mut notes } = chain;
        let rule = asked.rule(Needs {
            fires: !stages.is_empty(),
            current: has_currents,
            time: !stages.is_empty() || readout.is_some(),
        })?;
        let (firing, resets) = (stages.len(), &asked.resets);
        ensure!(
            resets.len() < 2 || resets.len() == firing,
            NetworkKind::Resets { resets: resets.len(), layers: firing }
        );
        let mut layers = Vec::new();
        for stage in stages.into_iter().chain(readout) {
            let name = stage.neurons.name();
            let own = if resets.len() < 2 { None } else { resets.get(layers.len()) };
            let rule = Rule { reset: own.copied().unwrap_or(rule.reset), ..rule };
            layers.push(of_stage(stage, rule, &mut notes).context(name)?);
        }
        layers.extend(sum.map(|Weights { rows, bias }| {
            let one = |at| Neuron {
                current: None,
                decay: 0.0,
                bias: bias.as_ref().map_or(0.0, |bias| bias[at]),
                inner: 0.0,
                spike: None,
            };
            let neurons = (0..rows.len()).map(one).collect();
            Layer {
                name: "sums".into(),
                weights: turned(&rows),
                own: Recurrent::None,
                neurons,
                rule,
            }
        }));
        Self::new(Net { layers }, notes)
    }

    pub(super) fn new(net: Net<f64>, notes: Vec<String>) -> Result<Self> {
        ensure!(!net.layers.is_empty(), NetworkKind::NoNeurons);
        for pair in net.layers.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            let fits = trained::fits(after.inputs(), &before.name, before.neurons.len());
            fits.context(&after.name)?;
        }
        for layer in &net.layers {
            layer.check().with_context(|| layer.name.clone())?;
        }
        Ok(Self { net, notes })
    }
}

impl Layer<f64> {
    fn check(&self) -> Result<()> {
        let own: &[Vec<f64>] = if let Recurrent::Full(own) = &self.own { own } else { &[] };
        let one = if let Recurrent::OneToOne(own) = &self.own { &own[..] } else { &[] };
        let weights = self.weights.iter().chain(own).flatten().chain(one);
        let of_neurons = self.neurons.iter().flat_map(|neuron| {
            let Spike { threshold, reset } =
                neuron.spike.unwrap_or(Spike { threshold: 0.0, reset: 0.0 });
            [neuron.bias, neuron.inner, threshold, reset]
        });
        let mut numbers = weights.copied().chain(of_neurons);
        if let Some(number) = numbers.find(|n| n.is_nan() || n.abs() > LARGEST) {
            return Err(FitKind::Number { number }.into());
        }
        let (inputs, neurons, most) = (self.inputs(), self.neurons.len(), 1 << 16);
        ensure!(inputs.max(neurons) <= most, FitKind::Size { inputs, neurons, most });
        Ok(())
    }
}

/// Transposes a matrix of weights: from one row for each neuron to one row for each input, or back.
pub(super) fn turned(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let inputs = rows.first().map_or(0, Vec::len);
    (0..inputs).map(|input| rows.iter().map(|row| row[input]).collect()).collect()
}

/// Converts a matrix of recurrent weights, which has one row for each receiving neuron. If all weights between
/// different neurons are 0, the result contains only the weight from each neuron to itself.
pub(super) fn own(rows: &[Vec<f64>]) -> Recurrent<f64> {
    if rows.is_empty() {
        return Recurrent::None;
    }
    let is_diagonal = rows
        .iter()
        .enumerate()
        .all(|(at, row)| row.iter().enumerate().all(|(from, &weight)| from == at || weight == 0.0));
    if is_diagonal {
        Recurrent::OneToOne(rows.iter().enumerate().map(|(at, row)| row[at]).collect())
    } else {
        Recurrent::Full(turned(rows))
    }
}

/// Converts a layer of a NIR graph by `rule`, and adds remarks for the user to `notes`.
fn of_stage(stage: Stage, mut rule: Rule, notes: &mut Vec<String>) -> Result<Layer<f64>> {
    let Stage { weights: Weights { mut rows, bias }, recurrent, neurons } = stage;
    let name = neurons.name();
    let mut biases = bias.unwrap_or_else(|| vec![0.0; rows.len()]);
    let (mut back, more) = recurrent.map_or((vec![], None), |own| (own.rows, own.bias));
    biases.iter_mut().zip(more.iter().flatten()).for_each(|(bias, more)| *bias += more);
    let mut scaled = None;
    let mut all = Vec::new();
    for (at, bias) in biases.into_iter().enumerate() {
        let Stepped { mut neuron, mut gain } = stepped(&neurons, at, &rule)?;
        if rule.framework == Some(Framework::SnnTorch)
            && gain != 1.0
            && let Some(spike) = &mut neuron.spike
        {
            // snnTorch's reader divides the threshold by the gain, because its neurons have no gain.
            scaled = Some(gain);
            for number in [&mut spike.threshold, &mut spike.reset, &mut neuron.inner] {
                *number /= gain;
            }
            gain = 1.0;
        }
        let own = back.get_mut(at).into_iter().flatten();
        rows[at].iter_mut().chain(own).for_each(|weight| *weight *= gain);
        if neuron.current.is_some() {
            neuron.bias = bias * gain;
        } else {
            neuron.bias = neuron.inner + bias * gain;
            neuron.inner = 0.0;
        }
        all.push(neuron);
    }
    if let Some(gain) = scaled {
        notes.push(format!(
            "{name}: a gain of {gain:.6}, where snnTorch writes 1: another program wrote the file, or with another step \
             than {} s; as snnTorch reads it, the threshold is divided by the gain",
            rule.dt
        ));
    }
    let start = neurons.start(0, &rule);
    if start != 0.0 {
        notes.push(format!("{name}: potentials are told from {start}, at which its neurons begin"));
    }
    let ignored = neurons.reset.iter().flat_map(|reset| &reset.0).any(|&value| value != 0.0);
    if ignored && rule.reset.subtracts() {
        notes.push(format!("{name}: its v_reset is not used, as a spike subtracts the threshold"));
    }
    let is_leaky = back.is_empty() && neurons.synapse.is_none();
    let is_late = rule.reset == Reset::ToValueLate;
    if is_late && !is_leaky && rule.framework == Some(Framework::SnnTorch) {
        // In snnTorch, all neurons except `Leaky` hold the potential through the next step.
        rule.reset = Reset::ToValueHeld;
    }
    Ok(Layer { name, weights: turned(&rows), own: own(&back), neurons: all, rule })
}

struct Stepped {
    neuron: Neuron<f64>,
    /// Factor for all weights that lead to the neuron. It depends on the neuron's resistance and time constants, and on
    /// the duration of a step.
    gain: f64,
}

/// Converts the parameters of neuron `at`, such as time constants, to the parameters for one step. Sets the bias to 0;
/// the caller adds the bias later.
fn stepped(neurons: &Neurons, at: usize, rule: &Rule) -> Result<Stepped> {
    let dt = rule.dt;
    let resistance = neurons.resistance.at(at);
    let (decay, mut gain, leak) = match &neurons.leak {
        // Norse adds the whole input, however long a step is.
        None if rule.framework == Some(Framework::Norse) => (1.0, resistance, 0.0),
        None => (1.0, resistance * dt, 0.0),
        Some(leak) => {
            let tau = leak.tau.at(at);
            let decay = left(tau, rule)?;
            (decay, resistance * dt / tau, (1.0 - decay) * leak.rest.at(at))
        }
    };
    let means_ones = rule.framework.is_some_and(Framework::means_ones);
    let meant = |gain: f64| if means_ones && (gain - 1.0).abs() < ROUNDING { 1.0 } else { gain };
    gain = meant(gain);
    let mut current = None;
    if let Some(synapse) = &neurons.synapse {
        let (tau, weight) = (synapse.tau.at(at), synapse.weight.at(at));
        let is_a_step = rule.decay == Decay::Euler && (A_STEP * dt..dt).contains(&tau);
        current = Some(if is_a_step { 0.0 } else { left(tau, rule)? });
        let whole = rule.current == Current::Whole || is_a_step;
        gain *= if whole { weight } else { meant(weight * dt / tau) };
    }
    let spike = neurons.threshold.as_ref().map(|threshold| {
        let threshold = threshold.at(at);
        let to = neurons.reset.as_ref().map_or(0.0, |reset| reset.at(at));
        Spike { threshold, reset: if rule.reset.subtracts() { threshold } else { to } }
    });
    let neuron = Neuron { current, decay, bias: 0.0, inner: leak, spike };
    Ok(Stepped { neuron: neuron.begun_at(neurons.start(at, rule), rule), gain })
}

impl Neurons {
    /// Returns the initial potential of neuron `at` in the training framework. (`spikewire-network` starts all neurons
    /// at 0.)
    fn start(&self, at: usize, rule: &Rule) -> f64 {
        let of = |all: Option<&Array>| all.map_or(0.0, |all| all.at(at));
        match rule.framework {
            _ if self.threshold.is_none() => 0.0,
            Some(Framework::SpikingJelly) => of(self.reset.as_ref()),
            Some(Framework::Norse) => of(self.leak.as_ref().map(|leak| &leak.rest)),
            _ => 0.0,
        }
    }
}

impl Neuron<f64> {
    /// Lowers all potentials of the neuron by `start`: the potential at rest, the threshold, and the potential after a
    /// reset. A neuron whose initial potential was `start` then starts at 0.
    fn begun_at(mut self, start: f64, rule: &Rule) -> Self {
        self.inner -= (1.0 - self.decay) * start;
        if let Some(spike) = &mut self.spike {
            spike.threshold -= start;
            if !rule.reset.subtracts() {
                spike.reset -= start;
            }
        }
        self
    }
}

/// Returns the factor by which a step multiplies a quantity that decays with time constant `tau`, in seconds. The
/// formula of [`Decay::Euler`] gives a negative factor if `tau` is shorter than a step. For snnTorch, the factor is
/// then 0.
///
/// # Errors
/// Returns an error if `tau` is not a positive finite number. Also returns an error if the factor would be negative and
/// the framework is not snnTorch.
fn left(tau: f64, rule: &Rule) -> Result<f64> {
    let Rule { dt, framework, decay, .. } = *rule;
    ensure!(tau > 0.0 && tau.is_finite(), LayerKind::TimeConstant { tau });
    if decay == Decay::Exponential {
        return Ok((-dt / tau).exp());
    }
    if tau < dt * (1.0 - 1e-9) && framework != Some(Framework::SnnTorch) {
        let kind = if framework == Some(Framework::Norse) {
            // The product of two decimals has wrong digits at its end; rounding removes them.
            let meant = (dt * dt * 1e12).round() / 1e12;
            NetworkKind::NorsesTime { tau, step: dt, meant }
        } else {
            NetworkKind::ShorterThanStep { tau, step: dt }
        };
        return Err(kind.into());
    }
    Ok((1.0 - dt / tau).clamp(0.0, 1.0))
}
