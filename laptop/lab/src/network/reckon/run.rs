//! Runs a network on `ReckOn`'s model, which is exact to the clock cycle, through the driver of `spikewire-chips`.

use super::super::Trains;
use super::super::chip::{Ran, refused};
use super::Quantised;
use super::quantise::FIRED;
use crate::network::fault::{ModelKind, Result};
use silicon::reckon::{Board, Port, Spi};
use spikewire_chips::{ReckOn, ReckOnAnswer, ReckOnSettings, ReckOnStep};

type Chip = ReckOn<Spi, Port>;

/// Number of the chip's clock cycles in one SPI clock cycle.
const RATIO: u32 = 10;

/// Loads the network into the chip's model and runs the network on all inputs. All steps belong to one sample of
/// the chip. Each step sends its input spikes, the bias and a tick.
///
/// On the chip, the first layer fires at the tick of the next step. Each further layer fires one tick after the layer
/// before. The outputs show the last layer's spikes one tick after that layer fires. These delays are removed from the
/// result: as in double precision, a spike passes through all layers within one step.
///
/// # Errors
/// Returns an error if the chip refuses a call.
pub(super) fn run(network: &Quantised, inputs: &Trains) -> Result<Ran> {
    let board = Board::new(RATIO, 1);
    let mut chip = Chip::new(board.spi(), board.port(), Chip::MAX_CLOCKS);
    let mut programmed = chip.reset(&mut board.clone()).map_err(refused)?;
    programmed.load(network, |_| ()).map_err(refused)?;
    let started = programmed.run(&ReckOnSettings::POTENTIALS).map_err(refused)?;
    let mut sample = started.begin().map_err(refused)?;

    let layers = network.layers.len();
    let mut ran = Ran {
        fired: vec![vec![vec![]; inputs.len()]; layers],
        potentials: vec![],
        clocks: vec![],
        lost: 0,
    };
    // The spikes of inner layers are taken from the model. Those of the last layer come from the chip's answers, unless
    // the answers are potentials.
    let read_out = if network.unit.is_some() { layers } else { layers - 1 };
    let late = network.late();
    board.pins().chip.fired.clear();
    let silent = vec![];
    for step in 0..inputs.len() + late {
        let before = board.pins().chip.clocks;
        let mut sent: Vec<u16> = inputs.get(step).unwrap_or(&silent).clone();
        sent.sort_unstable();
        let all = sent.len();
        sent.dedup();
        ran.lost += (all - sent.len()) as u32;
        for input in sent.into_iter().chain(network.bias.map(|bias| bias as u16)) {
            sample.send(input as u8).map_err(refused)?;
        }
        let answer = sample.step(ReckOnStep::default()).map_err(refused)?;
        let Some(ReckOnAnswer::Potentials(answer)) = answer else {
            return Err(ModelKind::Answer { answer }.into());
        };
        if step < inputs.len() {
            ran.clocks.push(board.pins().chip.clocks - before);
        }
        for neuron in std::mem::take(&mut board.pins().chip.fired) {
            let Some((layer, place)) = network.places.neurons[usize::from(neuron)] else {
                return Err(ModelKind::StrayNeuron { neuron }.into());
            };
            if let Some(step) = step.checked_sub(layer + 1).filter(|_| layer < read_out)
                && let Some(step) = ran.fired[layer].get_mut(step)
            {
                step.push(place as u16);
            }
        }
        let Some(step) = step.checked_sub(late) else { continue };
        let outputs = &answer[..network.outputs[0].len()];
        if let Some(unit) = network.unit {
            ran.potentials.push(outputs.iter().map(|&answer| f64::from(answer) * unit).collect());
        } else {
            let fired = (0..).zip(outputs).filter(|(_, answer)| *answer >> FIRED & 1 == 1);
            ran.fired[layers - 1][step] = fired.map(|(output, _)| output).collect();
        }
    }
    // Sorts the neurons by number, as in double precision.
    ran.fired.iter_mut().flatten().for_each(|step| step.sort_unstable());
    Ok(ran)
}
