//! The wires of `ReckOn`, except for those of SPI.

/// The wires of `ReckOn`, except for those of SPI. All are active high.
///
/// | line | direction | meaning |
/// |---|---|---|
/// | `AERIN_ADDR`, `AERIN_TAR_EN` | to the chip | an input's number, or a byte of a target: nine lines, written with one store |
/// | `AERIN_REQ`, `AERIN_ACK` | to the chip, from it | the handshake of an input |
/// | `OUT_DATA` | from the chip | a byte of the chip's answer, eight lines |
/// | `OUT_REQ`, `OUT_ACK` | from the chip, to it | the handshake of a byte of the answer |
/// | `SAMPLE` | to the chip | high during a sample |
/// | `TIME_TICK` | to the chip | a rising edge (a tick) begins a time step |
/// | `TARGET_VALID`, `INFER_ACC` | to the chip | high in a step that learns; high in a step that counts for the label |
/// | `TIMING_ERROR_RDY` | from the chip | high while the chip is ready for a tick |
/// | `RST` | to the chip | reset, which [`ReckOn::reset`](super::ReckOn::reset) pulses |
pub trait ReckOnPort {
    /// Error type of the port; `Infallible` for the microcontroller's own pins.
    type Error;

    /// Puts a byte on `AERIN_ADDR`, and drives `AERIN_TAR_EN`. The wires must have settled at the chip before this
    /// function returns.
    ///
    /// # Errors
    /// Returns an error if the port failed.
    fn set_input(&mut self, byte: u8, is_target: bool) -> Result<(), Self::Error>;

    /// Drives `AERIN_REQ`, which announces a byte on `AERIN_ADDR`.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_input_request(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Reads `AERIN_ACK`, with which the chip confirms a byte on `AERIN_ADDR`.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn input_acknowledge(&mut self) -> Result<bool, Self::Error>;

    /// Reads `OUT_REQ`, with which the chip announces a byte of its answer.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn output_request(&mut self) -> Result<bool, Self::Error>;

    /// Reads `OUT_DATA`, a byte of the chip's answer.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn output(&mut self) -> Result<u8, Self::Error>;

    /// Drives `OUT_ACK`, which confirms a byte of the chip's answer.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Drives `SAMPLE`, which is high during a sample.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_sample(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Drives `TIME_TICK`, whose rising edge begins a time step.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_tick(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Drives `TARGET_VALID`, which is high in a time step from which the chip learns.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_target_valid(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Drives `INFER_ACC`, which is high in a time step that counts for the label.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_infer(&mut self, is_high: bool) -> Result<(), Self::Error>;

    /// Reads `TIMING_ERROR_RDY`, which is high while a tick may come.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn ready(&mut self) -> Result<bool, Self::Error>;

    /// Drives `RST`, the chip's reset.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn set_reset(&mut self, is_high: bool) -> Result<(), Self::Error>;
}
