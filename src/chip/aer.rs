//! Address events over parallel wires, by the 4-phase handshake.

/// The wires of a chip's two address-event buses and its reset, all active high.
///
/// One port-wide write each for the data, rather than single pins, keeps words whole: on an STM32 a
/// store to BSRR.
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
}

/// The phases of a handshake in which the chip can fail to answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// ACK is high before REQ. The word was not sent.
    Idle,
    /// ACK does not rise after REQ; REQ was taken back. The chip may have taken the word.
    Acknowledge,
    /// ACK does not fall after REQ has. The chip has taken the word.
    Release,
}

/// Why a word was not sent.
#[derive(Debug)]
pub(super) enum AerError<E> {
    Port(E),
    Timeout(Phase),
}

/// The microcontroller's side of both buses.
#[derive(Debug)]
pub(super) struct Aer<P> {
    pub(super) port: P,
    /// How often a wait looks at the pins.
    polls: u32,
    is_requesting: bool,
    is_acknowledging: bool,
    /// Whether the chip acknowledged the last word, even if an error followed.
    pub(super) is_taken: bool,
}

impl<P: AerPort> Aer<P> {
    pub(super) const fn new(port: P, polls: u32) -> Self {
        Self { port, polls, is_requesting: false, is_acknowledging: false, is_taken: false }
    }

    /// Lowers both of our wires, whatever they were.
    pub(super) fn release(&mut self) -> Result<(), P::Error> {
        self.port.set_input_request(false)?;
        self.is_requesting = false;
        self.port.set_output_acknowledge(false)?;
        self.is_acknowledging = false;
        Ok(())
    }

    /// One step of the output bus's handshake, if the chip waits for one.
    pub(super) fn serve(&mut self, on_output: &mut impl FnMut(u8)) -> Result<(), P::Error> {
        match (self.port.output_request()?, self.is_acknowledging) {
            (true, false) => {
                let address = self.port.output()?;
                self.port.set_output_acknowledge(true)?;
                self.is_acknowledging = true;
                on_output(address);
            }
            (false, true) => {
                self.port.set_output_acknowledge(false)?;
                self.is_acknowledging = false;
            }
            _ => {}
        }
        Ok(())
    }

    /// Sends a word. While an output event waits the chip acknowledges no input, so every wait serves
    /// the output bus.
    pub(super) fn send(
        &mut self,
        word: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        self.is_taken = false;
        if self.is_requesting {
            self.request(false)?; // left over from a port that failed
        }
        self.wait_for(false, Phase::Idle, on_output)?;
        self.port.set_input(word).map_err(AerError::Port)?;
        self.request(true)?;
        if let Err(error) = self.wait_for(true, Phase::Acknowledge, on_output) {
            self.request(false)?;
            return Err(error);
        }
        self.is_taken = true;
        self.request(false)?;
        self.wait_for(false, Phase::Release, on_output)
    }

    fn request(&mut self, is_high: bool) -> Result<(), AerError<P::Error>> {
        self.is_requesting = true; // until known otherwise
        self.port.set_input_request(is_high).map_err(AerError::Port)?;
        self.is_requesting = is_high;
        Ok(())
    }

    fn wait_for(
        &mut self,
        is_high: bool,
        phase: Phase,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        for _ in 0..self.polls {
            self.serve(on_output).map_err(AerError::Port)?;
            if self.port.input_acknowledge().map_err(AerError::Port)? == is_high {
                return Ok(());
            }
        }
        Err(AerError::Timeout(phase))
    }
}
