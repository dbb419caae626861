//! Drivers for neuromorphic chips.
//!
//! | chip | spikes in | spikes out | how it was checked |
//! |---|---|---|---|
//! | [`TinyOdin`], [`Odin`] | parallel bus, 4-phase handshake | the same | bytes and words of the RTL in simulation; models of the chips, clock by clock |
//! | [`ReckOn`] | parallel bus, 4-phase handshake, a pin for the time step | labels or potentials over a bus of bytes | a model, clock by clock, equal to the RTL in simulation |
//! | [`Akd1500`] | a window onto memory, over SPI | the same | bytes of the vendor's library, and a model of its transport: every byte lost, doubled, flipped |
//! | [`Xylo`] | counts in registers | a status register | the registers in the vendor's sources |
//!
//! None of these drivers has run on hardware. No bus has a checksum. All that can be read back is read back. The
//! configuration registers of tinyODIN and ODIN cannot be read back: a check of the bus follows each. The registers of
//! Xylo are not read back.
//!
//! # A network on tinyODIN
//!
//! A network that is constant data is loaded and verified, then fed with events and read out:
//!
//! ```
//! use embedded_hal::{delay::DelayNs, spi::SpiDevice};
//! use spikewire::chip::{
//!     AerPort, ChipError, Describe, Inputs, Spikes, TinyOdin, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron,
//!     neurons_from,
//! };
//! use spikewire::{Bank, Readout, Tick, population::Position};
//!
//! static RATES: Position<f32, 64> = Position::linear(-8.0..=8.0);
//! static NETWORK: TinyOdinNetwork<64, 64, 64> = TinyOdinNetwork {
//!     neurons: [TinyOdinNeuron { threshold: 7, leak: 3, ..TinyOdinNeuron::REST }; 64],
//!     inputs: Inputs::one_to_one(7),
//!     recurrent: &[],
//!     outputs: neurons_from::<0, 64>(),
//! };
//!
//! fn fly<D: SpiDevice, P: AerPort>(
//!     chip: &mut TinyOdin<D, P>,
//!     delay: &mut impl DelayNs,
//!     rates: impl Iterator<Item = (Tick, f32)>, // rad/s
//!     mut command: impl FnMut(f32),
//! ) -> Result<(), ChipError<D::Error, P::Error>> {
//!     let mut gated = chip.reset(delay)?;
//!     gated.load(&NETWORK, |_| ())?;
//!     let mut chip = gated.run(&NETWORK.registers())?;
//!     let mut bank = Bank::<_, 1>::new(&RATES);
//!     let mut readout = Readout::<_, 1>::new(&RATES);
//!     for (now, rate) in rates {
//!         let mut events = Spikes::<64>::new();
//!         bank.encode(now, [rate], |event| events.push(event));
//!         let mut spikes = Spikes::<64>::new();
//!         let mut answers = NETWORK.answers(now, |event| spikes.push(event));
//!         for event in events.as_slice() {
//!             if let Some(input) = NETWORK.input(event.address) {
//!                 chip.send(input, &mut answers)?;
//!             }
//!         }
//!         chip.quiesce(&mut answers)?;
//!         drop(answers);
//!         let [value] = readout.decode(now, spikes.as_slice());
//!         command(value);
//!     }
//!     Ok(())
//! }
//! ```
//!
//! Every wait is bounded: it polls the pins or registers a given number of times, and then returns an error.

mod akd1500;
mod error;
mod family;
mod odin;
mod output_source;
mod reckon;
mod tinyodin;
mod xylo;

pub use akd1500::{Akd1500, ConvolutionEvent, DenseEvent};
pub use error::ChipError;
pub use family::{
    AerPort, Counters, Describe, FormatError, Gated, Input, Inputs, Network, NetworkBytes,
    OdinChip, Phase, Progress, Running, Spikes, neurons_from,
};
pub use odin::{
    Odin, OdinInput, OdinLearning, OdinNetwork, OdinNeuron, OdinRegisters, OdinSynapse,
};
pub use output_source::OutputSource;
pub use reckon::{
    DescribeReckOn, Programmed, ReckOn, ReckOnAnswer, ReckOnAnswers, ReckOnBytes, ReckOnLearning,
    ReckOnNetwork, ReckOnPair, ReckOnPort, ReckOnSample, ReckOnSettings, ReckOnShared, ReckOnStep,
    ReckOnTarget, ReckOnTask, Started,
};
pub use tinyodin::{TinyOdin, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, TinyOdinRegisters};
pub use xylo::{InputBank, Registers, Xylo, XyloMap, pack_counts};
