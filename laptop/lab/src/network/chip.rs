//! The trait of a chip onto which a network can be brought.

use super::costs::Cost;
use super::{ReckOn, TinyOdin, Trained, Trains};
use crate::network::fault::{Result, bail, fault};
use spikewire_chips::ChipError;
use std::fmt::{Debug, Display};

/// A chip that a trained network can be brought onto.
pub trait Chip: Sync {
    /// The name by which the chip is asked for.
    fn name(&self) -> &'static str;

    /// Finds what the chip should hold so that it does what the network does. `fired` is who fires in training, by layer
    /// and step. Calls `progress` with the parts of the search that are done and those in all.
    ///
    /// # Errors
    /// The network does not fit the chip.
    fn quantise(
        &self,
        trained: &Trained,
        inputs: &Trains,
        fired: &[Trains],
        compare: Option<Compare>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Box<dyn OnChip>>;
}

/// When neurons of a chip compare with their thresholds, of chips that leave the choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compare {
    /// After each spike, as the chip has it.
    Spike,
    /// Once a step, as in training: other events see to it.
    Step,
}

/// Every chip that networks can be brought onto.
pub static CHIPS: [&dyn Chip; 2] = [&TinyOdin, &ReckOn];

/// A network as a chip holds it.
pub trait OnChip {
    /// Loads the network into the chip's model with the crate's driver, and runs it.
    ///
    /// # Errors
    /// The chip refuses something.
    fn run(&self, inputs: &Trains) -> Result<Ran>;

    /// Loads the network into the chip's model, and runs it on steps as they come: `see` is told what came of each before
    /// the next is taken, so that what drives the network may depend on what it does. Returns the number of spikes lost.
    ///
    /// # Errors
    /// The chip or `see` refuses something, or the chip's outputs come steps later.
    fn follow(
        &self,
        _steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        _see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        bail!("this chip's outputs come steps later: only tinyODIN answers step by step here")
    }

    /// For each layer, the number of weights that were larger than the chip's; then that of the outputs, if they have
    /// potentials.
    fn clipped(&self) -> Vec<usize>;

    /// Writes a file of Rust, which compiles without `std` beside the crate's feature `embedded-hal`.
    fn emit(&self, told: &Told) -> String;

    /// The network as bytes, which the crate's driver loads at run time.
    ///
    /// # Errors
    /// Returns an error if the chip does not take the network.
    fn bytes(&self) -> Result<Vec<u8>>;

    /// Notes on the network's size on the chip, and on what had to change: a line each.
    fn notes(&self) -> Vec<String>;

    /// The parts of the chip's arithmetic that change a network, of which each can be measured alone.
    fn costs(&self) -> Vec<Cost>;

    /// The reason that spikes get lost on their way into the chip.
    fn loss(&self) -> &'static str;

    /// What a step takes, of the figures' clocks.
    fn effort(&self, mean: f64, most: u64) -> String {
        format!("a step takes the chip {mean:.0} clocks, {most} at most")
    }
}

/// The result of a run on the chip.
pub struct Ran {
    /// The neurons that fired, by layer and step.
    pub fired: Vec<Trains>,
    /// The outputs' potentials by step, in the units of the training; empty if the last layer's spikes are the outputs.
    pub potentials: Vec<Vec<f64>>,
    /// The chip's clocks, by step.
    pub clocks: Vec<u64>,
    /// How many spikes got lost on their way into the chip.
    pub lost: u32,
}

/// The result of a step on the chip.
pub struct Stepped {
    /// The neurons that fired, by layer.
    pub fired: Vec<Vec<u16>>,
    /// The chip's clocks.
    pub clocks: u64,
}

/// Remarks for a reader of the file.
pub struct Told {
    /// The network's source.
    pub source: String,
    /// The meaning of its inputs.
    pub inputs: String,
    /// How long a step is in µs, if that is known.
    pub step_us: Option<f64>,
}

impl Told {
    /// How long so many steps are in the recording, if that is known, behind a comma.
    pub(super) fn micros(&self, steps: usize) -> String {
        self.step_us.map_or(String::new(), |step| {
            format!(", {:.0} µs in the recording", step * steps as f64)
        })
    }
}

/// The items of an array, a line each.
pub(super) fn lines(items: impl Iterator<Item = String>) -> String {
    items.fold(String::new(), |all, item| all + "        " + &item + ",\n")
}

/// The bytes that `write` puts in front of room for the largest network.
pub(super) fn written<E>(write: impl FnOnce(&mut [u8]) -> Result<usize, E>) -> Result<Vec<u8>, E> {
    /// More bytes than any network takes on any chip.
    const LARGEST: usize = 256 * 1024;
    let mut bytes = vec![0; LARGEST];
    let length = write(&mut bytes)?;
    bytes.truncate(length);
    Ok(bytes)
}

/// Numbers with commas between.
pub(super) fn list(numbers: impl Iterator<Item = impl Display>) -> String {
    numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// The error of a driver on the model.
pub(super) fn refused<B: Debug, P: Debug>(error: &ChipError<B, P>) -> crate::Error {
    fault(format!("the chip's model: {error}"))
}
