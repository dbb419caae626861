//! SPI without chip select: frames of 40 bits, which the chip delimits by counting clock pulses from its reset.

use embedded_hal::spi::SpiDevice;

/// Address bit that requests a read. Bit 18 requests a write, and bits 17 and 16 select the memory.
const READ: u32 = 1 << 19;
const WRITE: u32 = 1 << 18;
const NEURON: u32 = 1 << 16;
const SYNAPSE: u32 = 2 << 16;

/// The address of a byte in the memory of neurons or in that of synapses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Address(u32);

impl Address {
    /// Returns the address of byte `byte` of neuron `neuron`.
    pub(super) fn neuron(neuron: u8, byte: u8) -> Self {
        Self(NEURON | u32::from(byte) << 8 | u32::from(neuron))
    }

    /// Returns the address of a byte that does not exist, beyond the bytes of a neuron. A read of this address returns
    /// 0.
    pub(super) fn nowhere() -> Self {
        Self::neuron(255, 0x7F)
    }

    /// Returns the address of the byte with the synapse from `pre` to `post`. A byte holds two synapses, and a 32-bit
    /// word holds four bytes. The address has three bit fields, from high to low: the byte's index in its word, `pre`,
    /// and `post / 8`.
    pub(super) fn synapse(pre: u8, post: u8) -> Self {
        let (pre, post) = (u32::from(pre), u32::from(post));
        Self(SYNAPSE | (post >> 1 & 3) << 13 | pre << 5 | post >> 3)
    }

    /// Returns the index of the byte within its neuron; `None` if the address is not in the memory of neurons.
    pub(super) fn neuron_byte(self) -> Option<u8> {
        (self.0 & (NEURON | SYNAPSE) == NEURON).then_some((self.0 >> 8) as u8)
    }

    /// Returns the address as the number that errors contain.
    pub(super) const fn number(self) -> u32 {
        self.0
    }
}

/// The SPI device of a chip that is in sync with the bus.
#[derive(Debug)]
pub(super) struct Wire<D> {
    pub(super) device: D,
}

impl<D: SpiDevice> Wire<D> {
    pub(super) fn configure(&mut self, register: u16, value: u32) -> Result<(), D::Error> {
        self.write(register.into(), value)
    }

    /// Writes `value` to a byte of memory. Bits that are 1 in the mask `keep` keep their value.
    pub(super) fn write_byte(
        &mut self,
        address: Address,
        keep: u8,
        value: u8,
    ) -> Result<(), D::Error> {
        self.write(WRITE | address.0, u32::from(keep) << 8 | u32::from(value))
    }

    /// Reads a byte, which comes back as the last byte of the frame. Sends data in which every bit is 1. In a read the
    /// chip ignores this data. If a lost or doubled clock pulse turns the read into a write, the chip takes part of
    /// this data as the mask of the bits to keep: memory then keeps all bits.
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

/// Makes a frame from 20 bits of address and 20 bits of data.
fn frame(address: u32, data: u32) -> [u8; 5] {
    let [_, _, _, bytes @ ..] = (u64::from(address) << 20 | u64::from(data)).to_be_bytes();
    bytes
}
