//! Reads NIR, the Neuromorphic Intermediate Representation: a graph of neurons and weights in an HDF5 file, as written
//! by the Python package `nir`.
//!
//! Source: J. E. Pedersen et al., *Neuromorphic intermediate representation*, Nature Communications 15 (2024), table 1.

use crate::network::bring::OutputLayer;
use crate::network::fault::{Context, LayerKind, NirKind, Result, ensure};
use crate::{Place, Spot};
use hdf5_reader::group::Group;
use hdf5_reader::messages::datatype::Datatype;
use hdf5_reader::{ByteOrder, Dataset, H5Type, Hdf5File, OpenOptions};
use std::collections::BTreeMap;

/// Maximum size of an array in a file, in bytes. The limit prevents huge allocations for damaged files; 256 neurons
/// with 256 weights each need 512 KiB at most.
const MOST_BYTES: usize = 1 << 26;

/// The layers of a NIR graph, from input to output. Time constants are in seconds.
#[derive(Clone)]
pub struct Chain {
    pub(super) stages: Vec<Stage>,
    /// The last layer, if its neurons never fire.
    pub(super) readout: Option<Stage>,
    /// Weights after the last neurons, if the graph ends with weights. The outputs are then weighted sums of the last
    /// neurons' spikes.
    pub(super) sum: Option<Weights>,
    /// Remarks for the user on unusual properties of the file that the reader accepts.
    pub(super) notes: Vec<String>,
}

impl Chain {
    /// Returns the layer whose spikes or potentials are the outputs.
    pub(super) fn outputs(&self) -> OutputLayer {
        let weights = self.sum.as_ref().or(self.readout.as_ref().map(|readout| &readout.weights));
        match (weights, self.stages.last()) {
            (Some(weights), _) => OutputLayer { outputs: weights.rows.len(), fires: false },
            (None, Some(last)) => OutputLayer { outputs: last.weights.rows.len(), fires: true },
            (None, None) => OutputLayer { outputs: 0, fires: true },
        }
    }

    /// Returns the number of inputs.
    pub(super) fn inputs(&self) -> usize {
        let stage = self.stages.first().or(self.readout.as_ref()).map(|stage| &stage.weights);
        let weights = stage.or(self.sum.as_ref());
        weights.and_then(|weights| weights.rows.first()).map_or(0, Vec::len)
    }

    /// Returns whether a layer has neurons with a synaptic current.
    pub(super) fn has_currents(&self) -> bool {
        self.stages.iter().chain(&self.readout).any(|stage| stage.neurons.synapse.is_some())
    }
}

#[derive(Clone)]
pub(super) struct Stage {
    pub(super) weights: Weights,
    /// Recurrent weights, from neurons of the layer to neurons of the same layer; `None` if the layer is not recurrent.
    pub(super) recurrent: Option<Weights>,
    pub(super) neurons: Neurons,
}

#[derive(Clone)]
pub(super) struct Weights {
    /// The weights: one row for each neuron, with one weight for each input.
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) bias: Option<Vec<f64>>,
}

#[derive(Clone)]
pub(super) struct Neurons {
    /// Name of the node in the graph.
    name: String,
    /// The leak; `None` for neurons that do not leak (perfect integrators).
    pub(super) leak: Option<Leak>,
    pub(super) resistance: Array,
    /// Threshold of each neuron; `None` if the neurons never fire.
    pub(super) threshold: Option<Array>,
    pub(super) reset: Option<Array>,
    /// Time constant and weight of the synaptic current. `None` for neurons without such a current: an input spike then
    /// acts on the potential in its own step only.
    pub(super) synapse: Option<Synapse>,
}

#[derive(Clone)]
pub(super) struct Synapse {
    pub(super) tau: Array,
    pub(super) weight: Array,
}

#[derive(Clone)]
pub(super) struct Leak {
    pub(super) tau: Array,
    pub(super) rest: Array,
}

/// A parameter of neurons: one number for each neuron, or a single number for all.
#[derive(Clone)]
pub(super) struct Array(pub(super) Vec<f64>);

impl Array {
    pub(super) fn at(&self, neuron: usize) -> f64 {
        if let [one] = self.0[..] { one } else { self.0[neuron] }
    }
}

