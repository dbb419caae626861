//! The states of a `ReckOn` that runs: between samples, and within a sample, which consists of time steps.

use embedded_hal::spi::SpiDevice;

use super::{OPEN, Outcome, Programmed, ReckOn, ReckOnAnswers, ReckOnPort, ReckOnTask, State};
use crate::error::at_most;
use crate::{ChipError, Phase};

/// A `ReckOn` that runs and is between two samples.
#[derive(Debug)]
pub struct Started<'a, D, P> {
    pub(super) chip: &'a mut ReckOn<D, P>,
}

/// A `ReckOn` within a sample: it takes inputs and time steps.
#[derive(Debug)]
pub struct ReckOnSample<'a, D, P> {
    pub(super) chip: &'a mut ReckOn<D, P>,
}

/// The options of a time step. In a step with the default options, no output gets a point for the label, and the chip
/// does not learn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReckOnStep<'a> {
    /// Whether the output with the highest potential in this step gets a point. At the end of the sample, the output
    /// with the most points is the label.
    pub counts: bool,
    /// The target from which the chip learns in this step; `None` if it does not learn.
    pub target: Option<ReckOnTarget<'a>>,
}

/// The target from which the chip learns in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReckOnTarget<'a> {
    /// The number of the output that should have the highest potential. Give this target once in a sample.
    Label(u8),
    /// The potential that each output should have.
    Potentials(&'a [i16]),
}

/// An answer of the chip. [`ReckOnAnswers`] selects whether the chip sends a label or potentials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReckOnAnswer {
    /// The label: the number of the output with the most points, or the lowest such number if several outputs are
    /// equal. In each step with [`counts`](ReckOnStep::counts) set, the output with the highest potential gets a point.
    Label(u8),
    /// The outputs' potentials; 0 for outputs that the network does not have.
    Potentials([i16; 16]),
}

impl<'a, D: SpiDevice, P: ReckOnPort> Started<'a, D, P> {
    /// Begins a sample with a first tick, which sets all potentials to 0. If the chip does not take this tick, the
    /// first [`step`](ReckOnSample::step) or [`end`](ReckOnSample::end) returns the error.
    ///
    /// # Errors
    /// Returns an error if the chip is not ready, or if the port failed; then reset the chip.
    pub fn begin(self) -> Outcome<ReckOnSample<'a, D, P>, D, P> {
        let chip = self.chip;
        let result = begin(chip);
        chip.heed(result)?;
        chip.state = State::Sample;
        Ok(ReckOnSample { chip })
    }

    /// Stops the chip and opens its memories again, for example to read weights that the chip has learnt.
    ///
    /// # Errors
    /// Returns an error if the bus failed or is out of sync: then reset the chip.
    pub fn program(self) -> Outcome<Programmed<'a, D, P>, D, P> {
        let chip = self.chip;
        let result = chip.wire.configure(OPEN, 1);
        chip.heed_bus(result)?;
        chip.state = State::Programmed;
        chip.check_sync()?;
        Ok(Programmed { chip })
    }
}

impl<'a, D: SpiDevice, P: ReckOnPort> ReckOnSample<'a, D, P> {
    /// Sends a spike of an input. The spike acts after the next tick. An input that is sent twice within a step acts
    /// only once.
    ///
    /// # Errors
    /// Returns an error if the network has no such input. Also returns an error if the chip does not answer, or if the
    /// port failed: then reset the chip.
    pub fn send(&mut self, input: u8) -> Outcome<(), D, P> {
        at_most("input", input.into(), self.chip.sizes.input.into())?;
        self.chip.send(input, false)
    }

