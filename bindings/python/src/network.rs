//! Trained networks in the controller's single precision.

use std::path::PathBuf;

use lab::network::{Asked, Current, Decay, File, Fires, Flown, Framework, Reset};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error::value;

const FRAMEWORKS: [(&str, Framework); 6] = [
    ("snntorch", Framework::SnnTorch),
    ("norse", Framework::Norse),
    ("spikingjelly", Framework::SpikingJelly),
    ("rockpool", Framework::Rockpool),
    ("sinabs", Framework::Sinabs),
    ("nir", Framework::Nir),
];

const RESETS: [(&str, Reset); 7] = [
    ("to-value", Reset::ToValue),
    ("to-value-late", Reset::ToValueLate),
    ("to-value-held", Reset::ToValueHeld),
    ("subtract", Reset::Subtract),
    ("subtract-late", Reset::SubtractLate),
    ("subtract-no-delay", Reset::SubtractNoDelay),
    ("none", Reset::NoReset),
];

const FIRES: [(&str, Fires); 2] = [("above", Fires::Above), ("at", Fires::At)];

const DECAYS: [(&str, Decay); 2] = [("euler", Decay::Euler), ("exponential", Decay::Exponential)];

const CURRENTS: [(&str, Current); 3] =
    [("new", Current::New), ("old", Current::Old), ("whole", Current::Whole)];

/// The choice of this name.
fn choice<T: Copy>(keyword: &str, choices: &[(&str, T)], asked: &str) -> PyResult<T> {
    let found = choices.iter().find(|(name, _)| *name == asked).map(|(_, choice)| *choice);
    found.ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        PyValueError::new_err(format!("{keyword} {asked:?} must be one of {}", names.join(", ")))
    })
}

/// A network and its state.
#[pyclass(module = "spikewire._native")]
pub(crate) struct Network {
    flown: Flown,
}

/// Spikes and potentials, a row for each step.
type Rows<'py> = (Bound<'py, PyArray2<bool>>, Bound<'py, PyArray2<f32>>);

/// The framework, when a neuron fires, how it decays and which current it takes, as far as they are said.
type Said = [Option<String>; 4];

#[pymethods]
impl Network {
    #[new]
    fn new(path: PathBuf, said: Said, resets: Vec<String>, dt: Option<f64>) -> PyResult<Self> {
        let [framework, fires, decay, current] = said;
        let asked = Asked {
            framework: framework.map(|own| choice("framework", &FRAMEWORKS, &own)).transpose()?,
            resets: resets
                .iter()
                .map(|own| choice("reset", &RESETS, own))
                .collect::<PyResult<_>>()?,
            fires: fires.map(|own| choice("fires", &FIRES, &own)).transpose()?,
            decay: decay.map(|own| choice("decay", &DECAYS, &own)).transpose()?,
            current: current.map(|own| choice("current", &CURRENTS, &own)).transpose()?,
            dt,
        };
        let model = File::read(&path).and_then(|file| file.on_controller(&asked));
        let model = model.map_err(value)?;
        Ok(Self { flown: model.as_flown() })
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

    fn potentials<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, self.flown.potentials())
    }

    /// The neurons of each layer that fired in the last step.
    fn fired(&self) -> Vec<Vec<u16>> {
        self.flown.fired().map(<[u16]>::to_vec).collect()
    }

    /// Takes a step with the numbers of the inputs that fire.
    fn step(&mut self, inputs: Vec<u16>) -> PyResult<()> {
        let count = self.flown.inputs();
        if let Some(odd) = inputs.iter().find(|input| usize::from(**input) >= count) {
            let words = format!("input {odd}: the network has inputs 0 to {}", count - 1);
            return Err(PyValueError::new_err(words));
        }
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
