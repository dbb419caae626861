//! The interface of a chip onto which a network can be brought.

use super::costs::Cost;
use super::{ReckOn, TinyOdin, Trained, Trains};
use crate::network::fault::{Result, bail, fault};
use spikewire_chips::ChipError;
use std::fmt::{Debug, Display};

/// A chip that a trained network can be brought onto.
pub trait Chip: Sync {
    /// Returns the name by which users choose the chip.
    fn name(&self) -> &'static str;

    /// Finds the numbers with which the chip follows the network best. `fired` is the spikes in double precision, by
    /// layer and step. Calls `progress` with the number of parts of the search that are done, and the number in all.
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

/// When a chip's neurons compare with their thresholds, for chips that leave the choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compare {
    /// After each spike, as the chip does by itself.
    Spike,
    /// Once a step, as in training; additional events make the chip do so.
    Step,
}

/// All chips onto which networks can be brought.
pub static CHIPS: [&dyn Chip; 2] = [&TinyOdin, &ReckOn];

/// A network as a chip holds it.
pub trait OnChip {
    /// Loads the network into the chip's model with the driver of `spikewire-chips`, and runs it.
    ///
    /// # Errors
    /// Returns an error if the chip refuses a call.
    fn run(&self, inputs: &Trains) -> Result<Ran>;

    /// Loads the network into the chip's model, and runs it on steps as they arrive. Each result is passed to `see`
    /// before the next step is read, so that later inputs may depend on it. Returns the number of spikes lost.
    ///
    /// # Errors
    /// Returns an error if the chip or `see` refuses a step, or if the chip's outputs come steps later.
    fn follow(
        &self,
        _steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        _see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        bail!("this chip's outputs come steps later: only tinyODIN answers step by step here")
    }

    /// Returns for each layer the number of weights that exceeded the chip's range; then, if outputs have potentials,
    /// their number.
    fn clipped(&self) -> Vec<usize>;

    /// Writes Rust source, which compiles without `std` if `spikewire-chips` has its feature `embedded-hal`.
    fn emit(&self, remarks: &Remarks) -> String;

    /// Returns the network as bytes, which the driver loads at run time.
    ///
    /// # Errors
    /// Returns an error if the chip does not accept the network.
    fn bytes(&self) -> Result<Vec<u8>>;

    /// Returns notes on the network's size on the chip, and on what had to be changed, a line each.
    fn notes(&self) -> Vec<String>;

    /// Returns the parts of the chip's arithmetic that change the network, and whose effect can be measured one by one.
    fn costs(&self) -> Vec<Cost>;

    /// Returns the reason that spikes get lost on their way into the chip.
    fn loss(&self) -> &'static str;

    /// Describes the duration of a step, given its mean and largest number of clocks.
    fn effort(&self, mean: f64, most: u64) -> String {
        format!("a step takes the chip {mean:.0} clocks, {most} at most")
    }
}

/// The result of a run on the chip.
pub struct Ran {
    /// The neurons that fired, by layer and step.
    pub fired: Vec<Trains>,
    /// The outputs' potentials by step, in the units of the training; empty if the outputs are the last layer's spikes.
    pub potentials: Vec<Vec<f64>>,
    /// Number of the chip's clocks, for each step.
    pub clocks: Vec<u64>,
    /// Number of spikes lost on their way into the chip.
    pub lost: u32,
}

/// The result of a step on the chip.
pub struct Stepped {
    /// The neurons that fired, by layer.
    pub fired: Vec<Vec<u16>>,
    /// Number of the chip's clocks.
    pub clocks: u64,
}

/// Remarks for the readers of the generated file.
pub struct Remarks {
    /// Where the network comes from.
    pub source: String,
    /// What its inputs mean.
    pub inputs: String,
    /// Length of a step in µs, if it is known.
    pub step_us: Option<f64>,
}

impl Remarks {
    /// Returns a comma and the duration of `steps` steps in the recording, if it is known.
    pub(super) fn micros(&self, steps: usize) -> String {
        self.step_us.map_or(String::new(), |step| {
            format!(", {:.0} µs in the recording", step * steps as f64)
        })
    }
}

/// Formats the items of an array, a line each.
pub(super) fn lines(items: impl Iterator<Item = String>) -> String {
    items.fold(String::new(), |all, item| all + "        " + &item + ",\n")
}

/// Returns the bytes that `write` puts into a buffer with room for the largest network.
pub(super) fn written<E>(write: impl FnOnce(&mut [u8]) -> Result<usize, E>) -> Result<Vec<u8>, E> {
    /// More bytes than any network needs on any chip.
    const LARGEST: usize = 256 * 1024;
    let mut bytes = vec![0; LARGEST];
    let length = write(&mut bytes)?;
    bytes.truncate(length);
    Ok(bytes)
}

/// Formats numbers, separated by commas.
pub(super) fn list(numbers: impl Iterator<Item = impl Display>) -> String {
    numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// Converts the error of a driver that runs on the model.
pub(super) fn refused<B: Debug, P: Debug>(error: &ChipError<B, P>) -> crate::Error {
    fault(format!("the chip's model: {error}"))
}
