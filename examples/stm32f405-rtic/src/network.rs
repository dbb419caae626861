//! A network to begin with: a neuron for each direction of each channel, that fires when its events come fast.

use embedded_hal::{delay::DelayNs, spi::SpiDevice};
use spikewire::{
    Event, Polarity,
    chip::{AerPort, ChipError, TinyOdin, TinyOdinInput},
};

/// Two for each of six channels: rises, then falls.
pub const NEURONS: usize = 12;

const OPEN_LOOP: u16 = 1;
const OUTPUT_SOURCE: u16 = 2;
const HIGHEST_NEURON: u16 = 3;

/// What an event adds to its neuron's potential, what a time step takes, and where it fires.
const WEIGHT: u8 = 7;
const LEAK: u32 = 1;
const THRESHOLD: u32 = 20;

/// Resets the chip and writes the network; all that can be read back is.
pub fn load<D: SpiDevice, P: AerPort>(
    chip: &mut TinyOdin<D, P>,
    delay: &mut impl DelayNs,
) -> Result<(), ChipError<D::Error, P::Error>> {
    chip.reset(delay)?;
    chip.gate()?;
    chip.configure(OPEN_LOOP, 1)?; // what the neurons fire is for us, not for the chip
    chip.configure(OUTPUT_SOURCE, 0)?;
    chip.configure(HIGHEST_NEURON, NEURONS as u32 - 1)?;
    for post in 0..NEURONS as u8 {
        let parameters = LEAK << 24 | THRESHOLD << 12;
        for (byte, value) in (0..).zip(parameters.to_le_bytes()) {
            chip.program_neuron(post, byte, value)?;
        }
        for pre in 0..NEURONS as u8 {
            chip.program_synapse(pre, post, if pre == post { WEIGHT } else { 0 })?;
        }
    }
    chip.run()
}

/// The chip's word for an event of the bank.
pub fn input(event: Event) -> TinyOdinInput {
    let falls = u8::from(event.polarity == Polarity::Down);
    TinyOdinInput::Spike { pre: (event.address as u8) << 1 | falls }
}
