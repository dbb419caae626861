//! A network to begin with: a neuron for each direction of each channel, that fires when its events come fast.

use embedded_hal::{delay::DelayNs, spi::SpiDevice};
use spikewire::{
    Event, Polarity,
    chip::{
        AerPort, ChipError, Describe, Inputs, Progress, TinyOdin, TinyOdinInput, TinyOdinNetwork,
        TinyOdinNeuron,
    },
};

/// Two for each of six channels: rises, then falls.
pub const NEURONS: usize = 12;

/// What an event adds to its neuron's potential.
const WEIGHT: i8 = 7;

/// An input and an output for each neuron. What the neurons fire is for us, not for the chip.
pub static NETWORK: TinyOdinNetwork<NEURONS, NEURONS, NEURONS> = TinyOdinNetwork {
    neurons: [TinyOdinNeuron { threshold: 20, leak: 1, ..TinyOdinNeuron::REST }; NEURONS],
    inputs: Inputs::Rows(diagonal(WEIGHT)),
    recurrent: &[],
    outputs: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11],
};

const fn diagonal(weight: i8) -> [[i8; NEURONS]; NEURONS] {
    let mut rows = [[0; NEURONS]; NEURONS];
    let mut n = 0;
    while n < NEURONS {
        rows[n][n] = weight;
        n += 1;
    }
    rows
}

/// Resets the chip, writes the network, reads it back and lets the chip run.
pub fn start<D: SpiDevice, P: AerPort>(
    chip: &mut TinyOdin<D, P>,
    delay: &mut impl DelayNs,
) -> Result<(), ChipError<D::Error, P::Error>> {
    let mut gated = chip.reset(delay)?;
    gated.load(&NETWORK, |_: Progress| ())?;
    gated.run(&NETWORK.registers()).map(drop)
}

/// The chip's word for an event of the bank.
pub fn input(event: Event) -> TinyOdinInput {
    let falls = u8::from(event.polarity == Polarity::Down);
    TinyOdinInput::Spike { pre: (event.address as u8) << 1 | falls }
}
