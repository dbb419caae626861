//! `ReckOn`: 256 neurons with recurrent connections, 16 leaky outputs, weights of 8 bits, and learning on the chip.

mod bytes;
mod network;
mod port;
mod programmed;
mod running;
mod settings;
mod steps;
mod wire;

pub use bytes::ReckOnBytes;
pub use network::{DescribeReckOn, ReckOnNetwork, ReckOnPair, ReckOnShared};
pub use port::ReckOnPort;
pub use programmed::Programmed;
pub use running::{ReckOnAnswer, ReckOnSample, ReckOnStep, ReckOnTarget, Started};
pub use settings::{ReckOnAnswers, ReckOnLearning, ReckOnSettings, ReckOnTask};
pub use steps::{ReckOnOutputs, ReckOnSteps, ReckOnStepsState, ReckOnTick};

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorType, SpiDevice};

use super::ChipError;
use super::family::Phase;
use wire::{Address, Wire};

/// The driver of `ReckOn`, on an SPI device and a port.
///
/// Source: RTL and documentation, ChFrenkel/ReckOn; nothing was copied from them.
///
/// - **SPI:** mode 0, SCK at most a tenth of the chip's clock, because the chip must have a word ready within half a
///   cycle of SCK. The chip has no chip select. Therefore no other device may share its SPI bus, and the chip-select
///   pin of the SPI device stays unconnected.
/// - **States:** [`reset`](Self::reset) gives a [`Programmed`] chip, whose memories can be accessed;
///   [`Programmed::run`] gives a [`Started`] chip; [`Started::begin`] gives a [`ReckOnSample`], which takes inputs and
///   time steps until [`ReckOnSample::end`]. [`Started::program`] gives a [`Programmed`] chip again. After an error of
///   the bus, of a handshake or of a step, the driver refuses all calls until the next reset.
/// - **Checks:** the driver reads memories back. Registers cannot be read. Therefore, after each register, the driver
///   writes two words to an address that no network uses, and reads each of them back. This detects a clock pulse that
///   was lost or doubled earlier.
/// - **Undetected faults:** if one clock pulse is lost and another is doubled, chip and bus are in sync again
///   afterwards. Such a pair of faults may go unnoticed in three cases:
///   1. One of the two faults lies in a frame that writes a register, or in the frame that precedes it. The register
///      may then keep its old value or take a wrong one, or the chip may write a different register.
///   2. Both faults lie in the first bits of a frame that writes weights between neurons. The frame may then write a
///      register instead. The driver does not notice this if the memory already held the same weights.
///   3. The pair turns a read into a write while [`Programmed::load`] compares memory. [`Programmed::verify`] after the
///      load detects this in weights and parameters, but not in the potential of a neuron or an output.
/// - **Waits:** the driver waits for the chip by reading pins. The argument `polls` of [`new`](Self::new) limits the
///   number of reads; after the last read, the driver returns an error.
///
/// # A time step
/// Inputs that are sent before a tick act after that tick. At the next tick, neurons leak and fire, and then their
/// spikes act. At the tick after that, the outputs show these spikes. With N inputs and N neurons, a step takes 2 N + 4
/// clock cycles of the chip, and N more for each event.
///
/// # What to know about the chip
/// - After a reset, learning is on. At the first tick with `TARGET_VALID` high, the chip would then wait forever for a
///   target. Therefore [`Programmed::run`] always writes [`ReckOnSettings::learning`].
/// - If a tick comes before the last step is done, the chip stops until a reset, although the pin `TIMING_ERROR_RDY`
///   then says ready. [`ReckOnSample::step`] waits for this pin before the tick. After the tick the pin is low for only
///   2 N + 4 clock cycles, which a driver that reads its pins rarely would miss. Therefore the driver always sets the
///   chip to send an answer in each step. The pin then stays low until the last byte of the answer is taken, and a step
///   without an answer is an error.
/// - If `SAMPLE` falls while the chip learns, the chip never stops learning, and goes through all weights. The driver
///   prevents this, because it always sets the chip to send an answer in each step.
/// - The chip processes neurons in pairs. If a network has more inputs or outputs than neurons, the chip processes as
///   many neurons as there are inputs or outputs. A pair that the network does not use fires at every step if its
///   memory holds a threshold of 0. Therefore [`Programmed::load`] writes all 128 pairs.
/// - If the number of neurons is odd, the last neuron would never fire. Therefore the driver gives the chip a number
///   that is one higher.
/// - If a frame announces more than one word for a register, the chip writes all of the words to that register.
/// - An input sent twice within a step counts once. Inputs that are sent after the last tick of a sample are lost.
/// - Reset clears no memory.
/// - With a [`keep`](ReckOnPair::keep) above 32 768, a potential that grows beyond its range wraps around and changes
///   its sign.
///
/// # Example: a time step for each sample of an encoder bank
/// ```
/// use embedded_hal::{delay::DelayNs, spi::SpiDevice};
/// use spikewire_chips::{
///     ChipError, ReckOn, ReckOnAnswer, ReckOnNetwork, ReckOnPair, ReckOnPort, ReckOnSettings, ReckOnShared, ReckOnStep,
///     Spikes,
/// };
/// use spikewire::{Bank, Tick, population::Position};
///
/// static RATES: Position<f32, 16> = Position::linear(-8.0..=8.0);
/// static NETWORK: ReckOnNetwork<16, 16, 1> = ReckOnNetwork {
///     pairs: &[ReckOnPair { keep: 31_000, threshold: 1_000 }; 8],
///     inputs: [[40; 16]; 16],
///     recurrent: &[[-5; 16]; 16],
///     outputs: [[10]; 16],
///     shared: ReckOnShared { shifts: [4, 4, 0], keep: 120, resets_to_zero: true },
/// };
///
/// fn fly<D: SpiDevice, P: ReckOnPort>(
///     chip: &mut ReckOn<D, P>,
///     delay: &mut impl DelayNs,
///     rates: impl Iterator<Item = (Tick, f32)>, // rad/s
///     mut command: impl FnMut(i16),
/// ) -> Result<(), ChipError<D::Error, P::Error>> {
///     let mut programmed = chip.reset(delay)?;
///     programmed.load(&NETWORK, |_| ())?;
///     let mut sample = programmed.run(&ReckOnSettings::POTENTIALS)?.begin()?;
///     let mut bank = Bank::<_, 1>::new(&RATES);
///     for (now, rate) in rates {
///         let mut events = Spikes::<16>::new();
///         bank.encode(now, [rate], |event| events.push(event));
///         for event in events.as_slice() {
///             sample.send(event.address as u8)?;
///         }
///         if let Some(ReckOnAnswer::Potentials([output, ..])) = sample.step(ReckOnStep::default())? {
///             command(output);
///         }
///     }
///     sample.end()?;
///     Ok(())
/// }
/// ```
#[derive(Debug)]
pub struct ReckOn<D, P> {
    wire: Wire<D>,
    port: P,
    polls: u32,
    state: State,
    settings: ReckOnSettings,
    sizes: Sizes,
    /// The outputs of the network that was loaded after the last reset, which clears the chip's registers; `None` before
    /// that.
    outputs: Option<Outputs>,
}

