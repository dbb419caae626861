//! A chip whose activity is gated, so that its memories can be accessed.

use embedded_hal::spi::SpiDevice;

use super::aer::{AerError, Carries};
use super::wire::Address;
use super::{AerPort, ChipError, Input, OdinChip, Outcome, Running, State};
use crate::error::at_most;

/// Number of the chip's clock cycles for which the driver waits for the answer to a probe. A probe is a time step of
/// one neuron, and takes 10 clock cycles.
const PROBE_CLOCKS: u32 = 1_000;

/// A gated chip: its memories can be accessed, and it takes no events. Its loop is open (spikes do not reach other
/// neurons), so that no write to memory makes a neuron fire.
///
/// **Checks:** a call reads the old bytes, writes the bytes that differ, and reads these back. Before and after the
/// writes it checks that chip and bus are in sync. Therefore the call returns an error if a clock pulse was lost or
/// doubled, and also if a lost and a doubled pulse cancel out. After such an error all memory is in doubt: reset the
/// chip, and write all of its memory again.
///
/// **Time:** writing a neuron of tinyODIN takes 23 frames of 5 bytes, 1.4 ms at an SCK of 656 kHz; writing a neuron of
/// ODIN takes 59 frames; writing a synapse takes 14 frames. For whole networks [`load`](Self::load) takes only 2 frames
/// for each byte.
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
    /// **Checks:** after each register the driver checks that chip and bus are in sync. It returns an error if a clock
    /// pulse was lost or doubled. It does not notice two faults that cancel out, if both lie between the start of the
    /// frame that writes a register and the end of the check. Such a pair may leave a wrong register or wrong
    /// potentials. Finally the driver sends a probe: a time step of one neuron, which only a running chip acknowledges.
    /// If that neuron leaks, the driver first moves its potential away from 0 by the leak, so that the probe leaves the
    /// neuron as it was.
    ///
    /// **Time:** 38 frames of 5 bytes for tinyODIN, 2.3 ms at an SCK of 656 kHz; 206 frames for ODIN. If the probed
    /// neuron leaks from a potential other than 0, the call takes 17 more frames. The driver skips each neuron that the
    /// probe could not leave as it was, for example because the neuron learns. A skipped neuron takes 4 (tinyODIN) or
    /// 16 (ODIN) more frames.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range. Returns [`NoProbe`](ChipError::NoProbe) if the driver would
    /// have to skip every neuron. After these two errors the chip is still gated. Also returns an error if the bus or
    /// the port failed, if memory reads back a wrong value, or if the chip does not answer; then reset the chip.
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

    /// Writes the parameters and the state of a neuron.
    ///
    /// # Errors
    /// Returns an error if a field is out of its range. Also returns an error if the bus failed, or if the neuron reads
    /// back differently: then reset the chip.
    pub fn set_neuron(&mut self, neuron: u8, value: &I::Neuron) -> Outcome<(), D, P> {
        let bytes = I::neuron_bytes(value)?;
        let bytes = (0..I::NEURON_BYTES).zip(bytes);
        self.chip.store(bytes.map(|(byte, value)| (Address::neuron(neuron, byte), 0, value)))
    }

    /// Reads the parameters and the state of a neuron. Checks that chip and bus are in sync: that no clock pulse was
    /// lost or doubled.
    ///
    /// # Errors
    /// Returns an error if the bus failed, or if chip and bus are out of sync: then reset the chip.
    pub fn neuron(&mut self, neuron: u8) -> Outcome<I::Neuron, D, P> {
        Ok(I::neuron(self.chip.fetch(bytes_of::<I>(neuron))?))
    }

    /// Reads a neuron, and returns an error unless its parameters and its state are those of `expected`.
    pub(super) fn expect_neuron(&mut self, neuron: u8, expected: &I::Neuron) -> Outcome<(), D, P> {
        let expected = I::neuron_bytes(expected)?;
        let read = self.chip.fetch(bytes_of::<I>(neuron))?;
        for ((address, read), written) in bytes_of::<I>(neuron).zip(read).zip(expected) {
            if read != written {
                self.chip.state = State::NotReset;
                let (written, read) = (written.into(), read.into());
                return Err(ChipError::ReadBack { address: address.number(), written, read });
            }
        }
        Ok(())
    }

    /// Writes the synapse from `pre` to `post`.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range. Also returns an error if the bus failed, or if the synapse
    /// reads back differently: then reset the chip.
    pub fn set_synapse(&mut self, pre: u8, post: u8, synapse: I::Synapse) -> Outcome<(), D, P> {
        let bits = I::synapse_bits(synapse)?;
        let (keep, value) = if post & 1 == 0 { (0xF0, bits) } else { (0x0F, bits << 4) };
        self.chip.store([(Address::synapse(pre, post), keep, value)].into_iter())
    }

    /// Reads the synapse from `pre` to `post`. Checks that chip and bus are in sync: that no clock pulse was lost or
    /// doubled.
    ///
    /// # Errors
    /// Returns an error if the bus failed, or if chip and bus are out of sync: then reset the chip.
    pub fn synapse(&mut self, pre: u8, post: u8) -> Outcome<I::Synapse, D, P> {
        let [byte, ..] = self.chip.fetch([Address::synapse(pre, post)].into_iter())?;
        Ok(I::synapse(if post & 1 == 0 { byte & 0xF } else { byte >> 4 }))
    }

    /// Writes a byte of a neuron, for fields that [`Input::Neuron`] does not contain.
    ///
    /// # Errors
    /// Returns an error if `byte` is not below [`Input::NEURON_BYTES`]. Also returns an error if the bus failed, or if
    /// the byte reads back differently: then reset the chip.
    pub fn set_neuron_byte(&mut self, neuron: u8, byte: u8, value: u8) -> Outcome<(), D, P> {
        at_most("byte", byte.into(), u32::from(I::NEURON_BYTES) - 1)?;
        self.chip.store([(Address::neuron(neuron, byte), 0, value)].into_iter())
    }

    /// Reads a byte of a neuron. Checks that chip and bus are in sync: that no clock pulse was lost or doubled.
    ///
    /// # Errors
    /// Returns an error if `byte` is not below [`Input::NEURON_BYTES`]. Also returns an error if the bus failed, or if
    /// chip and bus are out of sync: then reset the chip.
    pub fn neuron_byte(&mut self, neuron: u8, byte: u8) -> Outcome<u8, D, P> {
        at_most("byte", byte.into(), u32::from(I::NEURON_BYTES) - 1)?;
        let [value, ..] = self.chip.fetch([Address::neuron(neuron, byte)].into_iter())?;
        Ok(value)
    }

    /// Checks that the chip is gated and in sync with the bus. [`run`](Self::run) makes the same check.
    ///
    /// # Errors
    /// Returns an error if the bus failed, or if memory reads back a wrong value: then reset the chip.
    pub fn check_sync(&mut self) -> Outcome<(), D, P> {
        self.chip.check_sync()
    }
}

