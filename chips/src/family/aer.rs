//! Sends and receives address events over parallel wires, with the 4-phase handshake.

use core::num::NonZeroU32;

use super::AerPort;
use spikewire::Event;

/// The phase that a handshake has reached, or in which it timed out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// ACK is still high, or the previous word is not finished. This word was not sent.
    Idle,
    /// ACK did not rise after REQ. The word is pending: it stays on the bus, with REQ high, until the chip takes it or
    /// is reset.
    Acknowledge,
    /// ACK did not fall after REQ fell. The chip has taken the word.
    Release,
}

/// The reason that a handshake did not end.
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

/// The kind of the pending word.
#[derive(Clone, Copy, Debug)]
pub(super) enum Carries {
    /// A word from [`Running::send`](super::Running::send).
    Word,
    /// A probe, which a chip answers only if it runs.
    Probe,
    /// A time step.
    Step,
    /// An event from [`Running::feed`](super::Running::feed).
    Event(Event),
}

/// The state of our ACK on the output bus. It is uncertain after a call on the port that failed, which may have changed
/// the pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// Low; the next REQ is a new output.
    Idle,
    /// Being raised: the output was passed to the caller, and ACK may be high or low.
    Raising,
    /// High.
    High,
    /// Being lowered: REQ has fallen, and ACK may be high or low.
    Lowering,
}

/// The microcontroller's side of the input bus and the output bus.
///
/// The chip reads the word for as long as it works on it, and then acknowledges any REQ that it finds. Therefore a word
/// stays on the bus until it is acknowledged, over as many calls as that takes.
#[derive(Debug)]
pub(super) struct Aer<P> {
    pub(super) port: P,
    /// Number of reads of the pins in a wait, if one read takes at least a clock of the chip.
    polls: u32,
    /// Number of reads of the pins that fit into one clock of the chip.
    looks_a_clock: NonZeroU32,
    /// Number of reads of the pins in a wait: the saturated product of `polls` and `looks_a_clock`, stored because a
    /// Cortex-M0 is slow to compute it.
    patience: u32,
    /// Phase of the last word.
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

    /// Returns the number of reads of the pins that take at least this many clocks of the chip.
    pub(super) fn looks(&self, clocks: u32) -> u32 {
        clocks.saturating_mul(self.looks_a_clock.get())
    }

    /// Raises reset while REQ stays as it is, then lowers both of our wires. If the chip takes the pending word
    /// meanwhile, it waits for REQ to fall, and the reset drops the word before it acts.
    ///
    /// Returns the pending word if no ACK was seen for it, and whether an output was lost.
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

    /// Puts a word on the bus, after the one before it has ended. On an error the word is not pending.
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

    /// Ends the handshake of the pending word, if there is one.
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

    /// Waits until the output bus was idle for `looks` reads of the pins in a row; returns false if that does not
    /// happen within `limit` reads.
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

    /// Waits for ACK to reach a level. The chip acknowledges no input while an output waits, so this also serves the
    /// output bus.
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

    /// Advances the output bus's handshake by one step, if the chip waits for it.
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
