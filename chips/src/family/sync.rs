//! Checks that the chip is gated (its activity is stopped) and in sync with the bus. Reads and writes memory with these
//! checks.

use embedded_hal::spi::SpiDevice;

use super::wire::Address;
use super::{AerPort, ChipError, Input, OdinChip, Outcome, State};

/// Number of the register that gates the chip's activity.
const GATE_ACTIVITY: u16 = 0;

/// Mask of the bit that disables a neuron, in the neuron's last byte.
pub(super) const DISABLE: u8 = 0x80;

/// A byte of a neuron's parameters that is known not to be 0. If the bus is out of sync, a read of this byte returns
/// 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beacon {
    address: Address,
    mask: u8,
    value: u8,
}

/// The byte that the sync check writes. A bus that is out of sync by one bit does not read this byte.
const SIGN: u8 = 0xA5;

/// Returns the address that the sync check writes to.
fn anchor() -> Address {
    Address::synapse(255, 249)
}

impl<I: Input, D: SpiDevice, P: AerPort> OdinChip<I, D, P> {
    /// Gates a chip at rest, and opens its loop, so that spikes no longer reach other neurons. Then checks that the
    /// chip is gated and in sync with the bus.
    pub(super) fn shut(&mut self) -> Outcome<(), D, P> {
        self.state = State::NotReset;
        self.registers = None;
        self.wire.configure(GATE_ACTIVITY, 1).map_err(ChipError::Bus)?;
        self.wire.configure(I::OPEN_LOOP, 1).map_err(ChipError::Bus)?;
        self.state = State::Gated;
        self.check_sync()
    }

    /// Opens the gate, which lets the chip run. First reads a byte that does not exist, to protect the neurons' bytes.
    /// If the gate is later shut while tinyODIN works, the chip overwrites one byte in each neuron that it has not
    /// processed yet: the byte with the index that SPI accessed last. After this read, the last index is one that no
    /// neuron has, so that nothing is overwritten.
    pub(super) fn open(&mut self) -> Outcome<(), D, P> {
        self.read_byte(Address::nowhere())?;
        self.configure(GATE_ACTIVITY, 0)
    }

    /// Finds a byte that is not 0 among the parameters of neuron [`Input::PROBED`], and stores it as the [`Beacon`]. If
    /// all parameters are 0, as in a neuron that was never written, first disables the neuron, which sets a bit in one
    /// of the bytes. Checks that chip and bus are in sync.
    pub(super) fn find_beacon(&mut self) -> Outcome<(), D, P> {
        let last = I::NEURON_BYTES.saturating_sub(1);
        for byte in (0..=last).rev() {
            let address = Address::neuron(I::PROBED, byte);
            let value = self.read_byte(address)?;
            self.note(address, 0xFF, value);
            if self.beacon.is_some() {
                return self.check_sync();
            }
        }
        self.store([(Address::neuron(I::PROBED, last), !DISABLE, DISABLE)].into_iter())
    }

    /// Writes a register, which cannot be read back, and checks that chip and bus are still in sync.
    pub(super) fn configure_checked(&mut self, register: u16, value: u32) -> Outcome<(), D, P> {
        self.configure(register, value)?;
        self.check_sync()
    }

    /// Checks that chip and bus are in sync. Changes a byte in the memory of synapses and reads it, then restores the
    /// byte and reads it again. Between the two reads, reads the [`Beacon`] if one is stored: this byte is not 0, but a
    /// chip that is out of sync sends 0. Returns an error if the chip runs, or after a lost or doubled clock pulse.
    pub(super) fn check_sync(&mut self) -> Outcome<(), D, P> {
        let value = match self.anchor {
            Some(value) => value,
            None => self.read_byte(anchor())?,
        };
        let other = if value == SIGN { !SIGN } else { SIGN };
        self.put_byte(anchor(), 0, other)?;
        self.expect_byte(anchor(), 0, other)?;
        self.put_byte(anchor(), 0, value)?;
        if let Some(Beacon { address, mask, value }) = self.beacon {
            self.expect_byte(address, !mask, value)?;
        }
        self.expect_byte(anchor(), 0, value)?;
        self.anchor = Some(value);
        Ok(())
    }

    pub(super) fn configure(&mut self, register: u16, value: u32) -> Outcome<(), D, P> {
        self.expect_gated()?;
        let result = self.wire.configure(register, value);
        self.heed(result)
    }

