//! Brings trained networks onto the flight controller itself, where the crate `spikewire-network` runs them.

mod emit;
mod file;
mod find;
mod form;
mod net;
mod number;
mod on_chip;
mod open;
mod quantise;
mod rule;

pub use find::Found;
pub(super) use find::find;
pub use open::Choice;
pub(super) use open::words;
pub use rule::{Asked, Current, Decay, Fires, Framework, Reset, Rule};

use super::Trains;
use super::bring::{Brought, HeldOut, Original, OutputLayer, Outputs, Reading, figures};
use super::chip::{OnChip, Ran, Remarks, Stepped};
use super::costs::Cost;
use crate::network::fault::{FitKind, Result};
pub use net::State;
use net::{Done, Net, Recurrent};
use number::Number;
use quantise::Integers;
use serde::Deserialize;
use std::collections::BTreeSet;

/// A network in double precision, in the form that `spikewire-network` runs. Its parameters, such as decay factors,
/// apply to one time step.
pub struct Model {
    net: Net<f64>,
    /// Remarks for the user on unusual properties of the network's file.
    notes: Vec<String>,
}

/// The type of the network's numbers on the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Numbers {
    /// Single precision (`f32`), for cores with a floating-point unit.
    #[serde(rename = "f32")]
    Float,
    /// Integers: weights of 8 bits, potentials of 32 bits.
    #[serde(rename = "i8")]
    Integer,
}

/// A network to bring onto the flight controller, and the recordings on which the network is tuned and tested.
pub struct ControllerRequest<'a> {
    /// The network in double precision.
    pub model: &'a Model,
    /// The type of the network's numbers on the controller.
    pub numbers: Numbers,
    /// Input spikes, by step, of the recording on which the conversion to integers is tuned.
    pub tuned: &'a Trains,
    /// A second recording, on which the converted network is only tested; `None` to test it on `tuned` only.
    pub held_out: Option<HeldOut<'a>>,
    /// Outputs that the training framework computed in all steps of `tuned`. `None` if they are not known, or if there
    /// is a second recording.
    pub framework: Option<&'a Outputs>,
    /// Called during the conversion to integers, with the number of finished neurons and the total number of neurons.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// Number of steps in the generated self-test, which the flight controller runs before arming.
const CHECKED: usize = 10;

/// A network in the number type of the controller.
enum Held {
    Float(Net<f32>),
    Integer(Integers),
}

/// A network in the number type of the controller, with notes for the user and the inputs of the self-test.
struct OnController {
    held: Held,
    notes: Vec<String>,
    /// Input spikes of the steps in the generated self-test.
    check: Trains,
}

impl Model {
    /// Returns the number of inputs of the network.
    pub fn inputs(&self) -> usize {
        self.net.layers.first().map_or(0, net::Layer::inputs)
    }

    /// Returns the name that the network's file gives to the first layer.
    pub fn first(&self) -> &str {
        self.net.layers.first().map_or("", |layer| &layer.name)
    }

    /// Runs the network in double precision on the input spikes of all steps; returns the neurons that fire, by layer,
    /// then by step.
    pub fn run(&self, inputs: &Trains) -> Vec<Trains> {
        self.net.run(inputs).fired
    }

    /// Runs the network in `f32`; the results are bit for bit those of the controller. Returns the neurons that fire,
    /// by layer, then by step; and the potentials of the last layer, by step.
    pub fn run_as_flown(&self, inputs: &Trains) -> (Vec<Trains>, Vec<Vec<f32>>) {
        let Done { fired, potentials, .. } = quantise::float(&self.net).run(inputs);
        (fired, potentials)
    }

    /// Returns the network in `f32` in its initial state, to run it step by step. Its results are bit for bit those of
    /// the controller.
    pub fn as_flown(&self) -> Flown {
        let net = quantise::float(&self.net);
        Flown { state: net.state(), net }
    }

    fn original(&self, inputs: &Trains) -> Original {
        let Done { fired, potentials, .. } = self.net.run(inputs);
        let named = |layer: &net::Layer<f64>| (layer.name.clone(), layer.neurons.len());
        let mut layers: Vec<_> = self.net.layers.iter().map(named).collect();
        let readout = if self.is_silent() { layers.pop() } else { None };
        Original { layers, readout, fired, potentials }
    }

    /// Returns the layer whose spikes or potentials are the outputs.
    pub(super) fn outputs(&self) -> OutputLayer {
        let outputs = self.net.layers.last().map_or(0, |layer| layer.neurons.len());
        OutputLayer { outputs, fires: !self.is_silent() }
    }

    /// Returns whether the network's outputs are potentials of neurons that never fire.
    fn is_silent(&self) -> bool {
        let last = self.net.layers.last().and_then(|layer| layer.neurons.first());
        last.is_some_and(|neuron| neuron.spike.is_none())
    }
}

/// A network in `f32` with its state, which runs step by step. Its results are bit for bit those of the controller.
#[derive(Clone)]
pub struct Flown {
    net: Net<f32>,
    state: Vec<State<f32>>,
}