/// A NIR graph in which nested graphs were replaced by their nodes. The name of a node from a nested graph is its path,
/// such as `graph.node`.
#[derive(Default)]
struct Graph {
    nodes: BTreeMap<String, Group>,
    edges: Vec<(String, String)>,
    /// For each nested graph, by its path: the names of its input node and its output node.
    inner: BTreeMap<String, (String, String)>,
}

/// The connections from a layer back to itself.
struct Loops<'a> {
    /// Whether an edge without weights leads from the layer to itself.
    is_direct: bool,
    weights: Vec<&'a str>,
}

/// Types of NIR nodes whose neurons fire. A layer of such neurons may be recurrent.
const FIRING: [&str; 3] = ["LIF", "IF", "CubaLIF"];
/// Types of NIR nodes whose neurons never fire. Only the last layer may consist of such neurons.
const SILENT: [&str; 3] = ["LI", "I", "CubaLI"];

/// Reads a NIR graph. It must be a chain in which weights (Linear or Affine) and neurons alternate. Layers that fire
/// may be recurrent; the last layer may be one that never fires. Nested graphs are replaced by their nodes.
///
/// # Errors
/// Returns an error if the file is damaged, or if the graph has a different structure.
pub(crate) fn read(bytes: Vec<u8>) -> Result<Chain> {
    let options = OpenOptions::default().with_max_read_bytes(MOST_BYTES);
    let file = Hdf5File::from_vec_with_options(bytes, options)
        .map_err(|cause| NirKind::Damaged { cause })?;
    let root = file.group("/node").map_err(|cause| NirKind::NoGraphInFile { cause })?;
    let mut graph = Graph::default();
    let (first, last) = graph.take(&root, "", 0)?;
    graph.join();

    let (mut stages, mut readout) = (Vec::new(), None);
    let mut weights: Option<Weights> = None;
    for (name, loops) in graph.chain(&first, &last)? {
        let node = &graph.nodes[name];
        let kind = kind(node, name)?;
        let mut read = || -> Result<()> {
            match (kind.as_str(), weights.take()) {
                ("Flatten" | "Input" | "Output", before) => weights = before,
                _ if readout.is_some() => return Err(NirKind::AfterSilent.into()),
                ("Linear" | "Affine", None) => weights = Some(read_weights(node, &kind)?),
                ("Linear" | "Affine", Some(_)) => {
                    return Err(NirKind::WeightsOnWeights.into());
                }
                (fires, Some(weights)) if FIRING.contains(&fires) => {
                    let neurons = read_neurons(node, name, &kind, weights.rows.len())?;
                    let recurrent = graph.recurrent(&loops, weights.rows.len())?;
                    stages.push(Stage { weights, recurrent, neurons });
                }
                (silent, Some(weights)) if SILENT.contains(&silent) => {
                    let neurons = read_neurons(node, name, &kind, weights.rows.len())?;
                    readout = Some(Stage { weights, recurrent: None, neurons });
                }
                (neurons, None) if FIRING.contains(&neurons) || SILENT.contains(&neurons) => {
                    return Err(NirKind::NoWeights.into());
                }
                _ => return Err(NirKind::UnknownNode.into()),
            }
            Ok(())
        };
        read().with_context(|| format!("node `{name}` ({kind})"))?;
    }
    let notes = graph.batch(&first)?;
    Ok(Chain { stages, readout, sum: weights, notes })
}

fn kind(node: &Group, name: &str) -> Result<String> {
    let kind = node.dataset("type").and_then(|kind| kind.read_string());
    kind.map_err(|cause| NirKind::NoType { cause }.at(node_at(name)))
}

/// Returns the location that an error reports for the node `name`.
fn node_at(name: &str) -> Spot {
    Spot::Part(format!("node `{name}`"))
}

/// Maximum number of levels of graphs within graphs.
const DEEPEST: usize = 8;