/// The registers and weights of a network's outputs, as far as time steps of [`ReckOnSteps`] depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Outputs {
    /// Left shift of the weights.
    shift: u8,
    /// Factor by which a tick multiplies a potential, in units of 1/128.
    keep: u8,
    /// For the output at which it is largest: the sum of all weights of one sign, without its sign and before the shift.
    sum: u16,
}

/// The numbers of the network's last input, last neuron and last output, as the driver gives them to the chip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Sizes {
    input: u8,
    neuron: u8,
    output: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Chip and bus are out of sync, or the chip was not reset yet.
    NotReset,
    Programmed,
    Started,
    Sample,
}

type Outcome<T, D, P> = Result<T, ChipError<<D as ErrorType>::Error, <P as ReckOnPort>::Error>>;

/// Duration of the reset pulse, and of the pause after the pulse, in µs.
const RESET_US: u32 = 10;

/// Number of the register that opens the chip's memories to accesses over SPI.
const OPEN: u16 = 0;

impl<D: SpiDevice, P: ReckOnPort> ReckOn<D, P> {
    /// Duration of the longest time step, in clock cycles of the chip. In this step all 256 neurons fire, and the chip
    /// learns.
    pub const MAX_CLOCKS: u32 = 76_000;

    /// Makes a driver for a chip that must be [reset](Self::reset) first. Every wait reads the pins up to `polls`
    /// times. [`MAX_CLOCKS`](Self::MAX_CLOCKS) polls suffice if each poll takes at least one clock cycle of the chip.
    /// If several polls fit into one clock cycle, multiply `MAX_CLOCKS` by the number of polls in a clock cycle,
    /// rounded up.
    pub const fn new(device: D, port: P, polls: u32) -> Self {
        let wire = Wire { device };
        let sizes = Sizes { input: 255, neuron: 255, output: 15 };
        let settings = ReckOnSettings::LABEL;
        Self { wire, port, polls, state: State::NotReset, settings, sizes, outputs: None }
    }

