//! The interface of a target (a chip, or the flight controller) onto which a trained network can be brought.

use super::costs::Cost;
use super::{ReckOn, Reset, TinyOdin, Trained, Trains};
use crate::network::fault::{FitKind, ModelKind, Result};
use spikewire_chips::ChipError;
use std::fmt::Display;

/// A chip that a trained network can be brought onto.
pub trait Chip: Sync {
    /// Returns the name by which the command line selects the chip, such as `tinyodin`.
    fn name(&self) -> &'static str;

    /// Searches for the chip's parameters with which the spikes of each layer are nearest to those in `fired`. `inputs`
    /// are the network's input spikes by step. `compare` selects when the chip's neurons compare their potentials with
    /// their thresholds; if `compare` is `None`, this function chooses. Calls `progress` with the number of finished
    /// parts of the search and the total number of parts.
    ///
    /// # Errors
    /// Returns an error if the network does not fit the chip.
    fn quantise(
        &self,
        trained: &Trained,
        inputs: &Trains,
        fired: &[Trains],
        compare: Option<Compare>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Box<dyn OnChip>>;
}

/// The time at which a chip's neurons compare their potentials with their thresholds. A chip that supports just one
/// time ignores this choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compare {
    /// After each spike that arrives at the neuron: the chip's default.
    Spike,
    /// Once in each time step, as in training. The driver sends extra events to the chip for this purpose.
    Step,
}

/// All chips onto which networks can be brought.
pub static CHIPS: [&dyn Chip; 2] = [&TinyOdin, &ReckOn];

/// A network in the form that a chip or the flight controller stores.
pub trait OnChip {
    /// Loads the network into the chip's model with the driver of `spikewire-chips`, and runs it on the input spikes of
    /// all steps.
    ///
    /// # Errors
    /// Returns an error if the chip refuses a call.
    fn run(&self, inputs: &Trains) -> Result<Ran>;

    /// Loads the network into the chip's model, and runs it step by step. The result of each step is passed to `see`
    /// before the inputs of the next step are read, so that later inputs may depend on the result. Returns the number
    /// of spikes that were lost on their way into the chip.
    ///
    /// # Errors
    /// Returns an error if the chip or `see` refuses a step. Also returns an error if the chip's outputs for a step
    /// appear one or more steps later.
    fn follow(
        &self,
        _steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        _see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        Err(FitKind::LateOutputs.into())
    }

    /// Returns, for each layer, the number of its weights that exceeded the chip's range and were clipped. If the
    /// outputs are potentials instead of spikes, one more entry counts the clipped weights of the outputs.
    fn clipped(&self) -> Vec<usize>;

    /// Returns Rust source that defines the network. The source compiles without `std` if `spikewire-chips` has its
    /// feature `embedded-hal`.
    fn emit(&self, remarks: &Remarks) -> String;

    /// Returns the network as bytes, which the driver can load at run time.
    ///
    /// # Errors
    /// Returns an error if the chip does not accept the network.
    fn bytes(&self) -> Result<Vec<u8>>;

    /// Returns remarks for the user, one line each: on the network's size on the chip, and on the changes that
    /// quantising made to the network.
    fn notes(&self) -> Vec<String>;

    /// Returns the parts of the chip's arithmetic, such as rounded weights, whose effect on the spikes can be measured
    /// one by one.
    fn costs(&self) -> Vec<Cost>;

    /// Returns whether neurons that were trained with this reset have it in this network. Otherwise, they have the most
    /// similar reset of the chip.
    fn resets_as(&self, reset: Reset) -> bool {
        !matches!(reset, Reset::ToValueHeld | Reset::SubtractNoDelay)
    }

    /// Returns a text for the user that says why spikes may be lost on their way into the chip.
    fn loss(&self) -> &'static str;

    /// Returns a text for the user on how long a step takes. `mean` and `most` are the mean and the largest number of
    /// clock cycles in a step.
    fn effort(&self, mean: f64, most: u64) -> String {
        format!("a step takes the chip {mean:.0} clocks, {most} at most")
    }
}

/// The result of running a network on the chip's model, over all steps.
pub struct Ran {
    /// The neurons that fired, by layer, then by step.
    pub fired: Vec<Trains>,
    /// The outputs' potentials by step, in the units of the trained network; empty if the outputs are spikes.
    pub potentials: Vec<Vec<f64>>,
    /// For each step, the number of clock cycles that the chip takes. On the flight controller: the number of weight
    /// additions in the step.
    pub clocks: Vec<u64>,
    /// Number of spikes that were lost on their way into the chip.
    pub lost: u32,
    /// Number of steps in which the potential of an output reached the end of the chip's range.
    pub clipped: u32,
}

/// The result of one step on the chip's model.
pub struct Stepped {
    /// The neurons that fired in the step, by layer.
    pub fired: Vec<Vec<u16>>,
    /// Number of clock cycles that the step took on the chip. On the flight controller: the number of weight additions
    /// in the step.
    pub clocks: u64,
}

/// Facts about a network that the generated source repeats in its comments.
pub struct Remarks {
    /// Name of the file that the network comes from.
    pub source: String,
    /// Description of the network's inputs.
    pub inputs: String,
    /// Duration of a step in the recording, in µs; `None` if it is not known.
    pub step_us: Option<f64>,
}

impl Remarks {
    /// Returns the duration of `steps` steps as text that begins with a comma; empty if the duration of a step is not
    /// known.
    pub(super) fn micros(&self, steps: usize) -> String {
        self.step_us.map_or(String::new(), |step| {
            format!(", {:.0} µs in the recording", step * steps as f64)
        })
    }
}

/// Formats items as the lines of an array in generated source, one item in each line.
pub(super) fn lines(items: impl Iterator<Item = String>) -> String {
    items.fold(String::new(), |all, item| all + "        " + &item + ",\n")
}

/// Calls `write` with a buffer that has room for the largest network; returns the bytes written.
pub(super) fn written<E>(write: impl FnOnce(&mut [u8]) -> Result<usize, E>) -> Result<Vec<u8>, E> {
    /// Size of the buffer in bytes. No network for any of the chips takes more bytes.
    const LARGEST: usize = 256 * 1024;
    let mut bytes = vec![0; LARGEST];
    let length = write(&mut bytes)?;
    bytes.truncate(length);
    Ok(bytes)
}

/// Formats numbers (or other items) with commas between them.
pub(super) fn list(numbers: impl Iterator<Item = impl Display>) -> String {
    numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// Wraps an error that a chip's driver returned while a network ran on the chip's model.
pub(super) fn refused<B, P>(error: ChipError<B, P>) -> crate::Error
where
    ChipError<B, P>: std::error::Error + Send + Sync + 'static,
{
    ModelKind::Refused { error: Box::new(error) }.into()
}
