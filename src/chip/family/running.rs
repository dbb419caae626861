//! A chip that takes events.

use embedded_hal::spi::SpiDevice;

use super::aer::Carries;
use super::{AerPort, ChipError, Counters, Gated, Input, OdinChip, Outcome};

/// Clocks from an output's answer until the chip goes on, with some to spare.
const HANDSHAKE_CLOCKS: u32 = 32;
/// Clocks for which outputs are waited for, beyond four times those for which a chip may work in silence:
/// enough for a thousand and more.
const OUTPUT_CLOCKS: u32 = 1 << 15;

/// A chip that takes events, and whose memories cannot be accessed. Whatever a call returns, the chip runs
/// on, unless the call took this away.
#[derive(Debug)]
pub struct Running<'a, I: Input, D, P> {
    pub(super) chip: &'a mut OdinChip<I, D, P>,
}

impl<'a, I: Input, D: SpiDevice, P: AerPort> Running<'a, I, D, P> {
    pub(super) fn new(chip: &'a mut OdinChip<I, D, P>) -> Self {
        Self { chip }
    }

    /// Sends one input, and hands the neurons that fire meanwhile to `on_output`. The chip works on after
    /// it has taken the word: 2 clocks for every neuron in use.
    ///
    /// # Errors
    /// The input is not valid, the chip does not answer, or the port failed. After
    /// [`Phase::Idle`](super::Phase::Idle) the input was not sent; after any other
    /// [`Handshake`](ChipError::Handshake) it is under way, and not to be sent again.
    pub fn send(&mut self, input: I, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        let word = input.word()?;
        let aer = &mut self.chip.aer;
        aer.begin(word, Carries::Word, &mut on_output)?;
        Ok(aer.finish(&mut on_output)?)
    }

    /// Takes the neurons that have fired, and goes on with a word under way. Looks at the pins a bounded
    /// number of times: call it often, as the chip stands still while an output waits.
    ///
    /// # Errors
    /// The port failed. An output that was handed over is not handed over again.
    pub fn poll(&mut self, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        self.chip.aer.poll(&mut on_output).map_err(ChipError::Port)
    }

    /// Waits until the chip has worked off all that it has taken, and hands over the neurons that fire
    /// meanwhile.
    ///
    /// The chip does not say when it is at rest. A chip without outputs for as long as it can work in
    /// silence is: in open loop a few sweeps of 2 clocks a neuron, in closed loop a sweep for each spike
    /// that its queue may hold, 66 000 clocks for tinyODIN's 256 neurons.
    ///
    /// # Errors
    /// [`Busy`](ChipError::Busy): outputs come without end, as of a network that drives itself; see
    /// [`open_loop`](Self::open_loop). A word under way is not taken, or the port failed. The chip runs on
    /// after each.
    pub fn quiesce(&mut self, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        let chip = &mut *self.chip;
        chip.aer.finish(&mut on_output)?;
        let (sweeps, clocks) = match &chip.registers {
            Some(registers) if I::is_open_loop(registers) => (4, I::sweep_clocks(registers)),
            Some(registers) => (I::QUEUE + 2, I::sweep_clocks(registers)),
            None => return Err(ChipError::NotReset),
        };
        let clocks = sweeps * clocks + HANDSHAKE_CLOCKS;
        let looks = |clocks: u32| clocks.saturating_mul(chip.looks_a_clock.get());
        let limit = 4 * clocks + OUTPUT_CLOCKS;
        match chip.aer.rest(looks(clocks), looks(limit), &mut on_output) {
            Ok(true) => Ok(()),
            Ok(false) => Err(ChipError::Busy),
            Err(error) => Err(ChipError::Port(error)),
        }
    }

    /// Waits until the chip is at rest, as [`quiesce`](Self::quiesce) does, and gates it: its memories can
    /// then be accessed, with the neurons' potentials as they are.
    ///
    /// # Errors
    /// As [`quiesce`](Self::quiesce), and the chip runs on; or the bus failed or the chip does not read
    /// back what is written: then reset it.
    pub fn gate(mut self, on_output: impl FnMut(u8)) -> Outcome<Gated<'a, I, D, P>, D, P> {
        self.quiesce(on_output)?;
        self.chip.shut()?;
        Ok(Gated::new(self.chip))
    }

    /// Opens the loop of a chip that runs, so that a network that drives itself comes to rest. The loop
    /// stays open until the next [`run`](Gated::run). This write cannot be verified: `gate` is.
    ///
    /// # Errors
    /// The bus failed: then reset the chip.
    pub fn open_loop(self) -> Outcome<Self, D, P> {
        let result = self.chip.wire.configure(I::OPEN_LOOP, 1);
        self.chip.heed(result)?;
        Ok(self)
    }

    /// What was lost, skipped and repeated.
    pub const fn counters(&self) -> Counters {
        self.chip.counters()
    }
}