    /// Pulses reset, which brings chip and bus into sync, and checks that the chip answers. The chip's memories keep
    /// their content; its registers do not.
    ///
    /// # Errors
    /// Returns an error if the port or the bus failed, or if memory reads back a different value than was written.
    pub fn reset(&mut self, delay: &mut impl DelayNs) -> Outcome<Programmed<'_, D, P>, D, P> {
        self.state = State::NotReset;
        self.outputs = None;
        self.clear_pins().map_err(ChipError::Port)?;
        delay.delay_us(RESET_US);
        self.port.set_reset(false).map_err(ChipError::Port)?;
        delay.delay_us(RESET_US);
        self.state = State::Programmed;
        self.check_sync()?;
        Ok(Programmed { chip: self })
    }

    fn clear_pins(&mut self) -> Result<(), P::Error> {
        let port = &mut self.port;
        port.set_reset(true)?;
        port.set_input_request(false)?;
        port.set_input(0, false)?;
        port.set_output_acknowledge(false)?;
        port.set_sample(false)?;
        port.set_tick(false)?;
        port.set_target_valid(false)?;
        port.set_infer(false)
    }

    /// Gives access to the memories of a chip that an earlier call left stopped.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset) if the chip must be reset first, or [`NotGated`](ChipError::NotGated)
    /// if the chip runs.
    pub fn programmed(&mut self) -> Outcome<Programmed<'_, D, P>, D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Programmed => Ok(Programmed { chip: self }),
            State::Started | State::Sample => Err(ChipError::NotGated),
        }
    }

    /// Returns a chip that an earlier call left running, between two samples.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset) if the chip must be reset first, [`Gated`](ChipError::Gated) if the
    /// chip does not run, or [`Busy`](ChipError::Busy) if the chip is within a sample.
    pub fn started(&mut self) -> Outcome<Started<'_, D, P>, D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Programmed => Err(ChipError::Gated),
            State::Started => Ok(Started { chip: self }),
            State::Sample => Err(ChipError::Busy),
        }
    }

    /// Returns a chip that an earlier call left within a sample.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset) if the chip must be reset first, [`Gated`](ChipError::Gated) if the
    /// chip does not run, or [`NotStarted`](ChipError::NotStarted) if the chip is between samples.
    pub fn sample(&mut self) -> Outcome<ReckOnSample<'_, D, P>, D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Programmed => Err(ChipError::Gated),
            State::Started => Err(ChipError::NotStarted),
            State::Sample => Ok(ReckOnSample { chip: self }),
        }
    }

    /// Consumes the driver and returns its SPI device and port.
    pub fn release(self) -> (D, P) {
        (self.wire.device, self.port)
    }

    fn expect_programmed(&self) -> Outcome<(), D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Programmed => Ok(()),
            State::Started | State::Sample => Err(ChipError::NotGated),
        }
    }

    /// Returns `result` unchanged. If it is an error, the driver refuses all calls until the next reset.
    fn heed<T>(&mut self, result: Outcome<T, D, P>) -> Outcome<T, D, P> {
        if result.is_err() {
            self.state = State::NotReset;
        }
        result
    }

    fn heed_bus<T>(&mut self, result: Result<T, D::Error>) -> Outcome<T, D, P> {
        self.heed(result.map_err(ChipError::Bus))
    }

    fn write(&mut self, address: Address, word: u32) -> Outcome<(), D, P> {
        self.expect_programmed()?;
        let result = self.wire.write(address, word);
        self.heed_bus(result)
    }

    fn read(&mut self, address: Address) -> Outcome<u32, D, P> {
        self.expect_programmed()?;
        let result = self.wire.read(address);
        self.heed_bus(result)
    }

    fn expect(&mut self, address: Address, written: u32) -> Outcome<(), D, P> {
        let read = self.read(address)?;
        if read == written {
            return Ok(());
        }
        self.heed(Err(ChipError::ReadBack { address: address.0, written, read }))
    }

    /// Checks that chip and bus are in sync: writes two words to an address that no network uses, and reads each back.
    /// A bus that is out of sync by one bit reads different words.
    fn check_sync(&mut self) -> Outcome<(), D, P> {
        for word in [0xA53C_0F96, 0x5AC3_F069] {
            self.write(Address::anchor(), word)?;
            self.expect(Address::anchor(), word)?;
        }
        Ok(())
    }

    /// Returns how many pin reads together last at least `clocks` clock cycles of the chip.
    fn reads(&self, clocks: u32) -> u32 {
        self.polls.div_ceil(Self::MAX_CLOCKS).saturating_mul(clocks)
    }

    /// Reads the ready pin up to `reads` times; returns whether it reached the level `is_high`.
    fn wait_ready(&mut self, is_high: bool, reads: u32) -> Result<bool, P::Error> {
        for _ in 0..reads {
            if self.port.ready()? == is_high {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn send(&mut self, byte: u8, is_target: bool) -> Outcome<(), D, P> {
        let result = self.handshake(byte, is_target);
        self.heed(result)
    }

    fn handshake(&mut self, byte: u8, is_target: bool) -> Outcome<(), D, P> {
        self.port.set_input(byte, is_target).map_err(ChipError::Port)?;
        self.port.set_input_request(true).map_err(ChipError::Port)?;
        if !self.wait_acknowledge(true).map_err(ChipError::Port)? {
            return Err(ChipError::Handshake(Phase::Acknowledge));
        }
        self.port.set_input_request(false).map_err(ChipError::Port)?;
        if self.wait_acknowledge(false).map_err(ChipError::Port)? {
            return Ok(());
        }
        Err(ChipError::Handshake(Phase::Release))
    }

    fn wait_acknowledge(&mut self, is_high: bool) -> Result<bool, P::Error> {
        for _ in 0..self.polls {
            if self.port.input_acknowledge()? == is_high {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