    /// Writes bytes, then checks that chip and bus are in sync, and reads the bytes back. Each item of `bytes` is an
    /// address, a mask and a value; bits that are 1 in the mask keep their value in memory.
    ///
    /// A fault can divert a write to another address; the byte at the intended address then stays unchanged. The driver
    /// can notice this only if the new value differs from the old one. Therefore it first reads the old bytes, checks
    /// that chip and bus are in sync, and writes only the bytes that change. At the end it compares whole bytes,
    /// including the bits that keep their value.
    pub(super) fn store(
        &mut self,
        bytes: impl Iterator<Item = (Address, u8, u8)> + Clone,
    ) -> Outcome<(), D, P> {
        let old = self.read_bytes(bytes.clone().map(|(address, ..)| address))?;
        self.check_sync()?;
        let bytes = bytes
            .zip(old)
            .map(|((address, keep, value), old)| (address, keep, old, old & keep | value & !keep));
        let mut differing = bytes.clone().filter(|(_, _, old, new)| old != new).peekable();
        if differing.peek().is_some() {
            for (address, keep, _, new) in differing {
                self.put_byte(address, keep, new & !keep)?;
            }
            self.check_sync()?;
        }
        for (address, _, _, new) in bytes {
            self.expect_byte(address, 0, new)?;
        }
        self.expect_anchor()
    }

    /// Reads up to 16 bytes, checks that chip and bus are in sync, then reads the bytes again and compares them.
    pub(super) fn fetch(
        &mut self,
        addresses: impl Iterator<Item = Address> + Clone,
    ) -> Outcome<[u8; 16], D, P> {
        let bytes = self.read_bytes(addresses.clone())?;
        self.check_sync()?;
        for (address, byte) in addresses.zip(bytes) {
            self.expect_byte(address, 0, byte)?;
        }
        self.expect_anchor()?;
        Ok(bytes)
    }

    /// Reads again the byte that the sync check wrote, because two faults in the last frames of the check may cancel
    /// out: the check then succeeds although this byte is wrong.
    fn expect_anchor(&mut self) -> Outcome<(), D, P> {
        match self.anchor {
            Some(value) => self.expect_byte(anchor(), 0, value),
            None => Ok(()),
        }
    }

    /// Reads up to 16 bytes, which may be wrong if the bus is out of sync.
    pub(super) fn read_bytes(
        &mut self,
        addresses: impl Iterator<Item = Address>,
    ) -> Outcome<[u8; 16], D, P> {
        let mut bytes = [0; 16];
        for (address, byte) in addresses.zip(&mut bytes) {
            *byte = self.read_byte(address)?;
            self.note(address, 0xFF, *byte);
        }
        Ok(bytes)
    }

    /// Writes `value` to a byte of memory. Bits that are 1 in the mask `keep` keep their value.
    pub(super) fn put_byte(&mut self, address: Address, keep: u8, value: u8) -> Outcome<(), D, P> {
        self.expect_gated()?;
        if address == anchor() {
            self.anchor = self.anchor.map(|old| old & keep | value & !keep);
        }
        self.beacon = self.beacon.filter(|beacon| beacon.address != address);
        self.note(address, !keep, value);
        let result = self.wire.write_byte(address, keep, value);
        self.heed(result)
    }

    /// Reads a byte, and returns an error if it differs from `value`. Bits that are 1 in `ignored` are not compared.
    pub(super) fn expect_byte(
        &mut self,
        address: Address,
        ignored: u8,
        value: u8,
    ) -> Outcome<(), D, P> {
        let read = self.read_byte(address)?;
        if (read ^ value) & !ignored == 0 {
            self.note(address, !ignored, read);
            return Ok(());
        }
        self.state = State::NotReset;
        let (address, written) = (address.number(), u32::from(value & !ignored));
        Err(ChipError::ReadBack { address, written, read: u32::from(read & !ignored) })
    }

    /// Stores the byte `value` at `address` as the [`Beacon`]. The beacon covers the bits that are 1 in `mask` and
    /// belong to a neuron's parameters: the chip can change the other bits of a neuron. Does nothing if the bits of
    /// `value` that the beacon would cover are all 0, or if `address` is not in the memory of neurons.
    pub(super) fn note(&mut self, address: Address, mask: u8, value: u8) {
        let Some(byte) = address.neuron_byte() else { return };
        let mask = mask & I::PARAMETERS.get(usize::from(byte)).copied().unwrap_or(0);
        if value & mask != 0 {
            self.beacon = Some(Beacon { address, mask, value });
        }
    }

    pub(super) fn read_byte(&mut self, address: Address) -> Outcome<u8, D, P> {
        self.expect_gated()?;
        let result = self.wire.read_byte(address);
        self.heed(result)
    }

    fn expect_gated(&self) -> Outcome<(), D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Running => Err(ChipError::NotGated),
            State::Gated => Ok(()),
        }
    }

    /// Passes on the result of a bus access, with its error as [`ChipError::Bus`]. After such an error the driver
    /// refuses all calls until the next reset, because a clock pulse may have been lost.
    pub(super) fn heed<T>(&mut self, result: Result<T, D::Error>) -> Outcome<T, D, P> {
        result.map_err(|error| {
            self.state = State::NotReset;
            ChipError::Bus(error)
        })
    }
}
