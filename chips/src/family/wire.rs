//! SPI without chip select: frames of 40 clocks, which the chip counts from its reset.

use embedded_hal::spi::SpiDevice;

/// Bit of an address that requests a read. Bit 18 requests a write, and bits 17 and 16 select the memory.
const READ: u32 = 1 << 19;
const WRITE: u32 = 1 << 18;
const NEURON: u32 = 1 << 16;
const SYNAPSE: u32 = 2 << 16;

/// The address of a byte in one of the two memories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Address(u32);

impl Address {
    /// Addresses byte `byte` of a neuron.
    pub(super) fn neuron(neuron: u8, byte: u8) -> Self {
        Self(NEURON | u32::from(byte) << 8 | u32::from(neuron))
    }

    /// Addresses a byte beyond those of a neuron, which reads as 0.
    pub(super) fn nowhere() -> Self {
        Self::neuron(255, 0x7F)
    }

    /// Addresses the byte of a synapse: `{byte, pre, post / 8}`, with two synapses in each byte and four bytes in each
    /// word.
    pub(super) fn synapse(pre: u8, post: u8) -> Self {
        let (pre, post) = (u32::from(pre), u32::from(post));
        Self(SYNAPSE | (post >> 1 & 3) << 13 | pre << 5 | post >> 3)
    }

    /// Returns the index of the byte in its neuron; `None` if it is not in a neuron.
    pub(super) fn neuron_byte(self) -> Option<u8> {
        (self.0 & (NEURON | SYNAPSE) == NEURON).then_some((self.0 >> 8) as u8)
    }

    /// Returns the address as errors show it.
    pub(super) const fn number(self) -> u32 {
        self.0
    }
}

/// The bus, while it is in step.
#[derive(Debug)]
pub(super) struct Wire<D> {
    pub(super) device: D,
}

impl<D: SpiDevice> Wire<D> {
    pub(super) fn configure(&mut self, register: u16, value: u32) -> Result<(), D::Error> {
        self.write(register.into(), value)
    }

    /// Writes those bits of a byte that are 0 in `keep`.
    pub(super) fn write_byte(
        &mut self,
        address: Address,
        keep: u8,
        value: u8,
    ) -> Result<(), D::Error> {
        self.write(WRITE | address.0, u32::from(keep) << 8 | u32::from(value))
    }

    /// Reads a byte, which is the last one that comes back. The chip ignores the data that is sent with it; they are
    /// all ones, so that a frame which a lost or doubled clock turns into a write keeps all bits.
    pub(super) fn read_byte(&mut self, address: Address) -> Result<u8, D::Error> {
        let mut frame = frame(READ | address.0, 0xF_FFFF);
        self.device.transfer_in_place(&mut frame)?;
        let [.., last] = frame;
        Ok(last)
    }

    fn write(&mut self, address: u32, data: u32) -> Result<(), D::Error> {
        self.device.write(&frame(address, data))
    }
}

/// Makes a frame of 20 bits of address and 20 of data.
fn frame(address: u32, data: u32) -> [u8; 5] {
    let [_, _, _, bytes @ ..] = (u64::from(address) << 20 | u64::from(data)).to_be_bytes();
    bytes
}
