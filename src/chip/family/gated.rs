//! A chip whose activity is gated, so that its memories can be accessed.

use embedded_hal::spi::SpiDevice;

use super::aer::{AerError, Carries};
use super::wire::Address;
use super::{AerPort, ChipError, Input, OdinChip, Outcome, Running, State};
use crate::chip::error::at_most;

/// The least number of times that the probe reads the pins. A time step of one neuron takes the chip 10 clocks.
const PROBE_LOOKS: u32 = 1_000;

/// A gated chip: its memories can be accessed, and it takes no events. Its loop is open, so that no write makes a
/// neuron fire.
///
/// Every write is read back, and every call checks with 5 more frames that chip and bus are in step: one clock lost or
/// doubled is an error. For whole networks [`load`](Self::load) takes 2 frames a byte. After such an error all memory is
/// in doubt: reset the chip, and write all of it again.
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
    /// **Verified:** after every register chip and bus must be in step, so that one clock lost or doubled is an error; two
    /// faults that cancel out within a register's frame and its check go unseen. Then the chip must answer a time step
    /// of neuron [`Input::PROBED`], which shows that the gate is open. This probe is left out if it would change the
    /// network: if that neuron is in use, and leaks or is at its threshold.
    ///
    /// **Time:** 24 frames of 5 bytes for tinyODIN, 1.5 ms at 656 kHz; 168 for ODIN.
    ///
    /// # Errors
    /// A value is out of its range; or the bus or the port failed, or the chip does not read back or answer: then reset
    /// it.
    pub fn run(self, registers: &I::Registers) -> Outcome<Running<'a, I, D, P>, D, P> {
        I::check_registers(registers)?;
        let chip = self.chip;
        let is_probed = I::is_unmoved(&read_neuron(chip, I::PROBED)?);
        I::each_register(registers, |register, value| chip.configure_checked(register, value))?;
        chip.open()?;
        chip.state = State::NotReset;
        if is_probed {
            probe(chip)?;
        }
        chip.registers = Some(*registers);
        chip.state = State::Running;
        Ok(Running::new(chip))
    }

    /// Writes a neuron's parameters and state.
    ///
    /// # Errors
    /// The value is out of its range; or the bus failed, or it does not read back: then reset the chip.
    pub fn set_neuron(&mut self, neuron: u8, value: &I::Neuron) -> Outcome<(), D, P> {
        let bytes = I::neuron_bytes(value)?;
        for (byte, value) in (0..I::NEURON_BYTES).zip(bytes) {
            self.chip.write_byte(Address::neuron(neuron, byte), 0, value)?;
        }
        self.chip.check_step()
    }

    /// Reads a neuron's parameters and state, and checks that the bus is in step.
    ///
    /// # Errors
    /// The bus failed or is out of step: then reset the chip.
    pub fn neuron(&mut self, neuron: u8) -> Outcome<I::Neuron, D, P> {
        let value = read_neuron(self.chip, neuron)?;
        self.chip.check_step()?;
        Ok(value)
    }

    /// Writes the synapse from `pre` to `post`.
    ///
    /// # Errors
    /// The value is out of its range; or the bus failed, or it does not read back: then reset the chip.
    pub fn set_synapse(&mut self, pre: u8, post: u8, synapse: I::Synapse) -> Outcome<(), D, P> {
        let bits = I::synapse_bits(synapse)?;
        let (keep, value) = if post & 1 == 0 { (0xF0, bits) } else { (0x0F, bits << 4) };
        self.chip.write_byte(Address::synapse(pre, post), keep, value)?;
        self.chip.check_step()
    }

    /// Reads the synapse from `pre` to `post`, and checks that the bus is in step.
    ///
    /// # Errors
    /// The bus failed or is out of step: then reset the chip.
    pub fn synapse(&mut self, pre: u8, post: u8) -> Outcome<I::Synapse, D, P> {
        let byte = self.chip.read_byte(Address::synapse(pre, post))?;
        self.chip.check_step()?;
        Ok(I::synapse(if post & 1 == 0 { byte & 0xF } else { byte >> 4 }))
    }

    /// Writes a byte of a neuron, for fields that [`Input::Neuron`] does not have.
    ///
    /// # Errors
    /// There is no such byte, the bus failed, or it does not read back: then reset the chip.
    pub fn set_neuron_byte(&mut self, neuron: u8, byte: u8, value: u8) -> Outcome<(), D, P> {
        at_most("byte", byte.into(), u32::from(I::NEURON_BYTES) - 1)?;
        self.chip.write_byte(Address::neuron(neuron, byte), 0, value)?;
        self.chip.check_step()
    }

    /// Reads a byte of a neuron, and checks that the bus is in step.
    ///
    /// # Errors
    /// There is no such byte, or the bus failed or is out of step: then reset the chip.
    pub fn neuron_byte(&mut self, neuron: u8, byte: u8) -> Outcome<u8, D, P> {
        at_most("byte", byte.into(), u32::from(I::NEURON_BYTES) - 1)?;
        let value = self.chip.read_byte(Address::neuron(neuron, byte))?;
        self.chip.check_step()?;
        Ok(value)
    }

    /// Checks that the chip is gated and in step, which [`run`](Self::run) does too.
    ///
    /// # Errors
    /// The bus failed, or the chip does not read back what is written: then reset it.
    pub fn check_step(&mut self) -> Outcome<(), D, P> {
        self.chip.check_step()
    }
}

fn read_neuron<I: Input, D: SpiDevice, P: AerPort>(
    chip: &mut OdinChip<I, D, P>,
    neuron: u8,
) -> Outcome<I::Neuron, D, P> {
    let mut bytes = [0; 16];
    for (byte, value) in (0..I::NEURON_BYTES).zip(&mut bytes) {
        let address = Address::neuron(neuron, byte);
        *value = chip.read_byte(address)?;
        chip.note(address, 0xFF, *value);
    }
    Ok(I::neuron(bytes))
}

fn probe<I: Input, D: SpiDevice, P: AerPort>(chip: &mut OdinChip<I, D, P>) -> Outcome<(), D, P> {
    let word = I::PROBE.word()?;
    // At rest there are no outputs.
    let on_output = &mut |_| ();
    chip.aer.begin(word, Carries::Probe, on_output)?;
    let looks = PROBE_LOOKS.saturating_mul(chip.looks_a_clock.get());
    chip.aer.finish_within(looks, on_output).map_err(|error| match error {
        AerError::Timeout(_) => ChipError::NotStarted,
        AerError::Port(error) => ChipError::Port(error),
    })
}
