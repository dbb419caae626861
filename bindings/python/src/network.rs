//! Trained networks in the controller's single precision.

use std::path::PathBuf;

use anyhow::anyhow;
use lab::network::{
    Asked, ControllerRequest, File, Flown, Model, OnChip, Outputs, Remarks, State, Trains,
    bring_to_controller,
};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;

use crate::error::{Error, value};

/// The choice of this name.
fn choice<T: DeserializeOwned>(keyword: &str, asked: &str) -> PyResult<T> {
    let choice = serde_json::from_value(asked.into());
    choice.map_err(|error: serde_json::Error| {
        let words = error.to_string();
        let choices = words.split_once("expected ").map_or(&*words, |(_, choices)| choices);
        Error::new_err(format!("{keyword} {asked:?} must be {choices}"))
    })
}

/// A network and its state.
#[pyclass(module = "spikewire._native")]
pub(crate) struct Network {
    model: Model,
    flown: Flown,
}

impl From<Model> for Network {
    fn from(model: Model) -> Self {
        Self { flown: model.as_flown(), model }
    }
}

/// Spikes and potentials, a row for each step.
type Rows<'py> = (Bound<'py, PyArray2<bool>>, Bound<'py, PyArray2<f32>>);

/// A layer between two steps: potentials, currents, and the neurons that fired in the last one.
type Layer = (Vec<f32>, Vec<f32>, Vec<u16>);

/// Neurons that fire and potentials, by step.
type Held<'py> = (Trains, Bound<'py, PyArray2<f64>>);

/// Inputs that fire, and outputs that fired in the training framework, by step.
type Recorded = (Trains, Trains);

/// The framework, when a neuron fires, how it decays and which current it takes, as far as they are said.
type Said = [Option<String>; 4];

#[pymethods]
impl Network {
    #[new]
    fn new(
        path: PathBuf,
        said: Said,
        resets: Vec<String>,
        dt: Option<f64>,
        recorded: Option<Recorded>,
    ) -> PyResult<Self> {
        let [framework, fires, decay, current] = said;
        let mut asked = Asked {
            framework: framework.map(|own| choice("framework", &own)).transpose()?,
            resets: resets.iter().map(|own| choice("reset", own)).collect::<PyResult<_>>()?,
            fires: fires.map(|own| choice("fires", &own)).transpose()?,
            decay: decay.map(|own| choice("decay", &own)).transpose()?,
            current: current.map(|own| choice("current", &own)).transpose()?,
            dt,
        };
        let file = File::read(&path).map_err(value)?;
        if let Some((inputs, outputs)) = recorded {
            let found = file.find_rule(&asked, &inputs, &Outputs::Spikes(outputs));
            if let Some(found) = found.map_err(value)? {
                asked = found.asked;
            }
        }
        Ok(file.on_controller(&asked).map_err(value)?.into())
    }

    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        Ok(Model::from_toml(text).map_err(value)?.into())
    }

    fn toml(&self) -> PyResult<String> {
        self.model.to_toml().map_err(value)
    }

    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        Ok(Model::from_json(text).map_err(value)?.into())
    }

    fn json(&self) -> PyResult<String> {
        self.model.to_json().map_err(value)
    }

    /// Runs the network from rest in these numbers: the last layer's spikes and potentials, by step.
    fn ran<'py>(&self, py: Python<'py>, steps: Trains, numbers: &str) -> PyResult<Held<'py>> {
        let ran = self.brought(py, &steps, numbers, |network| network.run(&steps))?;
        let fired = ran.fired.into_iter().next_back().unwrap_or_default();
        Ok((fired, PyArray2::from_vec2(py, &ran.potentials)?))
    }

    /// Writes the network as a Rust module. `steps` are the inputs that fire in each step of a recording.
    fn rust(
        &self,
        py: Python,
        steps: Vec<Vec<u16>>,
        numbers: &str,
        source: String,
    ) -> PyResult<String> {
        let inputs = format!("{}, of spikes as they are", self.flown.inputs());
        let remarks = Remarks { source, inputs, step_us: None };
        self.brought(py, &steps, numbers, |network| Ok(network.emit(&remarks)))
    }

    fn layers(&self) -> Vec<usize> {
        self.flown.layers().collect()
    }

    fn inputs(&self) -> usize {
        self.flown.inputs()
    }

    fn reset(&mut self) {
        self.flown.reset();
    }

    /// The state of each layer.
    fn state(&self) -> Vec<Layer> {
        let states = self.flown.state().iter().cloned();
        states.map(|own| (own.potentials, own.currents, own.fired)).collect()
    }

    /// Goes on from a state of the same network.
    fn set_state(&mut self, state: Vec<Layer>) -> PyResult<()> {
        let mut states = Vec::new();
        for (potentials, currents, fired) in state {
            states.push(State { potentials, currents, fired });
        }
        if self.flown.set_state(states) {
            Ok(())
        } else {
            Err(value(anyhow!("the state is another network's")))
        }
    }

    fn potentials<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, self.flown.potentials())
    }

    /// The neurons of each layer that fired in the last step.
    fn fired(&self) -> Vec<Vec<u16>> {
        self.flown.fired().map(<[u16]>::to_vec).collect()
    }

    /// Takes a step with the numbers of the inputs that fire.
    fn step(&mut self, inputs: Vec<u16>) -> PyResult<()> {
        self.check(&inputs)?;
        self.flown.step(&inputs);
        Ok(())
    }

    /// Takes many steps: the last layer's spikes and potentials, by step.
    fn steps<'py>(&mut self, py: Python<'py>, inputs: Vec<Vec<u16>>) -> PyResult<Rows<'py>> {
        let outputs = self.flown.potentials().len();
        let (mut spikes, mut potentials) = (Vec::new(), Vec::new());
        for inputs in inputs {
            self.step(inputs)?;
            let mut fired = vec![false; outputs];
            for &neuron in self.flown.fired().last().unwrap_or_default() {
                fired[usize::from(neuron)] = true;
            }
            spikes.push(fired);
            potentials.push(self.flown.potentials().to_vec());
        }
        Ok((PyArray2::from_vec2(py, &spikes)?, PyArray2::from_vec2(py, &potentials)?))
    }
}

impl Network {
    /// Brings the network onto the controller, with numbers of this type, and returns what is asked of it there.
    fn brought<T: Send>(
        &self,
        py: Python,
        steps: &Trains,
        numbers: &str,
        asked: impl FnOnce(&dyn OnChip) -> lab::Result<T> + Send,
    ) -> PyResult<T> {
        if steps.is_empty() {
            return Err(Error::new_err("no steps"));
        }
        for step in steps {
            self.check(step)?;
        }
        let numbers = choice("numbers", numbers)?;
        let (model, progress) = (&self.model, &|_, _| {});
        let request = ControllerRequest {
            model,
            numbers,
            tuned: steps,
            held_out: None,
            framework: None,
            progress,
        };
        py.detach(|| asked(&*bring_to_controller(&request)?.network)).map_err(value)
    }

    /// Returns an error if the network lacks one of these inputs.
    fn check(&self, inputs: &[u16]) -> PyResult<()> {
        let count = self.flown.inputs();
        match inputs.iter().find(|input| usize::from(**input) >= count) {
            None => Ok(()),
            Some(odd) => Err(Error::new_err(format!(
                "input {odd}: the network has inputs 0 to {}",
                count - 1
            ))),
        }
    }
}
