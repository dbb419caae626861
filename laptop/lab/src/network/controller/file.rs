//! Writes and reads networks for the controller as TOML. Unlike a NIR graph, such a file holds the whole rule.

use super::form::{own, turned};
use super::net::{Layer, Net, Neuron, Recurrent, Spike};
use super::rule::{Current, Fires, PLAIN, Reset, Rule};
use super::{Asked, Model};
use crate::network::fault::{Context, FitKind, LayerKind, NetworkKind, Result, ensure};
use serde::{Deserialize, Serialize};

/// A network's file, from input to output.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Written {
    layers: Vec<WrittenLayer>,
}

/// A layer. Its matrices have one row for each neuron; its other lists have one number for each. A list that is left
/// out stands for zeros, unless its comment says otherwise.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenLayer {
    name: String,
    /// How a spike resets its neuron. `None` if the neurons never fire.
    #[serde(skip_serializing_if = "Option::is_none")]
    reset: Option<Reset>,
    /// Whether a neuron fires at its threshold. `None` if the neurons never fire.
    #[serde(skip_serializing_if = "Option::is_none")]
    fires: Option<Fires>,
    /// Which current the potential takes. `None` if the neurons have no current.
    #[serde(skip_serializing_if = "Option::is_none")]
    current: Option<Current>,
    /// Factor by which a step multiplies the potential.
    keep: Vec<f64>,
    /// Factor by which a step multiplies the current; left out if the neurons have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    current_keep: Vec<f64>,
    /// Amount that a step adds to the current or, if there is none, to the potential.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    bias: Vec<f64>,
    /// Amount that a step adds to the potential beside the current.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    inner: Vec<f64>,
    /// Left out if the neurons never fire.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    threshold: Vec<f64>,
    /// The potential after a spike, or the amount that a spike subtracts; the threshold if a spike subtracts and this
    /// is left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    reset_value: Vec<f64>,
    /// One weight for each input.
    weights: Vec<Vec<f64>>,
    /// One weight for each neuron of the layer, through which its spike acts one step later; left out if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    recurrent: Vec<Vec<f64>>,
}

impl Model {
    /// Writes the network as TOML, with the whole rule: [`from_toml`](Self::from_toml) gives the same network.
    ///
    /// # Errors
    /// Returns an error if the library for TOML does.
    pub fn to_toml(&self) -> Result<String> {
        Ok(toml::to_string(&self.written())?)
    }

    /// Reads a network from the TOML that [`to_toml`](Self::to_toml) writes.
    ///
    /// # Errors
    /// Returns an error if the text is not such TOML, if a number is out of its range, or if the layers do not fit.
    pub fn from_toml(text: &str) -> Result<Self> {
        Self::of_written(toml::from_str(text).map_err(|error| NetworkKind::NotToml { error })?)
    }

    /// Writes the network as JSON, with the keys of [`to_toml`](Self::to_toml).
    ///
    /// # Errors
    /// Returns an error if the library for JSON does.
    pub fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string(&self.written())?)
    }

    /// Reads a network from the JSON that [`to_json`](Self::to_json) writes.
    ///
    /// # Errors
    /// Returns an error if the text is not such JSON, if a number is out of its range, or if the layers do not fit.
    pub fn from_json(text: &str) -> Result<Self> {
        Self::of_written(serde_json::from_str(text)?)
    }

    /// Returns the network as its file has it, after checking that `asked` does not contradict the file.
    pub(in super::super) fn unless_asked(self, asked: &Asked) -> Result<Self> {
        ensure!(*asked == Asked::default(), NetworkKind::HasRule);
        Ok(self)
    }

    fn written(&self) -> Written {
        Written { layers: self.net.layers.iter().map(WrittenLayer::of).collect() }
    }

    fn of_written(written: Written) -> Result<Self> {
        let layers = written.layers.into_iter().map(|layer| {
            let name = layer.name.clone();
            layer.read().context(name)
        });
        let layers = layers.collect::<Result<Vec<_>>>()?;
        for layer in layers.split_last().map_or(&[][..], |(_, before)| before) {
            let fires = layer.neurons.iter().any(|neuron| neuron.spike.is_some());
            ensure!(fires, FitKind::SilentInside);
        }
        Self::new(Net { layers }, Vec::new())
    }
}

