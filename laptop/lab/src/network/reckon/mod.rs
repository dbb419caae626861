//! Brings networks onto the chip `ReckOn`, which has 256 neurons with recurrent connections, 16 leaky outputs, and
//! weights of 8 bits.

mod emit;
mod part;
mod place;
mod quantise;
mod recorded;
mod round;
mod run;

use super::chip::{Chip, Compare, OnChip, Ran, Remarks, written};
use super::costs::Cost;
use super::{Reset, Trained, Trains};
use crate::Result;
use quantise::{Quantised, quantise};
use spikewire_chips::{DescribeReckOn, ReckOnBytes};

/// The chip `ReckOn`, as a target for trained networks.
pub struct ReckOn;

impl Chip for ReckOn {
    fn name(&self) -> &'static str {
        "reckon"
    }

    fn quantise(
        &self,
        trained: &Trained,
        inputs: &Trains,
        fired: &[Trains],
        _compare: Option<Compare>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Box<dyn OnChip>> {
        // The chip subtracts a threshold one step after the spike, after the leak.
        let quantised = |trained: Trained| quantise(&trained.late(), inputs, fired, progress);
        match quantised(trained.clone()) {
            Err(error) if trained.layers.iter().any(|l| l.reset == Reset::SubtractNoDelay) => {
                let mut network = quantised(trained.clone().reset_by_chip())?;
                network.no_room = Some(error.to_string());
                Ok(Box::new(network))
            }
            network => Ok(Box::new(network?)),
        }
    }
}

/// Number of SPI clock pulses in a transfer of a header and one 32-bit word.
const FRAME: u32 = 64;

impl OnChip for Quantised {
    fn run(&self, inputs: &Trains) -> Result<Ran> {
        run::run(self, inputs)
    }

    fn clipped(&self) -> Vec<usize> {
        self.changes.iter().map(|change| change.clipped).collect()
    }

    fn emit(&self, remarks: &Remarks) -> String {
        emit::emit(self, remarks)
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        Ok(written(|bytes| ReckOnBytes::write(self, bytes))?)
    }

    fn notes(&self) -> Vec<String> {
        let [inputs, neurons, outputs] =
            [self.inputs(), self.neurons(), self.outputs()].map(u32::from);
        let words = (inputs + 256) * neurons.div_ceil(4) + 256 * outputs.div_ceil(4) + 512;
        let mut notes = vec![format!(
            "{neurons} of the chip's 256 neurons, {inputs} of its 256 inputs, {outputs} of its 16 outputs; {} bytes \
             of weights; {words} words, written and read back in {:.2} s at 1 MHz",
            inputs * neurons + neurons * neurons + neurons * outputs,
            f64::from(2 * words * FRAME) * 1e-6,
        )];
        notes.push(
            "layer: weights, of them clipped, and become 0; change of the weights".to_owned(),
        );
        for change in &self.changes {
            notes.push(format!(
                "{}: {}, {}, {}; {:.2} %",
                change.name,
                change.weights,
                change.clipped,
                change.vanished,
                100.0 * change.relative()
            ));
        }
        if let Some(peak) = self.output_peak {
            notes.push(format!(
                "outputs reach {:.0} % of their 16 bits in the recording; beyond 100 %, `run` returns `Clipped`",
                100.0 * peak
            ));
        }
        if self.places.has_parts() {
            notes.push(
                "a reset without a delay takes three of the chip's neurons for each neuron of the layer, four in a \
                 recurrent layer"
                    .to_owned(),
            );
        }
        if let Some(error) = &self.no_room {
            notes.push(format!(
                "warning: resets without a delay, which take several of the chip's neurons for each neuron, do not fit, \
                 and are the chip's own: {error}"
            ));
        }
        if self.shared_keeps.0 > 0 {
            let (count, most) = self.shared_keeps;
            notes.push(format!(
                "warning: {count} neurons leak otherwise than trained, by up to {most:.4} of the potential a step: \
                 neurons keep 0.875 a tick at least, and two share a leak"
            ));
        }
        notes
    }

    fn costs(&self) -> Vec<Cost> {
        vec![Cost::Weights { largest: 127.0 }]
    }

    fn resets_as(&self, reset: Reset) -> bool {
        match reset {
            Reset::ToValueHeld => false,
            Reset::SubtractNoDelay => self.places.has_parts(),
            _ => true,
        }
    }

    fn loss(&self) -> &'static str {
        "an input that fires several times in a step counts once"
    }
}