/// Returns the addresses of a neuron's bytes.
fn bytes_of<I: Input>(neuron: u8) -> impl Iterator<Item = Address> + Clone {
    (0..I::NEURON_BYTES).map(move |byte| Address::neuron(neuron, byte))
}

/// Chooses a neuron for the probe (a time step of this neuron alone), and returns its number. If the neuron leaks,
/// first moves its potential away from 0 by the leak, so that the probe leaves the neuron as it was.
fn prepare_probe<I: Input, D: SpiDevice, P: AerPort>(
    chip: &mut OdinChip<I, D, P>,
) -> Outcome<u8, D, P> {
    for neuron in (0..=I::PROBED).rev() {
        if I::before_step(&I::neuron(chip.read_bytes(bytes_of::<I>(neuron))?)).is_none() {
            continue;
        }
        // The first read was not checked: read the neuron again, with a check.
        let value = I::neuron(chip.fetch(bytes_of::<I>(neuron))?);
        let Some(before) = I::before_step(&value) else { continue };
        if before == value {
            return Ok(neuron);
        }
        // Memory that was never written may hold values that no valid neuron has.
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
    // A chip at rest has no outputs to pass on.
    let on_output = &mut |_| ();
    chip.aer.begin(word, Carries::Probe, on_output)?;
    let reads = chip.aer.reads(PROBE_CLOCKS);
    chip.aer.finish_within(reads, on_output).map_err(|error| match error {
        AerError::Timeout(_) => ChipError::NotStarted,
        AerError::Port(error) => ChipError::Port(error),
    })
}
