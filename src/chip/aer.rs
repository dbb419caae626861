//! Address events over parallel wires, by the 4-phase handshake.

use crate::event::Event;

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
    /// What that word stands for, if it is an event.
    pub(super) event: Option<Event>,
    /// Whether the last call to [`send`](Self::send) began its word, even if an error followed.
    pub(super) is_begun: bool,
    is_acknowledging: bool,
}

impl<P: AerPort> Aer<P> {
    pub(super) const fn new(port: P, polls: u32) -> Self {
        let phase = Phase::Idle;
        Self { port, polls, phase, event: None, is_begun: false, is_acknowledging: false }
    }

    /// Lowers both of our wires, whatever they were, and drops the word under way. Its event comes back.
    pub(super) fn release(&mut self) -> (Option<Event>, Result<(), P::Error>) {
        let event = self.event.take().filter(|_| self.phase == Phase::Acknowledge);
        self.phase = Phase::Idle;
        self.is_acknowledging = false;
        let request = self.port.set_input_request(false);
        (event, request.and_then(|()| self.port.set_output_acknowledge(false)))
    }

    /// Goes on with both buses, in a few looks at the pins.
    pub(super) fn poll(&mut self, on_output: &mut impl FnMut(u8)) -> Result<(), P::Error> {
        // Up, and down again.
        for _ in 0..2 {
            self.serve(on_output)?;
        }
        match self.finish_within(1, on_output) {
            Ok(()) | Err(AerError::Timeout(_)) => Ok(()),
            Err(AerError::Port(error)) => Err(error),
        }
    }

    /// Sends a word, once the one under way is through.
    pub(super) fn send(
        &mut self,
        word: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        self.is_begun = false;
        self.finish(on_output).map_err(|error| match error {
            AerError::Timeout(_) => AerError::Timeout(Phase::Idle),
            port @ AerError::Port(_) => port,
        })?;
        self.wait_for(false, self.polls, on_output)?;
        self.port.set_input(word)?;
        (self.phase, self.event, self.is_begun) = (Phase::Acknowledge, None, true);
        self.finish(on_output)
    }

    /// Brings the word under way to its end, if there is one.
    pub(super) fn finish(
        &mut self,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        self.finish_within(self.polls, on_output)
    }

    fn finish_within(
        &mut self,
        polls: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        if self.phase == Phase::Acknowledge {
            self.port.set_input_request(true)?;
            self.wait_for(true, polls, on_output)?;
            self.phase = Phase::Release;
        }
        if self.phase == Phase::Release {
            self.port.set_input_request(false)?;
            self.wait_for(false, polls, on_output)?;
            self.phase = Phase::Idle;
        }
        Ok(())
    }

    /// Waits for ACK. While an output event waits the chip acknowledges no input, so this serves the
    /// output bus as well.
    fn wait_for(
        &mut self,
        is_high: bool,
        polls: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        for _ in 0..polls {
            self.serve(on_output)?;
            if self.port.input_acknowledge()? == is_high {
                return Ok(());
            }
        }
        Err(AerError::Timeout(self.phase))
    }

    /// One step of the output bus's handshake, if the chip waits for one.
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
}
