//! Address events over parallel wires, with the 4-phase handshake.

use core::num::NonZeroU32;

use super::AerPort;
use spikewire::Event;

/// The phase that a handshake has reached, or in which it timed out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// ACK is still high, or the previous word is still under way. This word was not sent.
    Idle,
    /// ACK has not risen after REQ. The word is under way: it stays on the bus, with REQ high, until the chip takes it or
    /// is reset.
    Acknowledge,
    /// ACK has not fallen after REQ fell. The chip has taken the word.
    Release,
}

/// Why a handshake did not end.
#[derive(Debug)]
pub(crate) enum AerError<E> {
    Port(E),
    Timeout(Phase),
}

impl<E> From<E> for AerError<E> {
    fn from(error: E) -> Self {
        Self::Port(error)
    }
}

/// The kind of the word under way.
#[derive(Clone, Copy, Debug)]
pub(super) enum Carries {
    /// A word from [`Running::send`](super::Running::send).
    Word,
    /// A probe, which a chip answers if it runs.
    Probe,
    /// A time step.
    Step,
    /// An event from [`Running::feed`](super::Running::feed).
    Event(Event),
}

/// The state of our ACK on the output bus. A call on the port that fails may still have changed the pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// Low: the next REQ is a new output.
    Idle,
    /// The output was passed to the caller; ACK may be high or low.
    Raising,
    /// High.
    High,
    /// REQ has fallen; ACK may be high or low.
    Lowering,
}

/// The microcontroller's side of both buses.
///
/// The chip reads the word for as long as it works on it, and then acknowledges any REQ that it finds. So a word stays
/// on the bus until it is acknowledged, over as many calls as that takes.
#[derive(Debug)]
pub(super) struct Aer<P> {
    pub(super) port: P,
    /// The number of reads of the pins in a wait, if one read takes a clock of the chip or longer.
    polls: u32,
    /// How often the pins may be read within one clock of the chip.
    looks_a_clock: NonZeroU32,
    /// The number of reads of the pins in a wait: the saturated product of `polls` and `looks_a_clock`, which a Cortex-M0
    /// would take long to compute.
    patience: u32,
    /// The phase of the word that was begun last.
    phase: Phase,
    carries: Carries,
    answer: Answer,
    is_full: bool,
    /// How often the queue was seen to become full.
    pub(super) overflows: u32,
}

impl<P: AerPort> Aer<P> {
    pub(super) const fn new(port: P, polls: u32) -> Self {
        Self {
            port,
            polls,
            looks_a_clock: NonZeroU32::MIN,
            patience: polls,
            phase: Phase::Idle,
            carries: Carries::Word,
            answer: Answer::Idle,
            is_full: false,
            overflows: 0,
        }
    }

    pub(super) fn set_looks_a_clock(&mut self, looks: NonZeroU32) {
        self.looks_a_clock = looks;
        self.patience = self.looks(self.polls);
    }

    /// How often to read the pins for this number of clocks.
    pub(super) fn looks(&self, clocks: u32) -> u32 {
        clocks.saturating_mul(self.looks_a_clock.get())
    }

    /// Raises reset while REQ stays as it is: if the chip takes the word meanwhile, it waits for REQ to fall, and the
    /// reset drops the word before it acts. Then both of our wires go low.
    ///
    /// Returns the word under way if no ACK was seen for it, and whether an output was lost.
    pub(super) fn reset(&mut self) -> Result<(Option<Carries>, bool), P::Error> {
        if self.phase == Phase::Acknowledge && matches!(self.port.input_acknowledge(), Ok(true)) {
            self.phase = Phase::Release;
        }
        let is_output_lost =
            self.answer == Answer::Idle && matches!(self.port.output_request(), Ok(true));
        self.port.set_reset(true)?;
        self.port.set_input_request(false)?;
        self.port.set_output_acknowledge(false)?;
        let is_under_way = self.phase == Phase::Acknowledge;
        (self.phase, self.answer) = (Phase::Idle, Answer::Idle);
        Ok((is_under_way.then_some(self.carries), is_output_lost))
    }

    /// Advances the handshakes of both buses as far as a few reads of the pins allow.
    pub(super) fn poll(&mut self, on_output: &mut impl FnMut(u8)) -> Result<(), P::Error> {
        // ACK up, and down again.
        for _ in 0..2 {
            self.serve(on_output)?;
        }
        match self.finish_within(1, on_output) {
            Ok(()) | Err(AerError::Timeout(_)) => Ok(()),
            Err(AerError::Port(error)) => Err(error),
        }
    }

    /// Puts a word on the bus, after the one before it has ended. After an error the word is not under way.
    pub(super) fn begin(
        &mut self,
        word: u32,
        carries: Carries,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        self.finish(on_output).map_err(|error| match error {
            AerError::Timeout(_) => AerError::Timeout(Phase::Idle),
            port @ AerError::Port(_) => port,
        })?;
        self.wait_for(false, self.patience, on_output)?;
        self.port.set_input(word)?;
        (self.phase, self.carries) = (Phase::Acknowledge, carries);
        Ok(())
    }

    /// Ends the handshake of the word under way, if there is one.
    pub(super) fn finish(
        &mut self,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), AerError<P::Error>> {
        self.finish_within(self.patience, on_output)
    }

    pub(super) fn finish_within(
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

    /// Waits until the output bus has been idle for this many reads of the pins in a row; false after `limit` reads.
    pub(super) fn rest(
        &mut self,
        looks: u32,
        limit: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<bool, P::Error> {
        let mut still = 0;
        for _ in 0..limit {
            if still >= looks {
                return Ok(true);
            }
            let was_idle = self.answer == Answer::Idle;
            self.serve(on_output)?;
            let is_still = was_idle && self.answer == Answer::Idle;
            still = if is_still { still + 1 } else { 0 };
        }
        Ok(false)
    }

    /// Waits for ACK. The chip acknowledges no input while an output waits, so this also serves the output bus.
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

    /// Does one step of the output bus's handshake, if the chip waits for it.
    fn serve(&mut self, on_output: &mut impl FnMut(u8)) -> Result<(), P::Error> {
        if let Some(is_full) = self.port.queue_full()? {
            self.overflows = self.overflows.saturating_add((is_full && !self.is_full).into());
            self.is_full = is_full;
        }
        match (self.port.output_request()?, self.answer) {
            (true, Answer::Idle) => {
                on_output(self.port.output()?);
                self.raise()
            }
            (true, Answer::Raising) => self.raise(),
            (false, Answer::Raising | Answer::High) | (_, Answer::Lowering) => {
                self.answer = Answer::Lowering;
                self.port.set_output_acknowledge(false)?;
                self.answer = Answer::Idle;
                Ok(())
            }
            (true, Answer::High) | (false, Answer::Idle) => Ok(()),
        }
    }

    fn raise(&mut self) -> Result<(), P::Error> {
        self.answer = Answer::Raising;
        self.port.set_output_acknowledge(true)?;
        self.answer = Answer::High;
        Ok(())
    }
}
