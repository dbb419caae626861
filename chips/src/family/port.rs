//! The wires of a chip's input bus and output bus.

/// The wires of a chip's two address-event buses and its reset, all active high.
///
/// Write the data with one store to the port instead of single pins, so that no half-written word is seen: on an STM32
/// a store to BSRR.
///
/// | line | direction | |
/// |---|---|---|
/// | `AERIN_ADDR` | to the chip | the word of [`set_input`](Self::set_input): bit n on line n; 10 lines for tinyODIN, 17 for ODIN |
/// | `AERIN_REQ`, `AERIN_ACK` | to the chip, from it | the handshake of a word |
/// | `AEROUT_ADDR` | from the chip | the neuron that fires, eight lines |
/// | `AEROUT_REQ`, `AEROUT_ACK` | from the chip, to it | the handshake of a neuron |
/// | `RST` | to the chip | pulsed at the start, and where chip and bus may be out of step |
///
/// A call that fails may have changed the pins or not: the driver repeats it before it goes on.
pub trait AerPort {
    /// Error type of the port; `Infallible` for the microcontroller's own pins.
    type Error;

    /// Puts a word on the input bus. The word must have settled at the chip when this returns.
    ///
    /// # Errors
    /// Returns an error if the port failed.
    fn set_input(&mut self, word: u32) -> Result<(), Self::Error>;

    /// Drives the input bus's REQ.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_input_request(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Reads the input bus's ACK.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn input_acknowledge(&mut self) -> Result<bool, Self::Error>;

    /// Reads the output bus's REQ.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn output_request(&mut self) -> Result<bool, Self::Error>;

    /// Reads the output bus's word.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn output(&mut self) -> Result<u8, Self::Error>;

    /// Drives the output bus's ACK.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Drives the chip's reset.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_reset(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Reads `SCHED_FULL`, which is high while the chip's queue is full, so that spikes between neurons are lost. The
    /// default returns `None`: the pin is not wired.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn queue_full(&mut self) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }
}
