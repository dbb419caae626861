//! SPI without chip select. A frame is a header of 32 bits, followed by 32-bit words. The chip finds the bounds of
//! frames by counting clock pulses from its reset.

use embedded_hal::spi::SpiDevice;

const READ: u32 = 1 << 31;

/// The address of a 32-bit word in one of the chip's memories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Address(pub(super) u32);

impl Address {
    /// Returns the address of a 32-bit word of a pair of neurons. `quarter` selects one of the four words of the pair.
    pub(super) const fn pair(pair: u16, quarter: u32) -> Self {
        Self(1 << 28 | (pair as u32) << 2 | quarter)
    }

    /// Returns the address of the 32-bit word with the weights from an input to neurons 0 to 3. The next word has the
    /// weights to neurons 4 to 7, and so on.
    pub(super) const fn input(input: u16) -> Self {
        Self(3 << 28 | (input as u32) << 6)
    }

    /// Returns the address of the 32-bit word with the weights from a neuron to neurons 0 to 3. The next word has the
    /// weights to neurons 4 to 7, and so on.
    pub(super) const fn recurrent(neuron: u16) -> Self {
        Self(4 << 28 | (neuron as u32) << 6)
    }

    /// Returns the address of the 32-bit word with the weights from a neuron to outputs 0 to 3. The next word has the
    /// weights to outputs 4 to 7, and so on.
    pub(super) const fn output(neuron: u16) -> Self {
        Self(5 << 28 | (neuron as u32) << 2)
    }

    /// Returns the address that the sync check writes to: the address of a word that no network uses.
    pub(super) const fn anchor() -> Self {
        Self::output(0x1AA)
    }

    /// Returns the address that is `words` 32-bit words after this address.
    pub(super) const fn next(self, words: u16) -> Self {
        Self(self.0.wrapping_add(words as u32))
    }
}

/// The SPI device of a chip that is in sync with the bus.
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
        // The chip ignores the word that is sent while it is read. Should a fault make the chip take it for a header,
        // the word is the header of a read. Should the header of neurons lose its first bit, the chip writes the word's
        // low half to an output's potential: 0 is the value that the potential has before a sample.
        let mut bytes = frame(READ | address.0, 0xFFFF_0000);
        self.device.transfer_in_place(&mut bytes)?;
        Ok(u64::from_be_bytes(bytes) as u32)
    }
}

/// Makes a frame of a header and one word. Sets the number of words in the header to 1.
fn frame(header: u32, word: u32) -> [u8; 8] {
    (u64::from(header | 1 << 16) << 32 | u64::from(word)).to_be_bytes()
}