impl Flown {
    /// Returns the number of neurons of each layer.
    pub fn layers(&self) -> impl Iterator<Item = usize> {
        self.net.layers.iter().map(|layer| layer.neurons.len())
    }

    /// Returns the number of inputs of the network.
    pub fn inputs(&self) -> usize {
        self.net.layers.first().map_or(0, net::Layer::inputs)
    }

    /// Returns the network to its initial state.
    pub fn reset(&mut self) {
        self.state = self.net.state();
    }

    /// Returns the state of each layer.
    pub fn state(&self) -> &[State<f32>] {
        &self.state
    }

    /// Continues from `state`, which [`state`](Self::state) of the same network returned. Returns `false`, and changes
    /// nothing, if it is the state of another network.
    pub fn set_state(&mut self, state: Vec<State<f32>>) -> bool {
        let is_own = state.len() == self.state.len()
            && state.iter().zip(&self.state).all(|(new, own)| new.is_alike(own));
        if is_own {
            self.state = state;
        }
        is_own
    }

    /// Runs a step. `inputs` are the numbers of the inputs that fire, each below [`inputs`](Self::inputs); their order
    /// decides how sums are rounded.
    pub fn step(&mut self, inputs: &[u16]) {
        self.net.step(&mut self.state, inputs);
    }

    /// Returns, for each layer, the neurons that fired in the last step, in ascending order.
    pub fn fired(&self) -> impl Iterator<Item = &[u16]> {
        self.state.iter().map(|state| &state.fired[..])
    }

    /// Returns the potentials of the last layer after the last step.
    pub fn potentials(&self) -> &[f32] {
        self.state.last().map_or(&[], |last| &last.potentials)
    }
}

/// Brings a network onto the controller: converts its numbers, and compares the converted network's spikes with those
/// in double precision.
///
/// # Errors
/// Returns an error if the converted network cannot be run on the recordings.
pub fn bring_to_controller(request: &ControllerRequest) -> Result<Brought> {
    let ControllerRequest { model, numbers, tuned, held_out, framework, progress } = *request;
    if numbers == Numbers::Integer {
        check_spikes(&model.net)?;
    }
    let mut original = model.original(tuned);
    let mut reading = Reading::default();
    if let Some(framework) = framework {
        framework.check(&model.outputs(), tuned.len())?;
        reading = Reading::of(&original, framework, 0);
        original.replace_outputs(framework);
    }
    let mut notes = model.notes.clone();
    notes.extend(model.net.rules());
    let held = match numbers {
        Numbers::Float => Held::Float(quantise::float(&model.net)),
        Numbers::Integer => Held::Integer(quantise::integers(
            &model.net,
            tuned,
            &original.fired,
            &original.potentials,
            progress,
        )),
    };
    let saturated = match &held {
        Held::Float(_) => 0,
        Held::Integer(integers) => integers.net.run(tuned).saturated,
    };
    if saturated > 0 {
        notes.push(format!("warning: {saturated} potentials or currents left their range"));
    }
    let mut check = match &held {
        Held::Float(net) => liveliest(net, tuned),
        Held::Integer(integers) => liveliest(&integers.net, tuned),
    };
    let inputs = model.net.layers.first().map_or(0, net::Layer::inputs);
    check.extend(firing_others(&check, inputs));
    let network: Box<dyn OnChip> = Box::new(OnController { held, notes, check });
    let held_out = held_out
        .map(|all| figures(&model.original(all.steps), &*network, all.steps, all.from))
        .transpose()?;
    let tuned = figures(&original, &*network, tuned, 0)?;
    let Reading { share, error } = reading;
    Ok(Brought { network, tuned, held_out, costs: vec![], reading: share, reading_error: error })
}

/// Chooses [`CHECKED`] consecutive steps for the self-test, and returns their inputs. The network starts from rest, and
/// fires more spikes in these steps than in other steps that were tried. Steps in which an output fires are preferred.
fn liveliest<K: Number>(net: &Net<K>, inputs: &Trains) -> Trains {
    /// Maximum number of sequences of [`CHECKED`] steps to compare by their number of spikes.
    const TRIED: usize = 200;
    let stride = inputs.len().div_ceil(TRIED).max(1);
    let windows = inputs.windows(inputs.len().clamp(1, CHECKED)).step_by(stride);
    let lively = |window: &&[Vec<u16>]| {
        let spikes = |train: &Trains| train.iter().map(Vec::len).sum::<usize>();
        let counts = net.run(&window.to_vec()).fired.iter().map(spikes).collect::<Vec<_>>();
        (counts.last().copied().unwrap_or(0).min(1), counts.iter().sum::<usize>())
    };
    windows.max_by_key(lively).unwrap_or_default().to_vec()
}