impl Graph {
    /// Adds the nodes and edges of the NIR graph in `group` to this graph. Also adds the nodes and edges of all graphs
    /// that are nested in the NIR graph. `path` is the path of the NIR graph, empty for the outermost graph. The path
    /// becomes the first part of each added name. `depth` is the number of graphs that enclose the NIR graph. Returns
    /// the names of the input node and the output node of the NIR graph.
    ///
    /// # Errors
    /// Returns an error if the group is not a graph with one input and one output, or if graphs are nested too deeply.
    fn take(&mut self, group: &Group, path: &str, depth: usize) -> Result<(String, String)> {
        let at = || Place { file: None, spot: (!path.is_empty()).then(|| node_at(path)) };
        ensure!(depth < DEEPEST, NirKind::TooDeep { most: DEEPEST }.at(at()));
        let no_graph = |cause| NirKind::NoGraph { cause }.at(at());
        let under = |name: &str| {
            if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
        };
        let groups = group.groups().map_err(no_graph)?;
        let nodes = groups.iter().find(|group| group.name() == "nodes");
        let nodes = nodes.ok_or_else(|| NirKind::NoNodes.at(at()))?;
        let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
        for node in nodes.groups()? {
            let name = under(node.name());
            match kind(&node, &name)?.as_str() {
                "NIRGraph" => {
                    let ends = self.take(&node, &name, depth + 1)?;
                    self.inner.insert(name, ends);
                    continue;
                }
                "Input" => inputs.push(name.clone()),
                "Output" => outputs.push(name.clone()),
                _ => {}
            }
            self.nodes.insert(name, node);
        }
        let edges = group.dataset("edges").map_err(no_graph)?.read_strings()?;
        let edges = edges.as_chunks().0.iter().map(|[from, to]| (under(from), under(to)));
        self.edges.extend(edges);
        let one = |kind: &'static str, mut found: Vec<String>| match found.pop() {
            Some(one) if found.is_empty() => Ok(one),
            last => {
                found.extend(last);
                Err(NirKind::NotOne { kind, found }.at(at()))
            }
        };
        Ok((one("Input", inputs)?, one("Output", outputs)?))
    }

    /// Returns a remark for the user if the shape of the input node begins with an extra dimension of 1, for batches.
    /// Norse writes such files; the Python package `nir` refuses them.
    fn batch(&self, input: &str) -> Result<Vec<String>> {
        let node = &self.nodes[input];
        let is_told = node.datasets()?.iter().any(|dataset| dataset.name() == "shape");
        let shape = if is_told { numbers(node, "shape")?.1 } else { vec![] };
        Ok(match shape[..] {
            [1.0, .., inputs] => vec![format!(
                "node `{input}`: its shape {shape:?} keeps a dimension of batches, as Norse leaves it; taken as {inputs} \
                 inputs"
            )],
            _ => vec![],
        })
    }

    /// Reconnects all edges that start or end at a nested graph. An edge that starts at the nested graph then starts at
    /// the graph's output node. An edge that ends at the nested graph then ends at the graph's input node.
    fn join(&mut self) {
        for (from, to) in &mut self.edges {
            if let Some((_, output)) = self.inner.get(from) {
                from.clone_from(output);
            }
            if let Some((input, _)) = self.inner.get(to) {
                to.clone_from(input);
            }
        }
    }

    fn after(&self, name: &str) -> Vec<&str> {
        let mut after: Vec<&str> = Vec::new();
        for (from, to) in &self.edges {
            if from == name && !after.contains(&to.as_str()) {
                after.push(to);
            }
        }
        after
    }

    /// Follows the chain of nodes from `first` to `last`. Returns, for each node, its name and the connections that
    /// lead from the node back to itself.
    ///
    /// # Errors
    /// Returns an error if the graph is not a chain.
    fn chain(&self, first: &str, last: &str) -> Result<Vec<(&str, Loops<'_>)>> {
        let node = |name: &str| self.nodes.get_key_value(name);
        let (mut at, _) = node(first).ok_or(NirKind::NoInput)?;
        let mut path: Vec<(&str, Loops)> = Vec::new();
        loop {
            let mut loops = Loops { is_direct: false, weights: Vec::new() };
            let mut next = Vec::new();
            let fires = FIRING.contains(&kind(&self.nodes[at], at)?.as_str());
            for to in self.after(at) {
                let (to, weights) = node(to)
                    .ok_or_else(|| NirKind::NoSuchNode { from: at.clone(), to: to.to_owned() })?;
                let is_weights = matches!(kind(weights, to)?.as_str(), "Linear" | "Affine");
                if fires && to == at {
                    loops.is_direct = true;
                } else if fires && is_weights && self.after(to) == [at] {
                    loops.weights.push(to);
                } else {
                    next.push(to);
                }
            }
            path.push((at, loops));
            if at == last {
                break;
            }
            let is_back = |to: &&&String| path.iter().any(|(name, _)| *name == to.as_str());
            if let Some(back) = next.iter().find(is_back) {
                let (from, to) = (at.clone(), (*back).clone());
                return Err(NirKind::LeadsBack { from, to }.into());
            }
            let [one] = next[..] else {
                let to = next.into_iter().cloned().collect();
                return Err(NirKind::NotAChain { from: at.clone(), to }.into());
            };
            at = one;
        }
        let is_on_it = |name: &str| {
            path.iter().any(|(on, loops)| *on == name || loops.weights.contains(&name))
        };
        if let Some(name) = self.nodes.keys().find(|name| !is_on_it(name)) {
            let [node, first, last] = [name, first, last].map(str::to_owned);
            return Err(NirKind::NotOnTheWay { node, first, last }.into());
        }
        Ok(path)
    }

    /// Returns the recurrent weights of a layer with `count` neurons: the sum of the weight matrices of all connections
    /// in `loops`. Returns `None` if there are no connections.
    fn recurrent(&self, loops: &Loops, count: usize) -> Result<Option<Weights>> {
        if !loops.is_direct && loops.weights.is_empty() {
            return Ok(None);
        }
        let direct = |row: usize, column| f64::from(u8::from(loops.is_direct && row == column));
        let row = |row| (0..count).map(|column| direct(row, column)).collect();
        let mut sum = Weights { rows: (0..count).map(row).collect(), bias: None };
        for &name in &loops.weights {
            let node = &self.nodes[name];
            let Weights { rows, bias } = read_weights(node, &kind(node, name)?)?;
            let is_square = rows.len() == count && rows.iter().all(|row| row.len() == count);
            let not_square = || NirKind::NotSquare { weights: name.to_owned(), neurons: count };
            ensure!(is_square, not_square());
            let sums = sum.rows.iter_mut().flatten();
            sums.zip(rows.iter().flatten()).for_each(|(sum, weight)| *sum += weight);
            if let Some(bias) = bias {
                let sums = sum.bias.get_or_insert_with(|| vec![0.0; count]);
                sums.iter_mut().zip(bias).for_each(|(sum, bias)| *sum += bias);
            }
        }
        Ok(Some(sum))
    }
}

