//! NIR, the Neuromorphic Intermediate Representation: a graph in an HDF5 file, as the Python package `nir` writes it.
//!
//! Source: J. E. Pedersen et al., *Neuromorphic intermediate representation*, Nature Communications 15 (2024), table 1.

use super::Trained;
use super::trained::{Layer, Neuron};
use anyhow::{Context, Result, anyhow, bail, ensure};
use hdf5_reader::group::Group;
use hdf5_reader::messages::datatype::Datatype;
use hdf5_reader::{Dataset, H5Type, Hdf5File, OpenOptions};
use std::collections::BTreeMap;

/// More than 256 neurons and rows can need, in a file that says it holds more.
const MOST_BYTES: usize = 1 << 26;

/// The layers from input to output, with time in seconds.
pub(crate) struct Chain(Vec<Stage>);

struct Stage {
    weights: Weights,
    neurons: Neurons,
}

struct Weights {
    rows: Vec<Vec<f64>>,
    bias: Option<Vec<f64>>,
}

struct Neurons {
    /// The node's.
    name: String,
    /// Perfect integrators have none.
    leak: Option<Leak>,
    resistance: Array,
    threshold: Array,
    reset: Option<Array>,
}

struct Leak {
    tau: Array,
    rest: Array,
}

/// Numbers, one for each neuron or one for all.
struct Array(Vec<f64>);

impl Array {
    fn at(&self, neuron: usize) -> f64 {
        if let [one] = self.0[..] { one } else { self.0[neuron] }
    }
}

/// Reads the graph, which must be a chain of Linear or Affine and LIF or IF.
///
/// # Errors
/// The file is damaged, or the graph is another.
pub(crate) fn read(bytes: Vec<u8>) -> Result<Chain> {
    let options = OpenOptions::default().with_max_read_bytes(MOST_BYTES);
    let file = Hdf5File::from_vec_with_options(bytes, options).context("damaged")?;
    let no_graph = "an HDF5 file without a NIR graph";
    let graph = file.group("/node/nodes").context(no_graph)?;
    let nodes: BTreeMap<String, Group> =
        graph.groups()?.into_iter().map(|node| (node.name().to_owned(), node)).collect();
    let edges = file.dataset("/node/edges").context(no_graph)?.read_strings()?;
    let edges: Vec<(&str, &str)> =
        edges.as_chunks().0.iter().map(|[from, to]| (from.as_str(), to.as_str())).collect();

    let mut stages = Vec::new();
    let mut weights: Option<Weights> = None;
    for name in chain(&nodes, &edges)? {
        let node = &nodes[name];
        let kind = kind(node)?;
        let mut read = || -> Result<()> {
            match (kind.as_str(), weights.take()) {
                ("Linear" | "Affine", None) => weights = Some(read_weights(node, &kind)?),
                ("Linear" | "Affine", Some(_)) => {
                    bail!("weights follow on weights; there must be LIF or IF neurons between them")
                }
                ("LIF" | "IF", Some(weights)) => {
                    let neurons = read_neurons(node, name, &kind, weights.rows.len())?;
                    stages.push(Stage { weights, neurons });
                }
                ("LIF" | "IF", None) => bail!("no weights lead to it"),
                // Spikes are in a row already.
                ("Flatten" | "Input" | "Output", before) => weights = before,
                _ => bail!("tinyODIN has nothing like it; Linear, Affine, LIF and IF are taken"),
            }
            Ok(())
        };
        read().with_context(|| format!("node `{name}` ({kind})"))?;
    }
    ensure!(weights.is_none(), "the last weights lead to no LIF or IF neurons");
    Ok(Chain(stages))
}

fn kind(node: &Group) -> Result<String> {
    let kind = node.dataset("type").and_then(|kind| kind.read_string());
    kind.with_context(|| format!("node `{}`: no type", node.name()))
}

/// The nodes' names from the input to the output.
fn chain<'a>(nodes: &'a BTreeMap<String, Group>, edges: &[(&str, &str)]) -> Result<Vec<&'a str>> {
    let of_kind = |wanted: &str| -> Result<&'a str> {
        let mut found = Vec::new();
        for (name, node) in nodes {
            if kind(node)? == wanted {
                found.push(name.as_str());
            }
        }
        match found[..] {
            [one] => Ok(one),
            _ => bail!("{} nodes are {wanted}, where there must be one: {found:?}", found.len()),
        }
    };
    let (first, last) = (of_kind("Input")?, of_kind("Output")?);
    let mut path = vec![first];
    let mut at = first;
    while at != last {
        let next: Vec<&str> =
            edges.iter().filter(|(from, _)| *from == at).map(|(_, to)| *to).collect();
        if let Some(back) = next.iter().find(|next| path.contains(next)) {
            bail!("node `{at}` leads back to `{back}`: recurrent networks are not taken");
        }
        let [one] = next[..] else {
            bail!("node `{at}` leads to {} nodes, {next:?}: only a chain is taken", next.len());
        };
        let (name, _) = nodes
            .get_key_value(one)
            .with_context(|| format!("node `{at}` leads to `{one}`, which there is not"))?;
        at = name;
        path.push(at);
    }
    if let Some(name) = nodes.keys().find(|name| !path.contains(&name.as_str())) {
        bail!("node `{name}` is not on the way from `{first}` to `{last}`");
    }
    Ok(path)
}

