//! Akida AKD1500: reads and writes the chip's memory over SPI, and converts events to and from the chip's words.

use embedded_hal::spi::{Operation, SpiDevice};

use super::ChipError;
use super::error::{at_most, in_range};

/// The driver of the AKD1500: reads and writes the chip's memory over SPI. An inference also needs a program made by
/// the vendor's compiler; write this program to the chip's memory.
///
/// - **SPI:** mode 0, high bit first, 8 MHz; chip select low over header and data.
/// - **Blocks:** a transfer carries 1, 4, 8, 16 or 32 words of 32 bits; the driver splits longer runs.
/// - **Addresses:** multiples of 4 from `0xFC00_0000` to `0xFCFF_FFFC`, as in the vendor's driver. The bus carries the
///   low 26 bits, and the chip adds the rest.
/// - **Faults:** chip select marks the start of each block, so that a lost or doubled clock pulse spoils only one
///   block. There is no checksum, so [`program`](Self::program) reads everything back. If a fault changes the header of
///   a block, the block may be written to another address. Therefore, after [`ReadBack`](ChipError::ReadBack), rewrite
///   all memory that matters. If the intended address already held the same words, the fault goes unnoticed.
///
/// Checked against the vendor's sources, and against a model of the SPI transport that was written from these sources;
/// never against a chip.
///
/// Source: the vendor's Arduino library and engine, for the protocol; no code was taken.
///
/// ```
/// use embedded_hal_mock::eh1::spi::{Mock, Transaction};
/// use spikewire_chips::Akd1500;
///
/// let spi = Mock::new(&[
///     Transaction::transaction_start(),
///     Transaction::write_vec(vec![0x80, 0x20, 0x00, 0x08]),
///     Transaction::write_vec(vec![0x11, 0x22, 0x33, 0x44]),
///     Transaction::transaction_end(),
/// ]);
/// let mut chip = Akd1500::new(spi);
/// assert_eq!(chip.write(0xFC80_0020, &[0x1122_3344]), Ok(()));
/// # chip.release().done();
/// ```
#[derive(Debug)]
pub struct Akd1500<D> {
    device: D,
}

const WRITE: u8 = 0x80;
const READ: u8 = 0x60;
/// Block sizes in 32-bit words, longest first. The second value is the code of the size in the header of a block.
const BLOCKS: [(usize, u8); 5] = [(32, 4), (16, 3), (8, 2), (4, 1), (1, 0)];
/// First address of the chip's memory. The bus carries only the low 26 bits of an address; the high 6 bits are the
/// same for all addresses.
const BASE: u32 = 0xFC00_0000;
/// First address beyond the chip's memory.
const END: u32 = 0xFD00_0000;
const MAX_BLOCK_BYTES: usize = 128;

impl<D: SpiDevice> Akd1500<D> {
    /// Makes a driver for the chip on this SPI device.
    pub const fn new(device: D) -> Self {
        Self { device }
    }

    /// Writes consecutive 32-bit words, the first to `address`.
    ///
    /// # Errors
    /// Returns an error if `address` is not a multiple of 4, or if a word lies outside the chip's memory. Also returns
    /// an error if the bus failed; some blocks may then have been written.
    pub fn write(&mut self, address: u32, words: &[u32]) -> Result<(), ChipError<D::Error>> {
        check(address, words.len())?;
        for (address, code, block) in blocks(address, words) {
            let mut bytes = [0; MAX_BLOCK_BYTES];
            for (bytes, word) in bytes.chunks_exact_mut(4).zip(block) {
                for (byte, value) in bytes.iter_mut().zip(word.to_be_bytes()) {
                    *byte = value;
                }
            }
            let data = bytes.get(..4 * block.len()).unwrap_or_default();
            let header = header(WRITE | code, address);
            let mut operations = [Operation::Write(&header), Operation::Write(data)];
            self.device.transaction(&mut operations).map_err(ChipError::Bus)?;
        }
        Ok(())
    }

    /// Reads consecutive 32-bit words, the first from `address`.
    ///
    /// # Errors
    /// Returns an error if the bus failed, if `address` is not a multiple of 4, or if a word lies outside the chip's
    /// memory.
    pub fn read(&mut self, address: u32, words: &mut [u32]) -> Result<(), ChipError<D::Error>> {
        check(address, words.len())?;
        let mut address = address;
        let mut rest = words;
        while let Some((count, code)) = block_of(rest.len()) {
            let (block, after) = rest.split_at_mut_checked(count).unwrap_or_default();
            let mut bytes = [0; MAX_BLOCK_BYTES];
            let data = bytes.get_mut(..4 * count).unwrap_or_default();
            let [a, b, c, d] = header(READ | code, address);
            let mut operations = [Operation::Write(&[a, b, c, d, 0]), Operation::Read(data)];
            self.device.transaction(&mut operations).map_err(ChipError::Bus)?;
            for (word, bytes) in block.iter_mut().zip(bytes.chunks_exact(4)) {
                *word = bytes.first_chunk().copied().map_or(0, u32::from_be_bytes);
            }
            address = address.wrapping_add(4 * count as u32);
            rest = after;
        }
        Ok(())
    }

