//! Converts a network from the form that `spikewire-network` runs to the form for chips, whose neurons rest at 0 and
//! have no synaptic current.

use super::super::trained::{self, Readout, Trained};
use super::Model;
use super::net::{Layer, Neuron, Recurrent, Spike};
use crate::network::fault::{Context, FitKind, Result, ensure};

/// Maximum share of a synaptic current that may remain after one step. The chips' neurons have no synaptic current, so
/// a spike must not act on later steps through its current.
const CURRENT: f64 = 1e-3;

impl Model {
    /// Converts the network to the form that can be brought onto chips.
    ///
    /// # Errors
    /// Returns an error in one of these cases:
    /// - A synaptic current lasts longer than one step.
    /// - The last layer never fires, and one of its neurons has a bias.
    /// - A neuron outside such a last layer never fires.
    ///
    /// Also returns the errors of [`Trained::with_readout`].
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
        Trained::with_readout(layers.collect::<Result<_>>()?, readout.transpose()?)
    }
}

/// Transposes a matrix of weights: from one row for each input to one row for each neuron.
fn turned(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let neurons = rows.first().map_or(0, Vec::len);
    (0..neurons).map(|neuron| rows.iter().map(|row| row[neuron]).collect()).collect()
}

fn check_current(neuron: &Neuron<f64>) -> Result<()> {
    let left = neuron.current.unwrap_or(0.0);
    ensure!(left <= CURRENT, FitKind::LastingCurrent { left });
    Ok(())
}

fn of_layer(layer: Layer<f64>) -> Result<trained::Layer> {
    let Layer { name, weights, own, neurons, rule } = layer;
    let count = neurons.len();
    let recurrent = match own {
        Recurrent::None => vec![],
        Recurrent::Full(own) => turned(&own),
        Recurrent::OneToOne(own) => {
            let row = |at: usize| (0..count).map(move |from| f64::from(u8::from(from == at)));
            let rows = own.iter().enumerate();
            rows.map(|(at, weight)| row(at).map(|one| one * weight).collect()).collect()
        }
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
        // On the chips a spike resets neurons to 0, so potentials are counted from the reset value.
        let zero = if rule.reset.subtracts() { 0.0 } else { reset };
        let bias = bias + inner - (1.0 - keep) * zero;
        // If the neuron rests at its reset value, only a rounding error remains of the bias.
        layer.bias.push(if bias.abs() < 1e-9 * threshold.abs() { 0.0 } else { bias });
        layer.neurons.push(trained::Neuron { keep, threshold: threshold - zero, leak: 0.0 });
    }
    Ok(layer)
}

fn readout(layer: Layer<f64>) -> Result<Readout> {
    let Layer { name, weights, neurons, .. } = layer;
    let mut keep = Vec::new();
    for (at, neuron) in neurons.iter().enumerate() {
        check_current(neuron)?;
        let bias = neuron.bias + neuron.inner;
        ensure!(bias == 0.0, FitKind::OutputBias { output: at, bias });
        keep.push(neuron.decay);
    }
    Ok(Readout { name, weights: turned(&weights), keep })
}