impl WrittenLayer {
    fn of(layer: &Layer<f64>) -> Self {
        let Layer { name, weights, own, neurons, rule } = layer;
        let each = |number: &dyn Fn(&Neuron<f64>) -> f64| -> Vec<f64> {
            let all = neurons.iter().map(number).collect::<Vec<_>>();
            if all.iter().all(|number| *number == 0.0) { vec![] } else { all }
        };
        let spikes = neurons.iter().filter_map(|neuron| neuron.spike);
        let threshold: Vec<f64> = spikes.clone().map(|spike| spike.threshold).collect();
        let reset: Vec<f64> = spikes.map(|spike| spike.reset).collect();
        let by_default =
            if rule.reset.subtracts() { threshold.clone() } else { vec![0.0; reset.len()] };
        let current_keep: Vec<f64> = neurons.iter().filter_map(|neuron| neuron.current).collect();
        let fires = !threshold.is_empty();
        Self {
            name: name.clone(),
            reset: fires.then_some(rule.reset),
            fires: fires.then_some(rule.fires),
            // Weights of the form are whole already.
            current: (!current_keep.is_empty()).then_some(match rule.current {
                Current::Whole => Current::New,
                current => current,
            }),
            keep: neurons.iter().map(|neuron| neuron.decay).collect(),
            current_keep,
            bias: each(&|neuron| neuron.bias),
            inner: each(&|neuron| neuron.inner),
            threshold,
            reset_value: if reset == by_default { vec![] } else { reset },
            weights: turned(weights),
            recurrent: match own {
                // Spikes that there are not need no weights.
                _ if !fires => vec![],
                Recurrent::None => vec![],
                Recurrent::Full(own) => turned(own),
                Recurrent::OneToOne(own) => diagonal(own),
            },
        }
    }

    fn read(self) -> Result<Layer<f64>> {
        let count = self.weights.len();
        let inputs = self.weights.first().map_or(0, Vec::len);
        ensure!(inputs > 0, LayerKind::NoWeights);
        for (neuron, row) in self.weights.iter().enumerate() {
            let weights = row.len();
            ensure!(weights == inputs, LayerKind::Row { neuron, weights, first: inputs });
        }
        ensure!(
            self.recurrent.is_empty()
                || self.recurrent.len() == count
                    && self.recurrent.iter().all(|row| row.len() == count),
            LayerKind::NotSquare { neurons: count }
        );
        let lists = [
            ("keep", &self.keep, false),
            ("current_keep", &self.current_keep, true),
            ("bias", &self.bias, true),
            ("inner", &self.inner, true),
            ("threshold", &self.threshold, true),
            ("reset_value", &self.reset_value, true),
        ];
        for (name, list, may_lack) in lists {
            let (values, name) = (list.len(), name.to_owned());
            let fits = values == count || may_lack && list.is_empty();
            ensure!(fits, LayerKind::Count { values, name, neurons: count });
        }
        for (neuron, &keep) in
            self.keep.iter().enumerate().chain(self.current_keep.iter().enumerate())
        {
            ensure!((0.0..=1.0).contains(&keep), LayerKind::Keep { neuron, keep });
        }
        let fires = !self.threshold.is_empty();
        ensure!(
            self.reset.is_some() == fires
                && self.fires.is_some() == fires
                && self.current.is_some() != self.current_keep.is_empty()
                && (fires || self.reset_value.is_empty() && self.recurrent.is_empty())
                && (self.current.is_some() || self.inner.is_empty()),
            FitKind::HalfRule
        );
        let rule = Rule {
            reset: self.reset.unwrap_or(PLAIN.reset),
            fires: self.fires.unwrap_or(PLAIN.fires),
            current: self.current.unwrap_or(PLAIN.current),
            ..PLAIN
        };
        let of = |list: &[f64], at: usize| list.get(at).copied();
        let neuron = |at: usize| {
            let spike = of(&self.threshold, at).map(|threshold| {
                let by_default = if rule.reset.subtracts() { threshold } else { 0.0 };
                Spike { threshold, reset: of(&self.reset_value, at).unwrap_or(by_default) }
            });
            Neuron {
                current: of(&self.current_keep, at),
                decay: self.keep[at],
                bias: of(&self.bias, at).unwrap_or(0.0),
                inner: of(&self.inner, at).unwrap_or(0.0),
                spike,
            }
        };
        Ok(Layer {
            neurons: (0..count).map(neuron).collect(),
            name: self.name,
            weights: turned(&self.weights),
            own: own(&self.recurrent),
            rule,
        })
    }
}

/// Returns a square matrix with these numbers on its diagonal.
pub(super) fn diagonal(numbers: &[f64]) -> Vec<Vec<f64>> {
    let row = |at: usize| (0..numbers.len()).map(move |from| f64::from(u8::from(from == at)));
    let rows = numbers.iter().enumerate();
    rows.map(|(at, number)| row(at).map(|one| one * number).collect()).collect()
}
