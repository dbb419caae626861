//! Address events over parallel wires, by the 4-phase handshake.

use crate::Event;

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

/// Where a handshake stands, or stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// ACK is high before REQ, or the word before this one is still under way. This one was not sent.
    Idle,
    /// ACK has not risen after REQ. The word is under way: it stays on the bus, with REQ, until the chip
    /// takes it or is reset.
    Acknowledge,
    /// ACK has not fallen after REQ has. The chip has taken the word.
    Release,
}

/// Why a word is not through.
#[derive(Debug)]
pub(super) enum AerError<E> {
    Port(E),
    Timeout(Phase),
}

impl<E> From<E> for AerError<E> {
    fn from(error: E) -> Self {
        Self::Port(error)
    }
}

/// The microcontroller's side of both buses.
///
/// The chip reads the word for as long as it works on it, and acknowledges whatever REQ it then finds.
/// So a word once begun is kept up until it is acknowledged, over as many calls as that takes.
#[derive(Debug)]
pub(super) struct Aer<P> {
    pub(super) port: P,
    /// How often a wait looks at the pins.
    polls: u32,
    /// Of the word that was begun last.
    phase: Phase,
    /// What that word stands for, until it is acknowledged.
    pub(super) event: Option<Event>,
    /// Whether the last call to [`send`](Self::send) began its word, even if an error followed.
    pub(super) is_begun: bool,
    /// REQ, where it is known.
    is_requesting: Option<bool>,
    is_acknowledging: bool,
}

impl<P: AerPort> Aer<P> {
    pub(super) const fn new(port: P, polls: u32) -> Self {
        Self {
            port,
            polls,
            phase: Phase::Idle,
            event: None,
            is_begun: false,
            is_requesting: None,
            is_acknowledging: false,
        }
    }

    /// Lowers both of our wires, whatever they were, and drops the word under way.
    pub(super) fn release(&mut self) -> Result<(), P::Error> {
        (self.phase, self.is_requesting) = (Phase::Idle, None);
        self.request(false)?;
        self.port.set_output_acknowledge(false)?;
        self.is_acknowledging = false;
        Ok(())
    }

    /// One step of either bus's handshake, if the chip waits for one. Returns whether the input bus is
    /// free.
    pub(super) fn step(&mut self, on_output: &mut impl FnMut(u8)) -> Result<bool, P::Error> {
        self.serve(on_output)?;
        self.request(self.phase == Phase::Acknowledge)?;
        let is_acknowledged = self.port.input_acknowledge()?;
        match (self.phase, is_acknowledged) {
            (Phase::Acknowledge, true) => (self.phase, self.event) = (Phase::Release, None),
            (Phase::Release, false) => self.phase = Phase::Idle,
            _ => {}
        }
        Ok(self.phase == Phase::Idle && !is_acknowledged)
    }

    /// Sends a word, which stands for this event, once the one under way is through.
    pub(super) fn send(
        &mut self,
        word: u32,
        event: Option<Event>,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        self.is_begun = false;
        if !self.is_free(on_output)? {
            return Err(AerError::Timeout(Phase::Idle));
        }
        self.port.set_input(word)?;
        (self.phase, self.event, self.is_begun) = (Phase::Acknowledge, event, true);
        self.finish(on_output)
    }

    /// Brings the word under way to its end, if there is one.
    pub(super) fn finish(
        &mut self,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        if self.phase == Phase::Idle || self.is_free(on_output)? {
            Ok(())
        } else {
            Err(AerError::Timeout(self.phase))
        }
    }

    /// Waits for it. While an output event waits the chip acknowledges no input, so this serves the
    /// output bus as well.
    fn is_free(&mut self, on_output: &mut impl FnMut(u8)) -> Result<bool, P::Error> {
        for _ in 0..self.polls {
            if self.step(on_output)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn serve(&mut self, on_output: &mut impl FnMut(u8)) -> Result<(), P::Error> {
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

    fn request(&mut self, is_high: bool) -> Result<(), P::Error> {
        if self.is_requesting != Some(is_high) {
            self.is_requesting = None; // until known otherwise
            self.port.set_input_request(is_high)?;
            self.is_requesting = Some(is_high);
        }
        Ok(())
    }
}