    /// Ends a time step and begins the next one. Waits until the chip is ready, sends a tick (a pulse of `TIME_TICK`),
    /// and takes the chip's answer, which proves that the chip has done the step. Returns the answer if the setting is
    /// [`PotentialsEachStep`](ReckOnAnswers::PotentialsEachStep), otherwise `None`.
    ///
    /// # Errors
    /// Returns an error if the target does not fit the network or the settings; nothing was sent then. Also returns an
    /// error if the chip does not take the tick or does not finish the step, or if the port failed: then reset the
    /// chip.
    pub fn step(&mut self, step: ReckOnStep<'_>) -> Outcome<Option<ReckOnAnswer>, D, P> {
        self.check(&step)?;
        let result = self.try_step(step);
        let answer = self.chip.heed(result)?;
        Ok(self.chip.settings.answers.is_each_step().then_some(answer))
    }

    /// Ends the sample with a last tick, which sets all potentials to 0, and returns the chip's answer.
    ///
    /// # Errors
    /// Returns an error if the chip does not finish, or if the port failed; then reset the chip.
    pub fn end(mut self) -> Outcome<(ReckOnAnswer, Started<'a, D, P>), D, P> {
        let result = self.try_end();
        let answer = self.chip.heed(result)?;
        self.chip.state = State::Started;
        Ok((answer, Started { chip: self.chip }))
    }

    fn check(&self, step: &ReckOnStep<'_>) -> Outcome<(), D, P> {
        let outputs = i64::from(self.chip.sizes.output) + 1;
        let wrong =
            |what, value| Err(ChipError::OutOfRange { what, value, min: outputs, max: outputs });
        match (step.target, self.chip.settings.task) {
            (None, _) => Ok(()),
            (Some(_), _) if self.chip.settings.learning.is_none() => wrong("learning", 0),
            (Some(ReckOnTarget::Label(label)), ReckOnTask::Classification) => {
                at_most("label", label.into(), self.chip.sizes.output.into())
            }
            (Some(ReckOnTarget::Potentials(targets)), ReckOnTask::Regression)
                if targets.len() as i64 == outputs =>
            {
                Ok(())
            }
            (Some(ReckOnTarget::Potentials(targets)), _) => wrong("targets", targets.len() as i64),
            (Some(ReckOnTarget::Label(_)), ReckOnTask::Regression) => wrong("targets", 1),
        }
    }

    fn try_step(&mut self, step: ReckOnStep<'_>) -> Outcome<ReckOnAnswer, D, P> {
        let chip = &mut *self.chip;
        chip.until_ready()?;
        chip.port.set_infer(step.counts).map_err(ChipError::Port)?;
        chip.port.set_target_valid(step.target.is_some()).map_err(ChipError::Port)?;
        let last = match step.target {
            Some(ReckOnTarget::Potentials(targets)) => targets.split_last(),
            Some(ReckOnTarget::Label(label)) => {
                chip.handshake(label, true)?;
                None
            }
            None => None,
        };
        let Some((last, targets)) = last else {
            chip.tick()?;
            return chip.finish();
        };
        for byte in targets.iter().flat_map(|target| target.to_le_bytes()) {
            chip.handshake(byte, true)?;
        }
        let [low, high] = last.to_le_bytes();
        chip.handshake(low, true)?;
        chip.tick()?;
        // The last byte counts only if it comes after the neurons have leaked. No pin shows that, so wait for the time
        // that it takes.
        for _ in 0..chip.reads(STEP_CLOCKS) {
            chip.port.ready().map_err(ChipError::Port)?;
        }
        chip.handshake(high, true)?;
        chip.finish()
    }

    fn try_end(&mut self) -> Outcome<ReckOnAnswer, D, P> {
        let chip = &mut *self.chip;
        chip.until_ready()?;
        chip.port.set_sample(false).map_err(ChipError::Port)?;
        chip.port.set_target_valid(false).map_err(ChipError::Port)?;
        chip.tick()?;
        chip.finish()
    }
}

/// Number of clock cycles from a tick until all neurons have leaked, with a margin.
const STEP_CLOCKS: u32 = 280;

/// Number of clock cycles from a tick until the ready pin has fallen, with a margin.
const TICK_CLOCKS: u32 = 16;

