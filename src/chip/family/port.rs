//! The wires of a chip's two address-event buses.

/// The wires of a chip's two address-event buses and its reset, all active high.
///
/// One port-wide write each for the data, rather than single pins, keeps words whole: on an STM32 a
/// store to BSRR.
///
/// A call that fails may have acted or not: the driver makes it again before it goes on.
pub trait AerPort {
    /// What can go wrong; `Infallible` for pins of the microcontroller's own.
    type Error;

    /// Puts a word on the input bus. It must have settled at the chip when this returns.
    ///
    /// # Errors
    /// The port failed; so for all below.
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

    /// Reads `SCHED_FULL`, if it is wired: high while the chip's queue has no room, so that spikes which
    /// its neurons send to each other are lost. Not wired unless told.
    ///
    /// # Errors
    /// See [`set_input`](Self::set_input).
    fn queue_full(&mut self) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }
}
