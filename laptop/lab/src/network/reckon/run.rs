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

/// Loads the network into the chip's model, and runs the network on the inputs of all steps. For the chip, the whole
/// run is one sample (an input sequence). A step has one or several ticks, and its inputs are sent before its first
/// tick. Additional inputs, such as those for biases, are sent before each tick.
///
/// On the chip, a spike needs one tick from each layer to the next, and one more tick from the last layer to the
/// outputs. The result does not contain these delays: as in double precision, a spike passes through all layers within
/// one step.
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
    let ticks = network.ticks.len();
    for tick in 0..inputs.len() * ticks + late {
        let before = board.pins().chip.clocks;
        if tick.is_multiple_of(ticks) {
            let mut sent: Vec<u16> = inputs.get(tick / ticks).unwrap_or(&silent).clone();
            sent.sort_unstable();
            let all = sent.len();
            sent.dedup();
            ran.lost += (all - sent.len()) as u32;
            for input in sent {
                sample.send(input as u8).map_err(refused)?;
            }
        }
        for input in network.beside(tick) {
            sample.send(input as u8).map_err(refused)?;
        }
        let answer = sample.step(ReckOnStep::default()).map_err(refused)?;
        let Some(ReckOnAnswer::Potentials(answer)) = answer else {
            return Err(ModelKind::Answer { answer }.into());
        };
        let clocks = board.pins().chip.clocks - before;
        match ran.clocks.last_mut() {
            Some(step) if !tick.is_multiple_of(ticks) => *step += clocks,
            _ if tick < inputs.len() * ticks => ran.clocks.push(clocks),
            _ => {}
        }
        for neuron in std::mem::take(&mut board.pins().chip.fired) {
            let Some((layer, place)) = network.places.neurons[usize::from(neuron)] else {
                return Err(ModelKind::StrayNeuron { neuron }.into());
            };
            if let Some(tick) = tick.checked_sub(layer + 1).filter(|_| layer < read_out)
                && let Some(step) = ran.fired[layer].get_mut(tick / ticks)
            {
                step.push(place as u16);
            }
        }
        let Some(tick) = tick.checked_sub(late).filter(|tick| tick.is_multiple_of(ticks)) else {
            continue;
        };
        let step = tick / ticks;
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
