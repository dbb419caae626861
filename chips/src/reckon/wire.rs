//! SPI without chip select: a header of 32 bits and then 32-bit words, which the chip counts from its reset.

use embedded_hal::spi::SpiDevice;

const READ: u32 = 1 << 31;

/// The address of a word in one of the chip's memories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Address(pub(super) u32);

impl Address {
    /// Addresses one of the four words of a pair of neurons.
    pub(super) const fn pair(pair: u16, quarter: u32) -> Self {
        Self(1 << 28 | (pair as u32) << 2 | quarter)
    }

    /// Addresses the weights from an input to the first four neurons; the next address holds the next four.
    pub(super) const fn input(input: u16) -> Self {
        Self(3 << 28 | (input as u32) << 6)
    }

    /// Addresses the weights from a neuron to the first four neurons; the next address holds the next four.
    pub(super) const fn recurrent(neuron: u16) -> Self {
        Self(4 << 28 | (neuron as u32) << 6)
    }

    /// Addresses the weights from a neuron to the first four outputs; the next address holds the next four.
    pub(super) const fn output(neuron: u16) -> Self {
        Self(5 << 28 | (neuron as u32) << 2)
    }

    /// Addresses a word that no network uses.
    pub(super) const fn anchor() -> Self {
        Self::output(0x1AA)
    }

    /// Returns the address `words` further on.
    pub(super) const fn next(self, words: u16) -> Self {
        Self(self.0.wrapping_add(words as u32))
    }
}

/// The bus, while it is in step.
#[derive(Debug)]
pub(super) struct Wire<D> {
    pub(super) device: D,
}

impl<D: SpiDevice> Wire<D> {
    pub(super) fn configure(&mut self, register: u16, value: u32) -> Result<(), D::Error> {
        self.write(Address(register.into()), value)
    }

    pub(super) fn write(&mut self, address: Address, word: u32) -> Result<(), D::Error> {
        self.device.write(&frame(address.0, word))
    }

    pub(super) fn read(&mut self, address: Address) -> Result<u32, D::Error> {
        // The chip ignores the word that is sent. Taken for a header, it is one of a read. And a header of neurons that
        // loses its first bit writes an output's potential, the low half of the word: 0 is what it is before a sample.
        let mut bytes = frame(READ | address.0, 0xFFFF_0000);
        self.device.transfer_in_place(&mut bytes)?;
        Ok(u64::from_be_bytes(bytes) as u32)
    }
}

/// Makes a frame: a header that announces one word, and the word.
fn frame(header: u32, word: u32) -> [u8; 8] {
    (u64::from(header | 1 << 16) << 32 | u64::from(word)).to_be_bytes()
}
