//! A chip that runs and takes events.

use embedded_hal::spi::SpiDevice;

use super::aer::Carries;
use super::{AerPort, ChipError, Counters, Gated, Input, OdinChip, Outcome};

/// Number of clocks from our ACK to an output until the chip continues, with a margin.
const HANDSHAKE_CLOCKS: u32 = 32;
/// Number of clocks that [`Running::quiesce`] allows for outputs, beyond four times the longest time without any:
/// enough for more than a thousand outputs.
const OUTPUT_CLOCKS: u32 = 1 << 15;

/// A running chip: it takes events, and its memories cannot be accessed. After an error it still runs, unless the call
/// consumed this value.
#[derive(Debug)]
pub struct Running<'a, I: Input, D, P> {
    pub(super) chip: &'a mut OdinChip<I, D, P>,
}

impl<'a, I: Input, D: SpiDevice, P: AerPort> Running<'a, I, D, P> {
    pub(super) fn new(chip: &'a mut OdinChip<I, D, P>) -> Self {
        Self { chip }
    }

    /// Sends one input, and passes neurons that fire meanwhile to `on_output`. The chip still works on the word after
    /// it has taken it: 2 clocks for every neuron in use.
    ///
    /// # Errors
    /// Returns an error if the input is invalid, the chip does not answer, or the port failed. With
    /// [`Phase::Idle`](super::Phase::Idle) the input was not sent. With any other [`Handshake`](ChipError::Handshake)
    /// error it is pending, and must not be sent again.
    pub fn send(&mut self, input: I, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        let word = input.word()?;
        let aer = &mut self.chip.aer;
        aer.begin(word, Carries::Word, &mut on_output)?;
        Ok(aer.finish(&mut on_output)?)
    }

    /// Passes neurons that have fired to `on_output`, and continues with a pending word. Reads the pins only a few
    /// times: call it often, as the chip stops while an output waits.
    ///
    /// # Errors
    /// Returns an error if the port failed. No output is passed on twice.
    pub fn poll(&mut self, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        self.chip.aer.poll(&mut on_output).map_err(ChipError::Port)
    }

    /// Waits until the chip has processed all its input, and passes neurons that fire meanwhile to `on_output`.
    ///
    /// No pin shows that the chip is at rest. So this waits until no output has come for the longest time that the chip
    /// can work without one. In open loop that is a few sweeps of 2 clocks a neuron. In closed loop it is a sweep for
    /// each spike that the queue can hold: 66 000 clocks for tinyODIN's 256 neurons.
    ///
    /// # Errors
    /// Returns [`Busy`](ChipError::Busy) if outputs do not end, as those of a network that drives itself; see
    /// [`open_loop`](Self::open_loop). Returns another error if the chip does not take the pending word, or if the port
    /// failed. In both cases the chip still runs.
    pub fn quiesce(&mut self, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        let chip = &mut *self.chip;
        chip.aer.finish(&mut on_output)?;
        let (sweeps, clocks) = match &chip.registers {
            Some(registers) if I::is_open_loop(registers) => (4, I::sweep_clocks(registers)),
            Some(registers) => (I::QUEUE + 2, I::sweep_clocks(registers)),
            None => return Err(ChipError::NotReset),
        };
        let clocks = sweeps * clocks + HANDSHAKE_CLOCKS;
        let limit = 4 * clocks + OUTPUT_CLOCKS;
        let (looks, limit) = (chip.aer.looks(clocks), chip.aer.looks(limit));
        match chip.aer.rest(looks, limit, &mut on_output) {
            Ok(true) => Ok(()),
            Ok(false) => Err(ChipError::Busy),
            Err(error) => Err(ChipError::Port(error)),
        }
    }

    /// Waits until the chip is at rest, as [`quiesce`](Self::quiesce) does, and gates it. Then its memories can be
    /// accessed, and its neurons keep their potentials.
    ///
    /// # Errors
    /// Returns the errors of [`quiesce`](Self::quiesce), after which the chip still runs. Also returns an error if the
    /// bus failed, or if the chip reads back something else than was written: then reset it.
    pub fn gate(mut self, on_output: impl FnMut(u8)) -> Outcome<Gated<'a, I, D, P>, D, P> {
        self.quiesce(on_output)?;
        self.chip.shut()?;
        Ok(Gated::new(self.chip))
    }

    /// Opens the loop, so that a network that drives itself comes to rest. The loop stays open until the next
    /// [`run`](Gated::run). This write is not verified; [`gate`](Self::gate) verifies its own.
    ///
    /// # Errors
    /// Returns an error if the bus failed: then reset the chip.
    pub fn open_loop(self) -> Outcome<Self, D, P> {
        let result = self.chip.wire.configure(I::OPEN_LOOP, 1);
        self.chip.heed(result)?;
        Ok(self)
    }

    /// Returns the counts of losses, skipped time steps and repeated events.
    pub const fn counters(&self) -> Counters {
        self.chip.counters()
    }
}