/// Checks that no layer takes more spikes in a step than `spikewire-network` adds with weights of 8 bits.
fn check_spikes(net: &Net<f64>) -> Result<()> {
    const MOST: usize = 4096;
    for layer in &net.layers {
        let own = if matches!(layer.own, Recurrent::Full(_)) { layer.neurons.len() } else { 0 };
        let inputs = layer.inputs() + own;
        if inputs > MOST {
            return Err(FitKind::Spikes { layer: layer.name.clone(), inputs, most: MOST }.into());
        }
    }
    Ok(())
}

/// Returns steps in which each input fires that does not fire in these: up to 16 inputs in a step, so that the network
/// stays as lively as before.
fn firing_others(steps: &Trains, inputs: usize) -> Trains {
    const TOGETHER: usize = 16;
    let fired: BTreeSet<u16> = steps.iter().flatten().copied().collect();
    let others: Vec<u16> =
        (0..inputs).map(|input| input as u16).filter(|input| !fired.contains(input)).collect();
    others.chunks(TOGETHER).map(<[u16]>::to_vec).collect()
}

impl OnController {
    /// Returns the number of bytes of flash that the network takes (weights and neurons), and the number of bytes of
    /// RAM (state).
    fn bytes_of(&self) -> (usize, usize) {
        match &self.held {
            Held::Float(net) => bytes(net, 4),
            Held::Integer(integers) => bytes(&integers.net, 1),
        }
    }

    fn follow_in<K: Number>(
        net: &Net<K>,
        steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        let mut state = net.state();
        for inputs in steps {
            let (operations, _) = net.step(&mut state, &inputs?);
            let fired = state.iter().map(|State { fired, .. }| fired.clone()).collect();
            see(Stepped { fired, clocks: operations as u64 })?;
        }
        Ok(0)
    }
}

/// Returns the number of bytes of flash and the number of bytes of RAM that a network takes in `spikewire-network`. A
/// weight takes `weight` bytes.
fn bytes<K: Number>(net: &Net<K>, weight: usize) -> (usize, usize) {
    let (mut flash, mut ram) = (0, 0);
    for layer in &net.layers {
        let count = layer.neurons.len();
        let own = match layer.own {
            Recurrent::None => 0,
            Recurrent::Full(_) => count * count,
            Recurrent::OneToOne(_) => count,
        };
        let first = layer.neurons.first();
        let has_current = first.is_some_and(|neuron| neuron.current.is_some());
        let fires = first.is_some_and(|neuron| neuron.spike.is_some());
        let neuron = if fires { 16 } else { 8 } + if has_current { 8 } else { 0 };
        flash += (layer.inputs() * count + own) * weight + count * neuron;
        let list = (2 * count).next_multiple_of(4) + 8;
        ram += count * if has_current { 8 } else { 4 } + list + 16;
    }
    (flash, ram)
}

impl OnChip for OnController {
    fn run(&self, inputs: &Trains) -> Result<Ran> {
        let (fired, potentials, clocks) = match &self.held {
            Held::Float(net) => {
                let done = net.run(inputs);
                let row = |row: &Vec<f32>| row.iter().map(|&v| v.into()).collect();
                (done.fired, done.potentials.iter().map(row).collect(), done.operations)
            }
            Held::Integer(Integers { net, units, .. }) => {
                let done = net.run(inputs);
                let row = |row: &Vec<i32>| {
                    row.iter().zip(units).map(|(&v, unit)| f64::from(v) * unit).collect()
                };
                (done.fired, done.potentials.iter().map(row).collect(), done.operations)
            }
        };
        Ok(Ran { fired, potentials, clocks, lost: 0, clipped: 0 })
    }

    fn follow(
        &self,
        steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        match &self.held {
            Held::Float(net) => Self::follow_in(net, steps, see),
            Held::Integer(integers) => Self::follow_in(&integers.net, steps, see),
        }
    }

    fn clipped(&self) -> Vec<usize> {
        match &self.held {
            Held::Float(net) => vec![0; net.layers.len()],
            Held::Integer(integers) => integers.clipped.clone(),
        }
    }

    fn emit(&self, remarks: &Remarks) -> String {
        match &self.held {
            Held::Float(net) => emit::emit(net, &[], &[], &self.check, remarks),
            Held::Integer(Integers { net, shifts, units, .. }) => {
                emit::emit(net, shifts, units, &self.check, remarks)
            }
        }
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        Err(FitKind::NoBytes.into())
    }

    fn notes(&self) -> Vec<String> {
        let (flash, ram) = self.bytes_of();
        let size = format!("{flash} bytes of flash for weights and neurons, {ram} bytes of RAM");
        self.notes.iter().cloned().chain([size]).collect()
    }

    fn costs(&self) -> Vec<Cost> {
        vec![]
    }

    fn loss(&self) -> &'static str {
        "the network has no such inputs"
    }

    fn effort(&self, mean: f64, most: u64) -> String {
        let neurons: usize = match &self.held {
            Held::Float(net) => net.layers.iter().map(|layer| layer.neurons.len()).sum(),
            Held::Integer(all) => all.net.layers.iter().map(|layer| layer.neurons.len()).sum(),
        };
        format!("a step adds {mean:.1} weights, {most} at most, and visits {neurons} neurons")
    }
}
