//! Brings networks onto the chip tinyODIN, which has 256 neurons and weights of 4 bits, and which compares potentials
//! with thresholds after every spike.

mod climb;
mod emit;
mod gated;
mod quantise;
mod run;

use super::bring::holds;
use super::chip::{Chip, Compare, OnChip, Ran, Remarks, Stepped, written};
use super::costs::Cost;
use super::{Trained, Trains};
use crate::Spot;
use crate::network::fault::{FitKind, Result};
use quantise::{Quantised, quantise};
use spikewire_chips::NetworkBytes;

/// The chip tinyODIN, as a target for trained networks.
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
        compare: Option<Compare>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Box<dyn OnChip>> {
        if let Some(readout) = &trained.readout {
            return Err(FitKind::NoReadout.at(Spot::Part(readout.name.clone())));
        }
        if compare == Some(Compare::Spike) {
            return Ok(Box::new(quantise(trained, inputs, fired, progress)?));
        }
        // Searches on the first part of the recording, and judges the results on the rest.
        let part = inputs.len() * FOUND.0 / FOUND.1;
        let found = inputs[..part].to_vec();
        let found_fired: Vec<Trains> = fired.iter().map(|all| all[..part].to_vec()).collect();
        let gated = gated::quantise(trained, &found, &found_fired, progress);
        let mut all: Vec<(Trains, Box<dyn OnChip>)> = Vec::new();
        for gated in gated {
            all.push((gated.outputs(inputs), Box::new(gated)));
        }
        if compare.is_none() {
            match quantise(trained, &found, &found_fired, progress) {
                Ok(plain) => {
                    let outputs = plain.run(inputs)?.fired.pop().unwrap_or_default();
                    all.push((outputs, Box::new(plain)));
                }
                Err(error) if all.is_empty() => return Err(error),
                Err(_) => {}
            }
        }
        let original = fired.last().map_or(&[][..], |fired| &fired[part..]);
        let mut best: Option<(f64, Box<dyn OnChip>)> = None;
        for (outputs, network) in all {
            let holds = holds(original, &outputs[part..]);
            if best.as_ref().is_none_or(|(most, _)| holds > *most) {
                best = Some((holds, network));
            }
        }
        let (_, best) = best.ok_or(FitKind::NoRoomToCompare)?;
        Ok(best)
    }
}

/// Share of the recording on which the search for parameters runs, as numerator and denominator. This part is the
/// beginning of the recording. The rest of the recording is used to compare the networks that were found.
const FOUND: (usize, usize) = (3, 4);

impl OnChip for Quantised {
    fn run(&self, inputs: &Trains) -> Result<Ran> {
        run::run(self.layers.len(), inputs, |steps, see| run::follow(self, steps, see))
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

    fn emit(&self, remarks: &Remarks) -> String {
        emit::emit(self, remarks)
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

    fn costs(&self) -> Vec<Cost> {
        vec![Cost::Order, Cost::Leak, Cost::Weights { largest: 7.0 }]
    }

    fn loss(&self) -> &'static str {
        "the chip's queue of 128 was full"
    }
}
