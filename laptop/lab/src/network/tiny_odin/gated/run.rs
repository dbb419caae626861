//! Runs a network whose neurons compare their potentials with their thresholds once a step. Runs it on tinyODIN's
//! model, which is exact to the clock cycle, through the driver of `spikewire-chips`.

use super::super::super::chip::{Stepped, refused};
use super::super::run::{self, RATIO};
use super::Gated;
use crate::network::fault::Result;
use silicon::Board;
use spikewire_chips::{Describe, Input, Steps, StepsLayer, StepsState, TinyOdin, TinyOdinInput};

impl Gated {
    /// Describes the sequence of events in a step as [`Steps`], the type that the chip's driver takes. Calls `see` with
    /// this description, and returns the result of `see`.
    pub(super) fn with_steps<T>(&self, see: impl FnOnce(&Steps) -> T) -> T {
        let layers = self.layers.iter();
        let layers: Vec<StepsLayer> = layers
            .map(|layer| StepsLayer { neurons: layer.neurons.len() as u16, loops: layer.loops })
            .collect();
        let leaks: Vec<&[u16]> = self.shape.leaks.iter().map(Vec::as_slice).collect();
        let neurons = self.layers.iter().flat_map(|layer| &layer.neurons);
        let own_leaks: Vec<u16> = neurons.map(|neuron| neuron.own_leaks).collect();
        see(&Steps {
            inputs: self.inputs as u16,
            has_bias: self.shape.has_bias,
            rows: self.shape.rows,
            layers: &layers,
            rungs: self.shape.rungs(),
            leaks: &leaks,
            lift: self.shape.lift,
            own_leaks: &own_leaks,
        })
    }
}

/// Loads the network into the chip's model, and runs it step by step. Passes the result of each step to `see`. Returns
/// the number of spikes that were lost on their way into the chip.
///
/// # Errors
/// Returns an error if the chip or `see` refuses a step.
pub(super) fn follow(
    network: &Gated,
    inputs: &mut run::Steps<'_>,
    see: &mut run::See<'_>,
) -> Result<u32> {
    network.with_steps(|steps| {
        let board = Board::<silicon::TinyOdin>::new(RATIO, 1);
        board.pins().has_full_pin = true;
        let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
        let mut gated = chip.reset(&mut board.clone()).map_err(refused)?;
        gated.load(network, |_| ()).map_err(refused)?;
        let mut running = gated.run(&network.registers()).map_err(refused)?;
        let mut state = StepsState::REST;
        for inputs in inputs {
            let before = board.pins().chip.clocks;
            let mut fired = vec![vec![]; network.layers.len()];
            let on_output = |neuron: u8| {
                if let Some((layer, place, _)) = network.at(neuron.into()) {
                    fired[layer].push(place as u16);
                }
            };
            running.step(steps, &mut state, inputs?, on_output).map_err(refused)?;
            while !board.pins().chip.is_idle() {
                running.poll(|_| ()).map_err(refused)?;
            }
            // Sorts the neurons by number, as in double precision.
            for layer in &mut fired {
                layer.sort_unstable();
            }
            see(Stepped { fired, clocks: board.pins().chip.clocks - before })?;
        }
        Ok(board.pins().chip.overflows)
    })
}
