//! Tests of the AKD1500 driver: expected bytes on the bus, sizes of blocks, and errors at every transaction.

use std::collections::BTreeMap;

use crate::bus::Failing;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use proptest::prelude::*;
use spikewire_chips::{Akd1500, ChipError, ConvolutionEvent, DenseEvent};

fn write(header: [u8; 4], data: &[u8]) -> [Transaction<u8>; 4] {
    [
        Transaction::transaction_start(),
        Transaction::write_vec(header.to_vec()),
        Transaction::write_vec(data.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn read(header: [u8; 5], data: &[u8]) -> [Transaction<u8>; 4] {
    [
        Transaction::transaction_start(),
        Transaction::write_vec(header.to_vec()),
        Transaction::read_vec(data.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn bytes(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

#[test]
fn the_bytes_on_the_bus_are_golden() {
    let words = [0x1122_3344, 1, 2, 3, 4];
    let expected = [
        write([0x80, 0x20, 0x00, 0x08], &[0x11, 0x22, 0x33, 0x44]),
        write([0x81, 0x20, 0x00, 0x08], &bytes(&words[..4])),
        write([0x80, 0x20, 0x00, 0x0C], &bytes(&words[4..])),
        read([0x60, 0x30, 0x00, 0x00, 0x00], &[1, 2, 3, 4]),
        read([0x61, 0x20, 0x00, 0x08, 0x00], &bytes(&words[..4])),
        read([0x60, 0x20, 0x00, 0x0C, 0x00], &bytes(&words[4..])),
    ]
    .concat();
    let mut chip = Akd1500::new(Mock::new(&expected));
    chip.write(0xFC80_0020, &words[..1]).unwrap();
    chip.write(0xFC80_0020, &words).unwrap();
    let mut word = [0];
    chip.read(0xFCC0_0000, &mut word).unwrap();
    assert_eq!(word, [0x0102_0304]);
    let mut back = [0; 5];
    chip.read(0xFC80_0020, &mut back).unwrap();
    assert_eq!(back, words);
    chip.release().done();
}

/// Returns the transactions that `program` should make: the writes, then the reads, in blocks of the sizes in the
/// chip's documentation. `back` has the words that the reads return.
fn programming(address: u32, words: &[u32], back: &[u32]) -> Vec<[Transaction<u8>; 4]> {
    let mut blocks = Vec::new();
    let mut at = 0;
    for (size, code) in [(32, 4), (16, 3), (8, 2), (4, 1), (1, 0)] {
        while words.len() - at >= size {
            let [_, a, b, c] = ((address >> 2) + at as u32).to_be_bytes();
            blocks.push((code, [a, b, c], at, size));
            at += size;
        }
    }
    let writes = blocks.iter().map(|&(code, [a, b, c], at, size)| {
        write([0x80 | code, a, b, c], &bytes(&words[at..at + size]))
    });
    let reads = blocks.iter().map(|&(code, [a, b, c], at, size)| {
        read([0x60 | code, a, b, c, 0], &bytes(&back[at..at + size]))
    });
    writes.chain(reads).collect()
}

/// A fault of one byte on its way from the driver to the chip.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// The clock pulses of the byte are lost, so that the following bytes arrive early.
    Lost,
    /// The byte arrives twice.
    Doubled,
    /// The bit with this number is flipped.
    Flipped(u8),
}

/// The chip's memory behind its SPI, modelled on the vendor's sources. Chip select begins a block. If a block ends
/// early, its complete words are still written.
#[derive(Debug, Default)]
struct Memory {
    words: BTreeMap<u32, u32>,
    /// Number of bytes that the driver has sent so far.
    sent: usize,
    fault: Option<(usize, Fault)>,
}

impl ErrorType for Memory {
    type Error = ErrorKind;
}

impl Memory {
    /// Appends `byte` to the block as the chip receives it: once, twice, with a flipped bit, or not at all.
    fn receive(&mut self, byte: u8, block: &mut Vec<u8>) {
        let fault = self.fault.filter(|(at, _)| *at == self.sent).map(|(_, fault)| fault);
        self.sent += 1;
        match fault {
            None => block.push(byte),
            Some(Fault::Lost) => {}
            Some(Fault::Doubled) => block.extend([byte, byte]),
            Some(Fault::Flipped(bit)) => block.push(byte ^ 1 << bit),
        }
    }

    fn address(block: &[u8], word: usize) -> u32 {
        let [_, a, b, c] = block[..4] else { unreachable!() };
        let first = u32::from_be_bytes([0, a, b, c]);
        0xFC00_0000 | (first + word as u32) << 2 & 0x3FF_FFFF
    }
}

impl SpiDevice for Memory {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut block = Vec::new();
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    bytes.iter().for_each(|&byte| self.receive(byte, &mut block));
                }
                Operation::Read(bytes) => {
                    // If the header is too short, or not that of a read, the chip keeps the line low.
                    let is_read = block.len() == 5 && block[0] & 0xF8 == 0x60;
                    for (at, byte) in bytes.iter_mut().enumerate() {
                        let word = is_read.then(|| {
                            let address = Self::address(&block, at / 4);
                            self.words.get(&address).copied().unwrap_or(0)
                        });
                        *byte = word.unwrap_or(0).to_be_bytes()[at % 4];
                    }
                }
                _ => return Err(ErrorKind::Other),
            }
        }
        if block.len() >= 4 && block[0] & 0xF8 == 0x80 {
            let count = [1, 4, 8, 16, 32][usize::from(block[0] & 7).min(4)];
            let (data, _) = block[4..].as_chunks::<4>();
            for (word, bytes) in data.iter().take(count).enumerate() {
                self.words.insert(Self::address(&block, word), u32::from_be_bytes(*bytes));
            }
        }
        Ok(())
    }
}

const PLACE: u32 = 0xFC80_0400;

fn memory(words: impl Iterator<Item = u32>) -> Memory {
    let words = (0xFC80_0000..).step_by(4).zip(words).collect();
    Memory { words, ..Memory::default() }
}

/// Tries each kind of fault on each byte that `program` sends, both while it writes and while it reads back. `program`
/// must return an error, or memory must be right. The next call, without a fault, must succeed.
#[test]
fn one_fault_on_the_bus_is_an_error_or_did_no_harm_and_the_next_call_mends_it() {
    let words: Vec<u32> = (0..61).map(|n| 0x0101_0101 * n + 0x8000_0001).collect();
    let before = || memory((0..600).map(|n: u32| n.wrapping_mul(0x9E37_79B9) | 0x10));
    let mut right = before();
    right.words.extend((PLACE..).step_by(4).zip(words.iter().copied()));
    let mut noticed = 0;
    let bytes = 61 * 4 + 5 * 4 + 5 * 5;
    for at in 0..bytes {
        let flips = (0..8).map(Fault::Flipped);
        for fault in [Fault::Lost, Fault::Doubled].into_iter().chain(flips) {
            let mut chip = Akd1500::new(Memory { fault: Some((at, fault)), ..before() });
            let result = chip.program(PLACE, &words);
            noticed += usize::from(result.is_err());
            let memory = chip.release();
            if result.is_ok() {
                assert_eq!(memory.words, right.words, "{fault:?} at {at}");
            }
            let mut chip = Akd1500::new(Memory { fault: None, ..memory });
            assert_eq!(chip.program(PLACE, &words), Ok(()), "{fault:?} at {at}");
        }
    }
    // Faults in the five dummy bytes of the reads go unnoticed, because their bits mean nothing.
    assert!(noticed >= (bytes - 5) * 9, "{noticed} of {}", bytes * 10);
}

#[test]
fn a_block_that_goes_astray_is_not_noticed_where_its_words_were_already() {
    let words = [5, 6, 7, 8];
    let mut chip = Akd1500::new(memory(std::iter::repeat_n(0, 600)));
    chip.program(PLACE, &words).unwrap();
    let memory = chip.release();
    let mut chip = Akd1500::new(Memory { sent: 0, fault: Some((3, Fault::Flipped(7))), ..memory });
    assert_eq!(chip.program(PLACE, &words), Ok(()));
    assert_eq!(chip.release().words[&(PLACE ^ 0x200)], 5);
}

proptest! {
    #![proptest_config(crate::cases(256))]

    #[test]
    fn any_run_is_cut_into_blocks_and_read_back(
        words in prop::collection::vec(any::<u32>(), 0..150),
        address in 0..(1_u32 << 24) - 1_000,
    ) {
        let address = 0xFC00_0000 | address & !3;
        let mut chip = Akd1500::new(Mock::new(&programming(address, &words, &words).concat()));
        prop_assert_eq!(chip.program(address, &words), Ok(()));
        chip.release().done();
    }

    #[test]
    fn event_words_round_trip(x in 0_u16..0x1000, y in 0_u16..0x1000, feature in 0_u16..0x800, activation: u8) {
        let event = ConvolutionEvent { x, y, feature, activation };
        let words = event.words::<()>().unwrap();
        prop_assert_eq!(ConvolutionEvent::from_words(words), event);
        prop_assert_eq!(DenseEvent::from_words(words), None);
        let event = DenseEvent { feature: u32::from(x) << 6, activation: u32::from(y) << 14 };
        prop_assert_eq!(DenseEvent::from_words(event.words::<()>().unwrap()), Some(event));
    }
}

#[test]
fn an_error_at_every_transaction_comes_back_typed() {
    let words: Vec<u32> = (0..61).collect();
    let all = programming(0xFC00_0000, &words, &words);
    assert_eq!(all.len(), 2 * 5);
    for index in 0..all.len() {
        let device = Mock::new(&all[..index].concat());
        let mut chip = Akd1500::new(Failing { device, left: index });
        assert_eq!(chip.program(0xFC00_0000, &words), Err(ChipError::Bus(ErrorKind::Other)));
        chip.release().device.done();
    }
}

#[test]
fn a_word_that_does_not_read_back_is_named() {
    let words: Vec<u32> = (0..40).collect();
    let mut back = words.clone();
    back[35] = 99;
    let mut all = programming(0xFC00_0100, &words, &back);
    all.truncate(4); // 32 and 8 words, both ways
    let mut chip = Akd1500::new(Mock::new(&all.concat()));
    let expected = ChipError::ReadBack { address: 0xFC00_0100 + 4 * 35, written: 35, read: 99 };
    assert_eq!(chip.program(0xFC00_0100, &words), Err(expected));
    chip.release().done();
}

#[test]
fn bad_addresses_and_values_are_refused_without_a_byte() {
    let mut chip = Akd1500::new(Mock::new(&[]));
    assert!(matches!(chip.write(0xFC00_0002, &[0]), Err(ChipError::OutOfRange { max: 0, .. })));
    for address in [0, 0x2000_0000, 0xFBFF_FFFC] {
        let refused = chip.write(address, &[0]);
        assert!(matches!(refused, Err(ChipError::OutOfRange { what: "address", .. })));
    }
    assert!(matches!(chip.write(0xFCFF_FFFC, &[0, 0]), Err(ChipError::OutOfRange { max: 4, .. })));
    // These addresses lie after the chip's memory, so the vendor's driver refuses them, too.
    for address in [0xFD00_0000, 0xFEDC_BA98, 0xFFFF_FFFC] {
        let refused = Err(ChipError::OutOfRange {
            what: "address",
            value: i64::from(address),
            min: 0xFC00_0000,
            max: 0xFCFF_FFFF,
        });
        assert_eq!(chip.write(address, &[0]), refused);
        assert_eq!(chip.read(address, &mut [0]), refused);
    }
    assert!(matches!(chip.read(0xFC00_0001, &mut [0]), Err(ChipError::OutOfRange { .. })));
    assert_eq!(chip.write(0xFC00_0000, &[]), Ok(()));
    chip.release().done();

    let event = ConvolutionEvent { x: 4096, y: 0, feature: 0, activation: 0 };
    assert!(matches!(event.words::<()>(), Err(ChipError::OutOfRange { what: "x", .. })));
    let event = DenseEvent { feature: 1 << 18, activation: 0 };
    assert!(matches!(event.words::<()>(), Err(ChipError::OutOfRange { what: "feature", .. })));
}