fn read_weights(node: &Group, kind: &str) -> Result<Weights> {
    let (shape, weights) = numbers(node, "weight")?;
    let [outputs, inputs] = shape[..] else {
        bail!("weights of {} dimensions, where there must be 2", shape.len());
    };
    ensure!(outputs > 0 && inputs > 0, "weights of shape {outputs} x {inputs}");
    let bias = match kind {
        "Affine" => {
            let (_, bias) = numbers(node, "bias")?;
            ensure!(bias.len() == outputs, "{} values of `bias` for {outputs} neurons", bias.len());
            Some(bias)
        }
        _ => None,
    };
    Ok(Weights { rows: weights.chunks(inputs).map(<[f64]>::to_vec).collect(), bias })
}

fn read_neurons(node: &Group, name: &str, kind: &str, count: usize) -> Result<Neurons> {
    let array = |what: &str| -> Result<Array> {
        let (_, numbers) = numbers(node, what)?;
        let told = numbers.len();
        ensure!(told == 1 || told == count, "{told} values of `{what}` for {count} neurons");
        if let Some(odd) = numbers.iter().find(|number| !number.is_finite()) {
            bail!("`{what}` holds {odd}");
        }
        Ok(Array(numbers))
    };
    let leak = match kind {
        "LIF" => Some(Leak { tau: array("tau")?, rest: array("v_leak")? }),
        _ => None,
    };
    let has_reset = node.datasets()?.iter().any(|dataset| dataset.name() == "v_reset");
    Ok(Neurons {
        name: name.to_owned(),
        leak,
        resistance: array("r")?,
        threshold: array("v_threshold")?,
        reset: if has_reset { Some(array("v_reset")?) } else { None },
    })
}

/// An array's shape and numbers, whatever their type.
fn numbers(node: &Group, name: &str) -> Result<(Vec<usize>, Vec<f64>)> {
    let dataset = node.dataset(name).map_err(|_| anyhow!("no `{name}`"))?;
    let shape = dataset.shape().iter().map(|&length| length as usize).collect();
    let numbers = match *dataset.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => read_as(&dataset, |n: f32| n.into()),
        Datatype::FloatingPoint { size: 8, .. } => read_as(&dataset, |n: f64| n),
        Datatype::FixedPoint { size: 4, signed: true, .. } => read_as(&dataset, |n: i32| n.into()),
        Datatype::FixedPoint { size: 8, signed: true, .. } => read_as(&dataset, |n: i64| n as f64),
        _ => bail!("`{name}` holds numbers of a type that is not taken: {:?}", dataset.dtype()),
    };
    Ok((shape, numbers.with_context(|| format!("`{name}` cannot be read"))?))
}

fn read_as<T: H5Type + Copy>(
    dataset: &Dataset,
    to_f64: impl Fn(T) -> f64,
) -> hdf5_reader::error::Result<Vec<f64>> {
    Ok(dataset.read_array::<T>()?.iter().map(|&number| to_f64(number)).collect())
}

impl Chain {
    /// The network in steps of so many seconds, by Euler's rule: spikes are a current that lasts for their step.
    /// `v += step / tau * (v_leak - v + r * I)` for LIF, `v += r * I` for IF, whose spikes are a step's charge.
    ///
    /// # Errors
    /// A time constant is shorter than a step, or the step is needed and not known.
    pub(super) fn in_steps(self, step: Option<f64>) -> Result<Trained> {
        let layers = self.0.into_iter().map(|stage| {
            let name = format!("node `{}`", stage.neurons.name);
            stage.in_steps(name.clone(), step).context(name)
        });
        Trained::new(layers.collect::<Result<_>>()?)
    }
}

impl Stage {
    fn in_steps(self, name: String, step: Option<f64>) -> Result<Layer> {
        let Self { weights: Weights { rows, bias }, neurons } = self;
        let mut layer = Layer {
            name,
            bias: bias.unwrap_or_else(|| vec![0.0; rows.len()]),
            weights: rows,
            neurons: Vec::new(),
        };
        for at in 0..layer.weights.len() {
            let resistance = neurons.resistance.at(at);
            let (part, rest) = match &neurons.leak {
                None => (0.0, 0.0),
                Some(Leak { tau, rest }) => {
                    let step = step.context(
                        "its time constants are in seconds, and neither --dt nor the recording's times say \
                         how long a step is",
                    )?;
                    let tau = tau.at(at);
                    ensure!(
                        tau >= step * (1.0 - 1e-9),
                        "a time constant of {tau} s is shorter than a step of {step} s; --dt gives the step \
                         that its framework counts with (snnTorch: 1e-4)"
                    );
                    (step / tau, rest.at(at))
                }
            };
            let returns = neurons.reset.as_ref().map_or(0.0, |reset| reset.at(at));
            ensure!(
                returns == rest,
                "neuron {at} returns to {returns} when it fires and leaks to {rest}: the chip has one value for both"
            );
            let gain = if neurons.leak.is_some() { part * resistance } else { resistance };
            layer.weights[at].iter_mut().for_each(|weight| *weight *= gain);
            layer.bias[at] *= gain;
            let keep = (1.0 - part).max(0.0);
            layer.neurons.push(Neuron { keep, threshold: neurons.threshold.at(at) - rest });
        }
        Ok(layer)
    }
}
