//! A chip whose activity is gated, so that its memories can be accessed.

use embedded_hal::spi::SpiDevice;

use super::aer::{AerError, Carries};
use super::wire::Address;
use super::{AerPort, ChipError, Input, OdinChip, Outcome, Running, State};
use crate::error::at_most;

/// Time that the probe waits, in clocks of the chip; a time step of one neuron takes 10.
const PROBE_CLOCKS: u32 = 1_000;

/// A gated chip. Its memories can be accessed, and it takes no events. Its loop is open, so that no write makes a
/// neuron fire.
///
/// **Checks:** a call reads the old bytes, writes those that differ, and reads them back. Frames before and after the
/// writes check that chip and bus are in step. Therefore one lost or doubled clock is an error, and so are a lost and a
/// doubled clock that cancel out. After such an error all memory is in doubt: reset the chip, and write all of it
/// again.
///
/// **Time:** a neuron of tinyODIN takes 23 frames of 5 bytes, 1.4 ms at 656 kHz, and a synapse 14; a neuron of ODIN
/// takes 59. For whole networks [`load`](Self::load) takes 2 frames for each byte.
#[derive(Debug)]
pub struct Gated<'a, I: Input, D, P> {
    pub(super) chip: &'a mut OdinChip<I, D, P>,
}

impl<'a, I: Input, D: SpiDevice, P: AerPort> Gated<'a, I, D, P> {
    pub(super) fn new(chip: &'a mut OdinChip<I, D, P>) -> Self {
        Self { chip }
    }

    /// Writes the registers and lets the chip run.
    ///
    /// **Checks:** chip and bus must be in step after each register, so that one lost or doubled clock is an error. Two
    /// faults that cancel out within a register's frame and its check go unseen, and may leave a wrong register, or
    /// wrong potentials. Then the chip must answer a time step of one neuron, which shows that the gate is open. If
    /// that neuron leaks, its potential is raised by the leak beforehand, so that the network is unchanged.
    ///
    /// **Time:** 38 frames of 5 bytes for tinyODIN, 2.3 ms at 656 kHz; 206 for ODIN. If the probed neuron leaks from a
    /// potential other than 0, 17 more; for each neuron that cannot be probed, 4 or 16 more.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range, or [`NoProbe`](ChipError::NoProbe): the chip is still gated.
    /// Also returns an error if the bus or the port failed, or if the chip does not read back or answer: then reset it.
    pub fn run(self, registers: &I::Registers) -> Outcome<Running<'a, I, D, P>, D, P> {
        I::check_registers(registers)?;
        let chip = self.chip;
        let probed = prepare_probe(chip)?;
        I::each_register(registers, |register, value| chip.configure_checked(register, value))?;
        chip.open()?;
        chip.state = State::NotReset;
        probe(chip, probed)?;
        chip.registers = Some(*registers);
        chip.state = State::Running;
        Ok(Running::new(chip))
    }

    /// Writes a neuron's parameters and state.
    ///
    /// # Errors
    /// Returns an error if the value is out of its range. Also returns an error if the bus failed, or if the neuron
    /// reads back differently: then reset the chip.
    pub fn set_neuron(&mut self, neuron: u8, value: &I::Neuron) -> Outcome<(), D, P> {
        let bytes = I::neuron_bytes(value)?;
        let bytes = (0..I::NEURON_BYTES).zip(bytes);
        self.chip.store(bytes.map(|(byte, value)| (Address::neuron(neuron, byte), 0, value)))
    }

    /// Reads a neuron's parameters and state, and checks that the bus is in step.
    ///
    /// # Errors
    /// Returns an error if the bus failed or is out of step: then reset the chip.
    pub fn neuron(&mut self, neuron: u8) -> Outcome<I::Neuron, D, P> {
        Ok(I::neuron(self.chip.fetch(bytes_of::<I>(neuron))?))
    }

    /// Writes the synapse from `pre` to `post`.
    ///
    /// # Errors
    /// Returns an error if the value is out of its range. Also returns an error if the bus failed, or if the synapse
    /// reads back differently: then reset the chip.
    pub fn set_synapse(&mut self, pre: u8, post: u8, synapse: I::Synapse) -> Outcome<(), D, P> {
        let bits = I::synapse_bits(synapse)?;
        let (keep, value) = if post & 1 == 0 { (0xF0, bits) } else { (0x0F, bits << 4) };
        self.chip.store([(Address::synapse(pre, post), keep, value)].into_iter())
    }

    /// Reads the synapse from `pre` to `post`, and checks that the bus is in step.
    ///
    /// # Errors
    /// Returns an error if the bus failed or is out of step: then reset the chip.
    pub fn synapse(&mut self, pre: u8, post: u8) -> Outcome<I::Synapse, D, P> {
        let [byte, ..] = self.chip.fetch([Address::synapse(pre, post)].into_iter())?;
        Ok(I::synapse(if post & 1 == 0 { byte & 0xF } else { byte >> 4 }))
    }

    /// Writes a byte of a neuron, for fields that [`Input::Neuron`] does not have.
    ///
    /// # Errors
    /// Returns an error if there is no such byte. Also returns an error if the bus failed, or if the byte reads back
    /// differently: then reset the chip.
    pub fn set_neuron_byte(&mut self, neuron: u8, byte: u8, value: u8) -> Outcome<(), D, P> {
        at_most("byte", byte.into(), u32::from(I::NEURON_BYTES) - 1)?;
        self.chip.store([(Address::neuron(neuron, byte), 0, value)].into_iter())
    }

    /// Reads a byte of a neuron, and checks that the bus is in step.
    ///
    /// # Errors
    /// Returns an error if there is no such byte. Also returns an error if the bus failed or is out of step: then reset
    /// the chip.
    pub fn neuron_byte(&mut self, neuron: u8, byte: u8) -> Outcome<u8, D, P> {
        at_most("byte", byte.into(), u32::from(I::NEURON_BYTES) - 1)?;
        let [value, ..] = self.chip.fetch([Address::neuron(neuron, byte)].into_iter())?;
        Ok(value)
    }

    /// Checks that the chip is gated and in step, which [`run`](Self::run) does too.
    ///
    /// # Errors
    /// Returns an error if the bus failed, or the chip does not read back what is written: then reset it.
    pub fn check_step(&mut self) -> Outcome<(), D, P> {
        self.chip.check_step()
    }
}

