//! Sends and receives the words of the chip's event buses over parallel wires, with the 4-phase handshake.

use core::num::NonZeroU32;

use super::AerPort;
use spikewire::Event;

/// A phase of the 4-phase handshake of an input word. An error names the phase in which the chip did not answer in
/// time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// The handshake of the new word has not begun: ACK is still high from the previous word, or the previous word's
    /// handshake has not ended. The new word was not sent.
    Idle,
    /// REQ rose, and ACK has not risen yet. The word is pending: it stays on the bus, with REQ high, until the chip
    /// takes it or is reset.
    Acknowledge,
    /// REQ fell, and ACK has not fallen yet. The chip has taken the word.
    Release,
}

/// The reason that a handshake failed.
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

/// The origin of the input word whose handshake has not ended.
#[derive(Clone, Copy, Debug)]
pub(super) enum Carries {
    /// A word from [`Running::send`](super::Running::send).
    Word,
    /// A probe: a word that the chip acknowledges only if the chip runs.
    Probe,
    /// A leak event, which is a time step.
    Step,
    /// An event from [`Running::feed`](super::Running::feed).
    Event(Event),
}

/// State of the output bus's ACK. The driver controls this pin; after a port call that failed, the level of the pin is
/// unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// ACK is low; the next REQ announces a new output.
    Idle,
    /// ACK is being raised. The output was passed to the caller; ACK may be high or low.
    Raising,
    /// ACK is high.
    High,
    /// ACK is being lowered. REQ has fallen; ACK may be high or low.
    Lowering,
}

/// The microcontroller's side of the input bus and the output bus.
///
/// The chip reads the word on its input bus for as long as it works on that word. When it is done and REQ is high, it
/// raises ACK, even if the word on the bus was replaced meanwhile. Therefore the driver leaves a word on the bus until
/// the chip acknowledges it, even if that takes several calls.
#[derive(Debug)]
pub(super) struct Aer<P> {
    pub(super) port: P,
    /// Number of pin reads before a wait times out, not yet multiplied by `reads_per_clock`.
    polls: u32,
    /// Number of pin reads that fit into one clock cycle of the chip.
    reads_per_clock: NonZeroU32,
    /// Number of pin reads before a wait times out: the product of `polls` and `reads_per_clock`, saturated. Stored
    /// because a Cortex-M0 is slow to compute it.
    patience: u32,
    /// Phase that the handshake of the last word has reached.
    phase: Phase,
    carries: Carries,
    answer: Answer,
    is_full: bool,
    /// Number of times that the chip's queue was seen to become full.
    pub(super) overflows: u32,
}

impl<P: AerPort> Aer<P> {
    pub(super) const fn new(port: P, polls: u32) -> Self {
        Self {
            port,
            polls,
            reads_per_clock: NonZeroU32::MIN,
            patience: polls,
            phase: Phase::Idle,
            carries: Carries::Word,
            answer: Answer::Idle,
            is_full: false,
            overflows: 0,
        }
    }

    pub(super) fn set_reads_per_clock(&mut self, reads: NonZeroU32) {
        self.reads_per_clock = reads;
        self.patience = self.reads(self.polls);
    }

    /// Returns the number of pin reads that take at least `clocks` clock cycles of the chip.
    pub(super) fn reads(&self, clocks: u32) -> u32 {
        clocks.saturating_mul(self.reads_per_clock.get())
    }

    /// Raises the chip's reset, and only then lowers the input bus's REQ and the output bus's ACK. The order matters if
    /// the chip takes the pending word at this moment: the chip then waits for REQ to fall, and the reset drops the
    /// word before the word has an effect.
    ///
    /// Returns the origin of the word that the reset drops; `None` if no word was pending, or if the driver has seen an
    /// ACK for the word. Also returns whether an output was lost.
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

    /// Advances the handshakes of both buses with a few pin reads, and does not wait for the chip.
    pub(super) fn poll(&mut self, on_output: &mut impl FnMut(u8)) -> Result<(), P::Error> {
        // The first call raises ACK, the second lowers it.
        for _ in 0..2 {
            self.serve(on_output)?;
        }
        match self.finish_within(1, on_output) {
            Ok(()) | Err(AerError::Timeout(_)) => Ok(()),
            Err(AerError::Port(error)) => Err(error),
        }
    }

    /// Ends the handshake of the previous word, then puts `word` on the input bus. If the call returns an error, `word`
    /// is not pending.
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

    /// Ends the handshake of the pending word, if a word is pending.
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

    /// Waits until the output bus was idle for `reads` pin reads in a row. Returns false if that does not happen within
    /// `limit` reads.
    pub(super) fn rest(
        &mut self,
        reads: u32,
        limit: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<bool, P::Error> {
        let mut still = 0;
        for _ in 0..limit {
            if still >= reads {
                return Ok(true);
            }
            let was_idle = self.answer == Answer::Idle;
            self.serve(on_output)?;
            let is_still = was_idle && self.answer == Answer::Idle;
            still = if is_still { still + 1 } else { 0 };
        }
        Ok(false)
    }

    /// Waits until the input bus's ACK has the level `is_high`. Serves the output bus meanwhile, because the chip
    /// acknowledges no input while one of its outputs waits.
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

    /// Advances the output bus's handshake by at most one edge of ACK: raises ACK after REQ rose, or lowers ACK after
    /// REQ fell. Also counts an overflow if the chip's queue has become full since the last call.
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