fn begin<D: SpiDevice, P: ReckOnPort>(chip: &mut ReckOn<D, P>) -> Outcome<(), D, P> {
    chip.port.set_infer(false).map_err(ChipError::Port)?;
    chip.port.set_target_valid(false).map_err(ChipError::Port)?;
    chip.port.set_sample(true).map_err(ChipError::Port)?;
    chip.until_ready()?;
    chip.port.set_tick(true).map_err(ChipError::Port)?;
    // The ready pin is low for as many clock cycles as there are inputs or neurons. Pins that are read rarely may miss
    // that, so the result is ignored: the answer to the first step proves this tick.
    chip.wait_ready(false, chip.reads(TICK_CLOCKS)).map_err(ChipError::Port)?;
    chip.port.set_tick(false).map_err(ChipError::Port)?;
    chip.until_ready()
}

impl<D: SpiDevice, P: ReckOnPort> ReckOn<D, P> {
    fn until_ready(&mut self) -> Outcome<(), D, P> {
        let is_ready = self.wait_ready(true, self.polls).map_err(ChipError::Port)?;
        if is_ready { Ok(()) } else { Err(ChipError::Unfinished) }
    }

    /// Sends a tick, and waits until the ready pin is low, which shows that the chip has taken the tick. Use this
    /// function only for ticks that the chip answers: the pin then stays low until the driver takes the answer, so that
    /// the driver cannot miss the low level.
    fn tick(&mut self) -> Outcome<(), D, P> {
        self.port.set_tick(true).map_err(ChipError::Port)?;
        let is_taken = self.wait_ready(false, self.polls).map_err(ChipError::Port)?;
        self.port.set_tick(false).map_err(ChipError::Port)?;
        if is_taken { Ok(()) } else { Err(ChipError::Handshake(Phase::Acknowledge)) }
    }

    /// Takes the bytes of the chip's answer until the step is done, and returns the answer.
    fn finish(&mut self) -> Outcome<ReckOnAnswer, D, P> {
        let mut bytes = [0; 32];
        let mut taken = 0_usize;
        for _ in 0..self.polls {
            if self.port.output_request().map_err(ChipError::Port)? {
                let byte = self.take()?;
                // Counts bytes beyond the longest answer without storing them; `answer` refuses such a count.
                if let Some(place) = bytes.get_mut(taken) {
                    *place = byte;
                }
                taken = taken.wrapping_add(1);
            } else if self.port.ready().map_err(ChipError::Port)? {
                return self.answer(bytes, taken);
            }
        }
        Err(ChipError::Unfinished)
    }

    fn take(&mut self) -> Outcome<u8, D, P> {
        let byte = self.port.output().map_err(ChipError::Port)?;
        self.port.set_output_acknowledge(true).map_err(ChipError::Port)?;
        for _ in 0..self.polls {
            if !self.port.output_request().map_err(ChipError::Port)? {
                self.port.set_output_acknowledge(false).map_err(ChipError::Port)?;
                return Ok(byte);
            }
        }
        Err(ChipError::Handshake(Phase::Release))
    }

    fn answer(&self, bytes: [u8; 32], taken: usize) -> Outcome<ReckOnAnswer, D, P> {
        let [first, ..] = bytes;
        let is_label = self.settings.answers == ReckOnAnswers::Label;
        let whole = 2 * (usize::from(self.sizes.output) + 1);
        match taken {
            1 if is_label => Ok(ReckOnAnswer::Label(first)),
            _ if taken == whole && !is_label => {
                let mut potentials = [0; 16];
                let (pairs, _) = bytes.as_chunks();
                for (potential, &bytes) in potentials.iter_mut().zip(pairs) {
                    *potential = i16::from_le_bytes(bytes);
                }
                Ok(ReckOnAnswer::Potentials(potentials))
            }
            // With no bytes at all, this tick began the sample, because the chip had missed the tick that should have
            // begun it.
            _ => Err(ChipError::Unfinished),
        }
    }
}