/// Returns the addresses of a neuron's bytes.
fn bytes_of<I: Input>(neuron: u8) -> impl Iterator<Item = Address> + Clone {
    (0..I::NEURON_BYTES).map(move |byte| Address::neuron(neuron, byte))
}

/// Finds a neuron that a time step can leave unchanged, and raises its potential by the leak that the step will take.
fn prepare_probe<I: Input, D: SpiDevice, P: AerPort>(
    chip: &mut OdinChip<I, D, P>,
) -> Outcome<u8, D, P> {
    for neuron in (0..=I::PROBED).rev() {
        if I::before_step(&I::neuron(chip.read_bytes(bytes_of::<I>(neuron))?)).is_none() {
            continue;
        }
        // Read once more, and checked.
        let value = I::neuron(chip.fetch(bytes_of::<I>(neuron))?);
        let Some(before) = I::before_step(&value) else { continue };
        if before == value {
            return Ok(neuron);
        }
        // Memory that was never written may hold what no neuron has.
        let bytes = (I::neuron_bytes::<(), ()>(&value), I::neuron_bytes::<(), ()>(&before));
        let (Ok(now), Ok(before)) = bytes else { continue };
        let bytes = bytes_of::<I>(neuron).zip(now.into_iter().zip(before));
        let moved = bytes.filter(|(_, (now, before))| now != before);
        chip.store(moved.map(|(address, (now, before))| (address, !(now ^ before), before)))?;
        return Ok(neuron);
    }
    Err(ChipError::NoProbe)
}

fn probe<I: Input, D: SpiDevice, P: AerPort>(
    chip: &mut OdinChip<I, D, P>,
    neuron: u8,
) -> Outcome<(), D, P> {
    let word = I::probe(neuron).word()?;
    // At rest there are no outputs.
    let on_output = &mut |_| ();
    chip.aer.begin(word, Carries::Probe, on_output)?;
    let looks = chip.aer.looks(PROBE_CLOCKS);
    chip.aer.finish_within(looks, on_output).map_err(|error| match error {
        AerError::Timeout(_) => ChipError::NotStarted,
        AerError::Port(error) => ChipError::Port(error),
    })
}