    /// Writes consecutive 32-bit words, the first to `address`, and reads them back.
    ///
    /// # Errors
    /// Returns the errors of [`write`](Self::write), and [`ReadBack`](ChipError::ReadBack) for the first word that
    /// reads back differently.
    pub fn program(&mut self, address: u32, words: &[u32]) -> Result<(), ChipError<D::Error>> {
        self.write(address, words)?;
        for (address, _, block) in blocks(address, words) {
            let mut back = [0; MAX_BLOCK_BYTES / 4];
            let back = back.get_mut(..block.len()).unwrap_or_default();
            self.read(address, back)?;
            for (offset, (&written, &read)) in (0..).step_by(4).zip(block.iter().zip(&*back)) {
                if written != read {
                    let address = address.wrapping_add(offset);
                    return Err(ChipError::ReadBack { address, written, read });
                }
            }
        }
        Ok(())
    }

    /// Consumes the driver and returns its SPI device.
    pub fn release(self) -> D {
        self.device
    }
}

fn check<E>(address: u32, words: usize) -> Result<(), ChipError<E>> {
    let bytes =
        u32::try_from(words).ok().and_then(|words| words.checked_mul(4)).unwrap_or(u32::MAX);
    in_range("address", address.into(), BASE.into(), (END - 1).into())?;
    at_most("offset into a word", address & 3, 0)?;
    at_most("length in bytes", bytes, END.saturating_sub(address))
}

/// Returns the header of a block: the command, and bits 2 to 25 of the address.
fn header(command: u8, address: u32) -> [u8; 4] {
    let [_, high, middle, low] = (address >> 2).to_be_bytes();
    [command, high, middle, low]
}

/// Returns the largest block size in [`BLOCKS`] that is at most `words`, and its code; `None` if `words` is 0.
fn block_of(words: usize) -> Option<(usize, u8)> {
    BLOCKS.into_iter().find(|&(count, _)| count <= words)
}

fn blocks(address: u32, words: &[u32]) -> impl Iterator<Item = (u32, u8, &[u32])> {
    let mut next = (address, words);
    core::iter::from_fn(move || {
        let (address, words) = next;
        let (count, code) = block_of(words.len())?;
        let (block, rest) = words.split_at_checked(count)?;
        next = (address.wrapping_add(4 * count as u32), rest);
        Some((address, code, block))
    })
}

/// An activation of a convolutional layer, as an event of two 32-bit words.
///
/// ```
/// use spikewire_chips::{ChipError, ConvolutionEvent};
///
/// let event = ConvolutionEvent { x: 0x123, y: 0x456, feature: 0x7FF, activation: 0x89 };
/// let words: Result<_, ChipError<()>> = event.words();
/// assert_eq!(words, Ok([0x0456_0123, 0x0089_07FF]));
/// assert_eq!(ConvolutionEvent::from_words([0x0456_0123, 0x0089_07FF]), event);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConvolutionEvent {
    /// Column, 0 to 4095.
    pub x: u16,
    /// Row, 0 to 4095.
    pub y: u16,
    /// Number of the feature, 0 to 2047.
    pub feature: u16,
    /// Activation, 0 to 255.
    pub activation: u8,
}

impl ConvolutionEvent {
    /// Encodes the event as two words.
    ///
    /// # Errors
    /// Returns an error if a field exceeds the range that its documentation gives.
    pub fn words<E>(self) -> Result<[u32; 2], ChipError<E>> {
        let [x, y, feature] = [self.x, self.y, self.feature].map(u32::from);
        at_most("x", x, 0xFFF)?;
        at_most("y", y, 0xFFF)?;
        at_most("feature", feature, 0x7FF)?;
        Ok([y << 16 | x, u32::from(self.activation) << 16 | feature])
    }

    /// Decodes an event from two words.
    pub fn from_words([first, second]: [u32; 2]) -> Self {
        Self {
            x: first as u16 & 0xFFF,
            y: (first >> 16) as u16 & 0xFFF,
            feature: second as u16 & 0x7FF,
            activation: (second >> 16) as u8,
        }
    }
}

/// An activation of a dense (fully connected) layer, as an event of two 32-bit words.
///
/// ```
/// use spikewire_chips::{ChipError, DenseEvent};
///
/// let event = DenseEvent { feature: 0x2_0001, activation: 7 };
/// let words: Result<_, ChipError<()>> = event.words();
/// assert_eq!(words, Ok([0x2_0001, 0x8000_0007]));
/// assert_eq!(DenseEvent::from_words([0x2_0001, 0x8000_0007]), Some(event));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DenseEvent {
    /// Number of the feature, 0 to 262 143.
    pub feature: u32,
    /// Activation, 0 to 67 108 863.
    pub activation: u32,
}

impl DenseEvent {
    const MAX_FEATURE: u32 = (1 << 18) - 1;
    const MAX_ACTIVATION: u32 = (1 << 26) - 1;
    const DENSE: u32 = 1 << 31;

    /// Encodes the event as two words.
    ///
    /// # Errors
    /// Returns an error if a field exceeds the range that its documentation gives.
    pub fn words<E>(self) -> Result<[u32; 2], ChipError<E>> {
        at_most("feature", self.feature, Self::MAX_FEATURE)?;
        at_most("activation", self.activation, Self::MAX_ACTIVATION)?;
        Ok([self.feature, Self::DENSE | self.activation])
    }

    /// Decodes an event from two words. Returns `None` if the words do not encode an event of a dense layer.
    pub fn from_words([first, second]: [u32; 2]) -> Option<Self> {
        (second & Self::DENSE != 0).then_some(Self {
            feature: first & Self::MAX_FEATURE,
            activation: second & Self::MAX_ACTIVATION,
        })
    }
}
