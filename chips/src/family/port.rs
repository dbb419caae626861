//! The wires of a chip's input bus and output bus.

/// The wires of a chip's two address-event buses and its reset, all active high.
///
/// Write all data pins with one store (on an STM32, to BSRR) instead of pin by pin, so that the chip never sees a
/// half-written word.
///
/// | line | direction | meaning |
/// |---|---|---|
/// | `AERIN_ADDR` | to the chip | the word of [`set_input`](Self::set_input): bit n on line n; 10 lines for tinyODIN, 17 for ODIN |
/// | `AERIN_REQ`, `AERIN_ACK` | to the chip, from it | the handshake of a word |
/// | `AEROUT_ADDR` | from the chip | the neuron that fires, eight lines |
/// | `AEROUT_REQ`, `AEROUT_ACK` | from the chip, to it | the handshake of a neuron |
/// | `RST` | to the chip | reset, which [`OdinChip::reset`](super::OdinChip::reset) pulses |
///
/// If a call fails, the driver does not know whether the pins have changed. It repeats the call before it goes on.
pub trait AerPort {
    /// Error type of the port; `Infallible` for the microcontroller's own pins.
    type Error;

    /// Puts a word on the input bus. The wires must have settled at the chip before this function returns.
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

    /// Reads the number of the neuron on the output bus.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn output(&mut self) -> Result<u8, Self::Error>;

    /// Drives the output bus's ACK.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Drives the chip's reset pin.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_reset(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Reads `SCHED_FULL`, which is high while the chip's queue is full; spikes between neurons are lost then. Returns
    /// `None` if the pin is not wired. The default implementation always returns `None`.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn queue_full(&mut self) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }
}
