//! tinyODIN: 256 neurons, weights of 4 bits, thresholds looked at after every spike.

mod emit;
mod quantise;
mod run;

use super::chip::{Chip, OnChip, Ran, Stepped, Told, written};
use super::{Trained, Trains};
use crate::network::fault::{Result, bail};
use quantise::{Quantised, quantise};
use spikewire_chips::NetworkBytes;

/// The chip tinyODIN.
pub struct TinyOdin;

impl Chip for TinyOdin {
    fn name(&self) -> &'static str {
        "tinyodin"
    }

    fn quantise(
        &self,
        trained: &Trained,
        inputs: &Trains,
        fired: &[Trains],
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Box<dyn OnChip>> {
        if let Some(readout) = &trained.readout {
            bail!("{}: tinyODIN has no outputs that never fire; ReckOn has", readout.name);
        }
        Ok(Box::new(quantise(trained, inputs, fired, progress)?))
    }
}

impl OnChip for Quantised {
    fn run(&self, inputs: &Trains) -> Result<Ran> {
        run::run(self, inputs)
    }

    fn follow(
        &self,
        steps: &mut dyn Iterator<Item = Result<Vec<u16>>>,
        see: &mut dyn FnMut(Stepped) -> Result<()>,
    ) -> Result<u32> {
        run::follow(self, steps, see)
    }

    fn clipped(&self) -> Vec<usize> {
        let of_layer = |layer: &quantise::ChipLayer| layer.neurons.iter().map(|n| n.clipped).sum();
        self.layers.iter().map(of_layer).collect()
    }

    fn emit(&self, told: &Told) -> String {
        emit::emit(self, told)
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        Ok(written(|bytes| NetworkBytes::write(self, bytes))?)
    }

    fn notes(&self) -> Vec<String> {
        let leak = match self.steps_a_leak {
            _ if !self.leaks() => "no leaks",
            1 => "a leak every step",
            steps => &format!("a leak every {steps} steps"),
        };
        vec![format!("{} of the chip's 256 neurons; {leak}", self.count())]
    }

    fn dearest(&self) -> &'static str {
        "weights of 4 bits, and thresholds that are looked at after every spike"
    }

    fn loss(&self) -> &'static str {
        "the chip's queue of 128 was full"
    }
}
