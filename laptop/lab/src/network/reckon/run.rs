//! Runs a network on `ReckOn`'s model, which is exact to the clock cycle, through the driver of `spikewire-chips`.

use super::super::Trains;
use super::super::chip::{Ran, refused};
use super::Quantised;
use super::part::{Part, Seat};
use super::quantise::Tick;
use crate::network::fault::{ModelKind, Result};
use silicon::reckon::{Board, Port, Spi};
use spikewire_chips::{ChipError, ReckOn, ReckOnSettings, ReckOnStepsState, ReckOnTick};

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
        clipped: 0,
    };
    // The spikes of inner layers are taken from the model. Those of the last layer come from the chip's answers, unless
    // the answers are potentials.
    let read_out = if network.unit.is_some() { layers } else { layers - 1 };
    let late = network.late();
    board.pins().chip.fired.clear();
    let ticks: Vec<ReckOnTick> =
        network.ticks.iter().map(|Tick { always, raises }| ReckOnTick { always, raises }).collect();
    let steps = network.steps(&ticks);
    let mut state = ReckOnStepsState::REST;
    let silent = vec![];
    for step in 0..inputs.len() + late.div_ceil(ticks.len()) {
        let before = board.pins().chip.clocks;
        let mut sent: Vec<u16> = inputs.get(step).unwrap_or(&silent).clone();
        sent.sort_unstable();
        let all = sent.len();
        sent.dedup();
        ran.lost += (all - sent.len()) as u32;
        let values = match sample.run(&steps, &mut state, sent) {
            Ok(values) => values,
            Err(ChipError::Clipped { .. }) => {
                ran.clipped += 1;
                state.values()
            }
            Err(error) => return Err(refused(error)),
        };
        if step < inputs.len() {
            ran.clocks.push(board.pins().chip.clocks - before);
        }
        for neuron in std::mem::take(&mut board.pins().chip.fired) {
            let Some(Seat { layer, part, neuron: place }) =
                network.places.neurons[usize::from(neuron)]
            else {
                return Err(ModelKind::StrayNeuron { neuron }.into());
            };
            // A layer fires only at its own tick, unless a gate is too weak.
            if let Some(step) = step.checked_sub((layer + 1) / ticks.len())
                && part == Part::Main
                && layer < read_out
                && let Some(step) = ran.fired[layer].get_mut(step)
            {
                step.push(place as u16);
            }
        }
        let Some(step) = step.checked_sub(late / ticks.len()).filter(|step| *step < inputs.len())
        else {
            continue;
        };
        let values = &values[..network.outputs[0].len()];
        if network.unit.is_some() {
            ran.potentials.push(values.iter().map(|value| f64::from(*value)).collect());
        } else {
            let fired = (0..).zip(values).filter(|(_, value)| **value > 0.0);
            ran.fired[layers - 1][step] = fired.map(|(output, _)| output).collect();
        }
    }
    // Sorts the neurons by number, as in double precision.
    ran.fired.iter_mut().flatten().for_each(|step| step.sort_unstable());
    Ok(ran)
}
