//! A chip that runs and takes events.

use embedded_hal::spi::SpiDevice;

use super::aer::Carries;
use super::{AerPort, ChipError, Counters, Gated, Input, OdinChip, Outcome};

/// Number of clock cycles from the driver's ACK of an output until the chip continues, with a margin.
const HANDSHAKE_CLOCKS: u32 = 32;
/// Number of clock cycles that [`Running::quiesce`] allows for the handshakes of outputs: enough for more than a
/// thousand outputs. `quiesce` waits until no output has come for a certain time. It gives up after four times that
/// time, plus these clock cycles.
const OUTPUT_CLOCKS: u32 = 1 << 15;

/// A running chip: it takes events, and its memories cannot be accessed. After an error the chip still runs, unless the
/// `# Errors` section of the call says to reset the chip. If [`gate`](Self::gate) fails and the chip still runs,
/// [`OdinChip::running`] returns a new value of this type.
#[derive(Debug)]
pub struct Running<'a, I: Input, D, P> {
    pub(super) chip: &'a mut OdinChip<I, D, P>,
}

impl<'a, I: Input, D: SpiDevice, P: AerPort> Running<'a, I, D, P> {
    pub(super) fn new(chip: &'a mut OdinChip<I, D, P>) -> Self {
        Self { chip }
    }

    /// Sends one input to the chip, and passes neurons that fire meanwhile to `on_output`. When this call returns, the
    /// chip has taken the input, but may work on it for about 2 more clock cycles for every neuron in use.
    ///
    /// # Errors
    /// Returns an error if the input is invalid, the chip does not answer, or the port failed. A
    /// [`Handshake`](ChipError::Handshake) error with [`Phase::Idle`](super::Phase::Idle) means that the input was not
    /// sent. Any other `Handshake` error means that the input is pending: do not send it again.
    pub fn send(&mut self, input: I, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        let word = input.word()?;
        let aer = &mut self.chip.aer;
        aer.begin(word, Carries::Word, &mut on_output)?;
        Ok(aer.finish(&mut on_output)?)
    }

    /// Passes neurons that have fired to `on_output`, and advances the handshake of a pending word. Reads the pins only
    /// a few times, and does not wait. Call `poll` often, because the chip stops while an output waits.
    ///
    /// # Errors
    /// Returns an error if the port failed. No output is passed on twice.
    pub fn poll(&mut self, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        self.chip.aer.poll(&mut on_output).map_err(ChipError::Port)
    }

    /// Waits until the chip has processed all its input, and passes neurons that fire meanwhile to `on_output`.
    ///
    /// No pin shows that the chip is at rest. Therefore this call waits until no output has come for the longest time
    /// that the chip can work without an output. This time is a number of *sweeps*. In a sweep the chip applies one
    /// spike to all neurons in use, with 2 clock cycles for each neuron. If the loop is open (spikes do not reach other
    /// neurons), this call waits for 4 sweeps. If the loop is closed, this call waits for one sweep for each spike that
    /// fits into the chip's queue, and for 2 more: about 67 000 clock cycles for tinyODIN with 256 neurons.
    ///
    /// # Errors
    /// Returns [`Busy`](ChipError::Busy) if outputs keep coming, for example from a network that drives itself; see
    /// [`open_loop`](Self::open_loop). Returns another error if the chip does not take the pending word, or if the port
    /// failed. After any of these errors the chip still runs.
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
        let (reads, limit) = (chip.aer.reads(clocks), chip.aer.reads(limit));
        match chip.aer.rest(reads, limit, &mut on_output) {
            Ok(true) => Ok(()),
            Ok(false) => Err(ChipError::Busy),
            Err(error) => Err(ChipError::Port(error)),
        }
    }

    /// Waits until the chip is at rest, as [`quiesce`](Self::quiesce) does. Then gates the chip: stops its activity, so
    /// that its memories can be accessed. The neurons keep their potentials.
    ///
    /// # Errors
    /// Returns the errors of [`quiesce`](Self::quiesce); the chip then still runs. Returns another error if the bus
    /// failed, or if memory reads back a different value than was written. After such an error, reset the chip.
    pub fn gate(mut self, on_output: impl FnMut(u8)) -> Outcome<Gated<'a, I, D, P>, D, P> {
        self.quiesce(on_output)?;
        self.chip.shut()?;
        Ok(Gated::new(self.chip))
    }

    /// Opens the loop (spikes no longer reach other neurons), so that a network that drives itself comes to rest. The
    /// loop stays open until the next [`run`](Gated::run). The driver does not verify this write; [`gate`](Self::gate)
    /// opens the loop again and verifies that.
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