fn read_weights(node: &Group, kind: &str) -> Result<Weights> {
    let (shape, weights) = numbers(node, "weight")?;
    let [outputs, inputs] = shape[..] else {
        return Err(NirKind::Dimensions { dimensions: shape.len() }.into());
    };
    ensure!(outputs > 0 && inputs > 0, NirKind::Empty { outputs, inputs });
    let bias = match kind {
        "Affine" => {
            let (_, bias) = numbers(node, "bias")?;
            let (values, name) = (bias.len(), "bias".to_owned());
            ensure!(values == outputs, LayerKind::Count { values, name, neurons: outputs });
            Some(bias)
        }
        _ => None,
    };
    Ok(Weights { rows: weights.chunks(inputs).map(<[f64]>::to_vec).collect(), bias })
}

fn read_neurons(node: &Group, name: &str, kind: &str, count: usize) -> Result<Neurons> {
    let array = |what: &str| -> Result<Array> {
        let (_, numbers) = numbers(node, what)?;
        let given = numbers.len();
        let name = what.to_owned();
        if given != 1 && given != count {
            return Err(LayerKind::Count { values: given, name, neurons: count }.into());
        }
        if let Some(&number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(NirKind::NotFinite { name, number }.into());
        }
        Ok(Array(numbers))
    };
    let has = |what: &str| -> Result<bool> {
        Ok(node.datasets()?.iter().any(|dataset| dataset.name() == what))
    };
    let leak = match kind {
        "LIF" | "LI" => Some(Leak { tau: array("tau")?, rest: array("v_leak")? }),
        "CubaLIF" | "CubaLI" => Some(Leak { tau: array("tau_mem")?, rest: array("v_leak")? }),
        _ => None,
    };
    let synapse = match kind {
        "CubaLIF" | "CubaLI" => Some(Synapse {
            tau: array("tau_syn")?,
            weight: if has("w_in")? { array("w_in")? } else { Array(vec![1.0]) },
        }),
        _ => None,
    };
    Ok(Neurons {
        name: name.to_owned(),
        leak,
        resistance: array("r")?,
        threshold: if FIRING.contains(&kind) { Some(array("v_threshold")?) } else { None },
        reset: if has("v_reset")? { Some(array("v_reset")?) } else { None },
        synapse,
    })
}

