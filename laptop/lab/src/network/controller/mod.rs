//! Brings trained networks onto the flight controller itself, where the crate `spikewire-network` runs them.

mod emit;
mod form;
mod net;
mod number;
mod on_chip;
mod open;
mod quantise;
mod rule;

pub use open::Choice;
pub(super) use open::words;
pub use rule::{Asked, Current, Decay, Fires, Framework, Reset, Rule};

use super::Trains;
use super::bring::{Brought, HeldOut, Original, figures};
use super::chip::{OnChip, Ran, Remarks, Stepped};
use super::costs::Cost;
use crate::network::fault::{FitKind, Result};
use net::{Done, Net, Recurrent, State};
use number::Number;
use quantise::Integers;

/// A network in double precision, in the form of `spikewire-network`: parameters for a step.
pub struct Model {
    net: Net<f64>,
    /// Remarks for the user on peculiarities of the network's file.
    notes: Vec<String>,
}

/// The type of the network's numbers on the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Single precision (`f32`), for cores with a floating-point unit.
    Float,
    /// Integers: weights of 8 bits, potentials of 32 bits.
    Integer,
}

/// A network to bring onto the controller, and the recordings on which it is tuned and tested.
pub struct ControllerRequest<'a> {
    /// The network in double precision.
    pub model: &'a Model,
    /// The type of the network's numbers on the controller.
    pub numbers: Numbers,
    /// Input spikes of the recording on which integers are tuned, by step.
    pub tuned: &'a Trains,
    /// A recording on which the result is only tested.
    pub held_out: Option<HeldOut<'a>>,
    /// Called with the number of neurons that are done, and the number of all neurons.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// Number of steps that the generated check runs before arming.
const CHECKED: usize = 10;

/// The network, in the number type of the controller.
enum Held {
    Float(Net<f32>),
    Integer(Integers),
}

/// A network as the controller stores it.
struct OnController {
    held: Held,
    notes: Vec<String>,
    /// Input spikes of the steps that the generated check runs before arming.
    check: Trains,
}

impl Model {
    /// Returns the number of inputs of the network.
    pub fn inputs(&self) -> usize {
        self.net.layers.first().map_or(0, net::Layer::inputs)
    }

    /// Returns the name of the first layer in the network's file.
    pub fn first(&self) -> &str {
        self.net.layers.first().map_or("", |layer| &layer.name)
    }

    /// Runs the network in double precision on the input spikes of all steps; returns the neurons that fire, by layer,
    /// then by step.
    pub fn run(&self, inputs: &Trains) -> Vec<Trains> {
        self.net.run(inputs).fired
    }

    /// Runs the network in `f32`, with the same bits as the controller. Returns the neurons that fire, by layer, then
    /// by step; and the potentials of the last layer, by step.
    pub fn run_as_flown(&self, inputs: &Trains) -> (Vec<Trains>, Vec<Vec<f32>>) {
        let Done { fired, potentials, .. } = quantise::float(&self.net).run(inputs);
        (fired, potentials)
    }

    /// Returns the network in `f32` and its initial state, to run it step by step with the same bits as the controller.
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

    /// Returns whether the network's outputs are potentials of neurons that never fire.
    fn is_silent(&self) -> bool {
        let last = self.net.layers.last().and_then(|layer| layer.neurons.first());
        last.is_some_and(|neuron| neuron.spike.is_none())
    }
}

/// A network in `f32` and its state, which runs step by step with the same bits as the controller.
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

    /// Runs a step. `inputs` are the numbers of the inputs that fire, each below [`inputs`](Self::inputs); their order
    /// decides how sums are rounded.
    pub fn step(&mut self, inputs: &[u16]) {
        self.net.step(&mut self.state, inputs);
    }

    /// Returns the neurons that fired in the last step, for each layer, in ascending order.
    pub fn fired(&self) -> impl Iterator<Item = &[u16]> {
        self.state.iter().map(|state| &state.fired[..])
    }

    /// Returns the potentials of the last layer after the last step.
    pub fn potentials(&self) -> &[f32] {
        self.state.last().map_or(&[], |last| &last.potentials)
    }
}

/// Brings a network onto the controller: converts its numbers, and compares its spikes with those in double precision.
///
/// # Errors
/// Returns an error if the network has too many inputs or neurons.
pub fn bring_to_controller(request: &ControllerRequest) -> Result<Brought> {
    let ControllerRequest { model, numbers, tuned, held_out, progress } = *request;
    let original = model.original(tuned);
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
    let check = match &held {
        Held::Float(net) => liveliest(net, tuned),
        Held::Integer(integers) => liveliest(&integers.net, tuned),
    };
    let network: Box<dyn OnChip> = Box::new(OnController { held, notes, check });
    let held_out = held_out
        .map(|all| figures(&model.original(all.steps), &*network, all.steps, all.from))
        .transpose()?;
    let tuned = figures(&original, &*network, tuned, 0)?;
    Ok(Brought { network, tuned, held_out, costs: vec![], reading: None })
}

/// Returns the inputs of the [`CHECKED`] consecutive steps in which most neurons fire if the network starts from rest.
/// Windows in which an output fires come before those in which none does.
fn liveliest<K: Number>(net: &Net<K>, inputs: &Trains) -> Trains {
    /// Largest number of windows that are tried.
    const TRIED: usize = 200;
    let stride = inputs.len().div_ceil(TRIED).max(1);
    let windows = inputs.windows(CHECKED.min(inputs.len())).step_by(stride);
    let lively = |window: &&[Vec<u16>]| {
        let spikes = |train: &Trains| train.iter().map(Vec::len).sum::<usize>();
        let counts = net.run(&window.to_vec()).fired.iter().map(spikes).collect::<Vec<_>>();
        (counts.last().copied().unwrap_or(0).min(1), counts.iter().sum::<usize>())
    };
    windows.max_by_key(lively).unwrap_or_default().to_vec()
}

impl OnController {
    /// Returns the number of bytes that the network takes in flash, for weights and neurons, and in RAM, for its state.
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

/// Returns the number of bytes that a network takes in flash and in RAM as `spikewire-network` stores it. `weight` is
/// the number of bytes of a weight.
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
        ram += count * if has_current { 8 } else { 4 } + list + 8;
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
        Ok(Ran { fired, potentials, clocks, lost: 0 })
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
