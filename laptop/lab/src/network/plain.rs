//! Reads trained networks from JSON.

use super::Trained;
use super::controller::{Fires, Reset};
use super::trained::{Layer, Neuron, Readout};
use crate::network::fault::{Context, LayerKind, Result};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Network {
    layers: Vec<Written>,
    readout: Option<WrittenReadout>,
    /// Whether the network was trained in a chip's integers.
    #[serde(default)]
    integers: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenReadout {
    name: Option<String>,
    /// The weights: one row for each output, with one weight for each neuron of the last layer.
    weights: Vec<Vec<f64>>,
    /// Factor by which a step multiplies an output's potential; 1 if not given.
    keep: Option<Numbers>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    name: Option<String>,
    /// The weights: one row for each neuron, with one weight for each input.
    weights: Vec<Vec<f64>>,
    /// The recurrent weights: one row for each neuron, with one weight for each neuron of the same layer. Spikes act
    /// through these weights one step later.
    #[serde(default)]
    recurrent: Vec<Vec<f64>>,
    #[serde(default)]
    bias: Vec<f64>,
    /// Factor by which a step multiplies a neuron's potential; 1 if not given.
    keep: Option<Numbers>,
    /// Amount by which a step moves a potential towards 0, for networks that were trained with tinyODIN's leak; 0 if
    /// not given.
    leak: Option<Numbers>,
    threshold: Numbers,
}

/// A parameter in JSON: one number for all neurons, or a list with one number for each.
#[derive(Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Each(Vec<f64>),
}

impl Numbers {
    fn each(self, count: usize, what: &str) -> Result<Vec<f64>> {
        match self {
            Self::One(number) => Ok(vec![number; count]),
            Self::Each(numbers) if numbers.len() == count => Ok(numbers),
            Self::Each(numbers) => {
                let (values, name) = (numbers.len(), what.to_owned());
                Err(LayerKind::Count { values, name, neurons: count }.into())
            }
        }
    }
}

/// Reads a network from JSON.
///
/// # Errors
/// Returns an error if the JSON does not have the structure of a network, or if a number is invalid.
pub(crate) fn read(bytes: &[u8]) -> Result<Trained> {
    let network: Network = serde_json::from_slice(bytes)?;
    let layers = network.layers.into_iter().enumerate().map(|(at, written)| {
        let name = written.name.clone().unwrap_or_else(|| format!("layer {}", at + 1));
        layer(&name, written).with_context(|| name.clone())
    });
    let readout = network.readout.map(|WrittenReadout { name, weights, keep }| -> Result<_> {
        let name = name.unwrap_or_else(|| "readout".to_owned());
        let keep = keep.unwrap_or(Numbers::One(1.0)).each(weights.len(), "keep");
        let keep = keep.with_context(|| name.clone())?;
        Ok(Readout { name, weights, keep })
    });
    let trained = Trained::with_readout(layers.collect::<Result<_>>()?, readout.transpose()?)?;
    Ok(Trained { integers: network.integers, ..trained })
}

fn layer(name: &str, written: Written) -> Result<Layer> {
    let count = written.weights.len();
    let bias = if written.bias.is_empty() { vec![0.0; count] } else { written.bias };
    let bias = Numbers::Each(bias).each(count, "bias")?;
    let keep = written.keep.unwrap_or(Numbers::One(1.0)).each(count, "keep")?;
    let leaks = written.leak.unwrap_or(Numbers::One(0.0)).each(count, "leak")?;
    let thresholds = written.threshold.each(count, "threshold")?;
    let neurons = keep.into_iter().zip(thresholds).zip(leaks);
    let neurons =
        neurons.map(|((keep, threshold), leak)| Neuron { keep, leak, threshold }).collect();
    let Written { weights, recurrent, .. } = written;
    let name = name.to_owned();
    let (reset, fires) = (Reset::ToValue, Fires::Above);
    Ok(Layer { name, weights, recurrent, bias, neurons, reset, fires })
}
