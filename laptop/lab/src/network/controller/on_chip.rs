//! Converts a network from the form that `spikewire-network` runs to the form for chips, whose neurons rest at 0 and
//! have no synaptic current.

use super::super::trained::{self, Readout, Trained};
use super::Model;
use super::file::diagonal;
use super::form::turned;
use super::net::{Layer, Neuron, Recurrent, Spike};
use crate::network::fault::{Context, FitKind, Result, ensure};

/// Maximum share of a synaptic current that may remain after one step. The chips' neurons have no synaptic current, so
/// a spike must not act on later steps through its current.
const CURRENT: f64 = 1e-3;

impl Model {
    /// Converts the network to the form that can be brought onto chips.
    ///
    /// # Errors
    /// Returns an error if a synaptic current lasts longer than a step. Also returns an error if neurons that never
    /// fire are anywhere but in a last layer of their own.
    pub(in super::super) fn on_chip(self) -> Result<Trained> {
        let mut layers = self.net.layers;
        let is_silent =
            |layer: &Layer<f64>| layer.neurons.iter().all(|neuron| neuron.spike.is_none());
        let readout = layers.pop_if(|layer| is_silent(layer)).map(|layer| {
            let name = layer.name.clone();
            readout(layer).context(name)
        });
        let layers = layers.into_iter().map(|layer| {
            let name = layer.name.clone();
            of_layer(layer).context(name)
        });
        let mut layers = layers.collect::<Result<Vec<_>>>()?;
        let readout = readout.transpose()?.map(|(mut readout, bias)| {
            if let Some(last) = layers.last_mut().filter(|_| bias.iter().any(|bias| *bias != 0.0)) {
                add_clock(last);
                let rows = readout.weights.iter_mut().zip(bias);
                rows.for_each(|(row, bias)| row.push(bias));
            }
            readout
        });
        Trained::with_readout(layers, readout)
    }
}

/// Adds a neuron that fires in every step, through which outputs that never fire get their bias.
fn add_clock(layer: &mut trained::Layer) {
    /// Amount that each step adds to the potential of the new neuron, in units of its threshold.
    const BIAS: f64 = 1.1;
    let keep = layer.neurons.first().map_or(1.0, |neuron| neuron.keep);
    layer.weights.push(vec![0.0; layer.inputs()]);
    if !layer.recurrent.is_empty() {
        layer.recurrent.iter_mut().for_each(|row| row.push(0.0));
        layer.recurrent.push(vec![0.0; layer.neurons.len() + 1]);
    }
    layer.bias.push(BIAS);
    layer.neurons.push(trained::Neuron { keep, threshold: 1.0, leak: 0.0 });
}

fn check_current(neuron: &Neuron<f64>) -> Result<()> {
    let left = neuron.current.unwrap_or(0.0);
    ensure!(left <= CURRENT, FitKind::LastingCurrent { left });
    Ok(())
}

fn of_layer(layer: Layer<f64>) -> Result<trained::Layer> {
    let Layer { name, weights, own, neurons, rule } = layer;
    let recurrent = match own {
        Recurrent::None => vec![],
        Recurrent::Full(own) => turned(&own),
        Recurrent::OneToOne(own) => diagonal(&own),
    };
    let mut layer = trained::Layer {
        name,
        weights: turned(&weights),
        recurrent,
        bias: Vec::new(),
        neurons: Vec::new(),
        reset: rule.reset,
        fires: rule.fires,
    };
    for neuron in neurons {
        check_current(&neuron)?;
        let Neuron { decay: keep, bias, inner, spike, .. } = neuron;
        let Spike { threshold, reset } = spike.ok_or(FitKind::SilentInside)?;
        // On the chips a spike resets neurons to 0, so potentials are counted from the reset value. If a spike subtracts
        // an amount other than the threshold, they are counted from `threshold - reset`, so that the two are equal. A
        // neuron then starts at this potential instead of at rest; the difference leaks away.
        let zero = if rule.reset.subtracts() { threshold - reset } else { reset };
        let bias = bias + inner - (1.0 - keep) * zero;
        // If the neuron rests at its reset value, only a rounding error remains of the bias.
        layer.bias.push(if bias.abs() < 1e-9 * threshold.abs() { 0.0 } else { bias });
        layer.neurons.push(trained::Neuron { keep, threshold: threshold - zero, leak: 0.0 });
    }
    Ok(layer)
}

/// Converts a layer of neurons that never fire to the outputs of a network. Returns the outputs, and the bias of each
/// output.
fn readout(layer: Layer<f64>) -> Result<(Readout, Vec<f64>)> {
    let Layer { name, weights, neurons, .. } = layer;
    neurons.iter().try_for_each(check_current)?;
    let keep = neurons.iter().map(|neuron| neuron.decay).collect();
    let bias = neurons.iter().map(|neuron| neuron.bias + neuron.inner).collect();
    Ok((Readout { name, weights: turned(&weights), keep }, bias))
}
