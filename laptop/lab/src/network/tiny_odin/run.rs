//! Runs a network on tinyODIN's model, which is exact to the clock cycle, through the driver of `spikewire-chips`.

use super::super::Trains;
use super::super::chip::{Ran, Stepped, refused};
use super::Quantised;
use crate::Result;
use silicon::Board;
use spikewire_chips::{Describe, Input, TinyOdin, TinyOdinInput};

/// Number of the chip's clock cycles in one SPI clock cycle.
pub(super) const RATIO: u32 = 4;

/// An iterator over the steps: each item lists the inputs that fire in a step.
pub(super) type Steps<'a> = dyn Iterator<Item = Result<Vec<u16>>> + 'a;

/// A function that is called with the result of each step.
pub(super) type See<'a> = dyn FnMut(Stepped) -> Result<()> + 'a;

/// Loads the network into the chip's model, and runs it step by step. A step sends a leak of all neurons if one is due
/// (once in [`steps_a_leak`](Quantised::steps_a_leak) steps), then the bias, then the inputs in order. The result of
/// each step is passed to `see` before the inputs of the next step are read. Returns the number of spikes that were
/// lost on their way into the chip.
///
/// # Errors
/// Returns an error if the chip or `see` refuses a step.
pub(super) fn follow(network: &Quantised, steps: &mut Steps<'_>, see: &mut See<'_>) -> Result<u32> {
    let board = Board::<silicon::TinyOdin>::new(RATIO, 1);
    board.pins().has_full_pin = true;
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).map_err(refused)?;
    gated.load(network, |_| ()).map_err(refused)?;
    let mut running = gated.run(&network.registers()).map_err(refused)?;

    let bias = network.has_bias.then(|| network.inputs() - 1);
    let leaks = network.leaks();
    for (step, inputs) in steps.enumerate() {
        let before = board.pins().chip.clocks;
        let mut fired = vec![vec![]; network.layers.len()];
        let mut on_output = |neuron: u8| {
            if let Some((layer, place)) = network.place(neuron.into()) {
                fired[layer].push(place as u16);
            }
        };
        let leak = leaks && step > 0 && step.is_multiple_of(network.steps_a_leak);
        let leak = leak.then_some(TinyOdinInput::LeakAll);
        let driven = bias.into_iter().chain(inputs?);
        let words = leak.into_iter().chain(driven.filter_map(|input| network.input(input)));
        for word in words {
            running.send(word, &mut on_output).map_err(refused)?;
        }
        // The model can be asked whether it is at rest; with a chip, one has to wait.
        while !board.pins().chip.is_idle() {
            running.poll(&mut on_output).map_err(refused)?;
        }
        see(Stepped { fired, clocks: board.pins().chip.clocks - before })?;
    }
    Ok(board.pins().chip.overflows)
}

/// Runs a network of `layers` layers on the inputs of all steps, and returns the results of all steps together.
/// `follow` is a function that runs the network step by step. Its first argument gives the inputs of each step. Its
/// second argument receives the result of each step.
///
/// # Errors
/// Returns an error if the chip refuses a call.
pub(super) fn run(
    layers: usize,
    inputs: &Trains,
    follow: impl FnOnce(&mut Steps<'_>, &mut See<'_>) -> Result<u32>,
) -> Result<Ran> {
    let mut fired = vec![Vec::with_capacity(inputs.len()); layers];
    let mut clocks = Vec::with_capacity(inputs.len());
    let lost = follow(&mut inputs.iter().cloned().map(Ok), &mut |step| {
        fired.iter_mut().zip(step.fired).for_each(|(layer, step)| layer.push(step));
        clocks.push(step.clocks);
        Ok(())
    })?;
    Ok(Ran { fired, potentials: vec![], clocks, lost, clipped: 0 })
}