/// Reads the array `name` of a node. Returns its shape, and its numbers converted to `f64`.
fn numbers(node: &Group, name: &str) -> Result<(Vec<usize>, Vec<f64>)> {
    let dataset = node.dataset(name).map_err(|_| NirKind::NoArray { name: name.to_owned() })?;
    let shape = dataset.shape().iter().map(|&length| length as usize).collect();
    let numbers = match *dataset.dtype() {
        Datatype::FloatingPoint { size: 2, .. } => read_as(&dataset, |Half(n)| n),
        Datatype::FloatingPoint { size: 4, .. } => read_as(&dataset, |n: f32| n.into()),
        Datatype::FloatingPoint { size: 8, .. } => read_as(&dataset, |n: f64| n),
        Datatype::FixedPoint { size: 4, signed: true, .. } => read_as(&dataset, |n: i32| n.into()),
        Datatype::FixedPoint { size: 8, signed: true, .. } => read_as(&dataset, |n: i64| n as f64),
        _ => {
            let datatype = format!("{:?}", dataset.dtype());
            return Err(NirKind::ArrayType { name: name.to_owned(), datatype }.into());
        }
    };
    let numbers = numbers.map_err(|cause| NirKind::Unread { name: name.to_owned(), cause })?;
    Ok((shape, numbers))
}

fn read_as<T: H5Type + Copy>(
    dataset: &Dataset,
    to_f64: impl Fn(T) -> f64,
) -> hdf5_reader::error::Result<Vec<f64>> {
    Ok(dataset.read_array::<T>()?.iter().map(|&number| to_f64(number)).collect())
}

/// A number of half precision, which Rust has no type for.
#[derive(Clone, Copy)]
struct Half(f64);

impl Half {
    fn from_bits(bits: u16) -> Self {
        let (exponent, fraction) = (i32::from(bits >> 10 & 0x1F), f64::from(bits & 0x3FF));
        let size = match exponent {
            0 => fraction * 2_f64.powi(-24),
            0x1F if fraction > 0.0 => f64::NAN,
            0x1F => f64::INFINITY,
            _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
        };
        Self(if bits >> 15 == 1 { -size } else { size })
    }
}

impl H5Type for Half {
    fn hdf5_type() -> Datatype {
        Datatype::FloatingPoint { size: 2, byte_order: ByteOrder::LittleEndian }
    }

    fn from_bytes(bytes: &[u8], datatype: &Datatype) -> hdf5_reader::error::Result<Self> {
        let (&[first, second], Datatype::FloatingPoint { size: 2, byte_order }) = (bytes, datatype)
        else {
            let expected = "half precision".to_owned();
            let actual = format!("{datatype:?}");
            return Err(hdf5_reader::error::Error::TypeMismatch { expected, actual });
        };
        Ok(Self::from_bits(match byte_order {
            ByteOrder::LittleEndian => u16::from_le_bytes([first, second]),
            ByteOrder::BigEndian => u16::from_be_bytes([first, second]),
        }))
    }

    fn element_size(_: &Datatype) -> usize {
        2
    }
}

impl Neurons {
    pub(super) fn name(&self) -> String {
        format!("node `{}`", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::Half;

    #[test]
    fn half_precision_is_exact() {
        for (bits, number) in [
            (0x3C00, 1.0),
            (0xC000, -2.0),
            (0x3555, 0.333_251_953_125),
            (0x7BFF, 65_504.0),
            (0x0001, 2_f64.powi(-24)),
            (0x83FF, -1023.0 * 2_f64.powi(-24)),
            (0x0400, 2_f64.powi(-14)),
            (0xFC00, f64::NEG_INFINITY),
        ] {
            assert_eq!(Half::from_bits(bits).0, number, "{bits:#x}");
        }
        assert!(Half::from_bits(0x7E00).0.is_nan());
    }
}
