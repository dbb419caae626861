//! AKD1500: golden bytes, blocks, and errors at every transaction.

use crate::bus::Failing;
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use proptest::prelude::*;
use spikewire::chip::{Akd1500, ChipError, ConvolutionEvent, DenseEvent};

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
    ]
    .concat();
    let mut chip = Akd1500::new(Mock::new(&expected));
    chip.write(0xFC80_0020, &words[..1]).unwrap();
    chip.write(0xFC80_0020, &words).unwrap();
    let mut word = [0];
    chip.read(0xFCC0_0000, &mut word).unwrap();
    assert_eq!(word, [0x0102_0304]);
    chip.release().done();
}

/// The transactions of `program`, by the table of block sizes.
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

proptest! {
    #[test]
    fn any_run_is_cut_into_blocks_and_read_back(
        words in prop::collection::vec(any::<u32>(), 0..150),
        address in 0..(1_u32 << 26) - 1_000,
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
    let all = programming(0, &words, &words);
    assert_eq!(all.len(), 2 * 5);
    for index in 0..all.len() {
        let device = Mock::new(&all[..index].concat());
        let mut chip = Akd1500::new(Failing { device, left: index });
        assert_eq!(chip.program(0, &words), Err(ChipError::Bus(ErrorKind::Other)));
        chip.release().device.done();
    }
}

#[test]
fn a_word_that_does_not_read_back_is_named() {
    let words: Vec<u32> = (0..40).collect();
    let mut back = words.clone();
    back[35] = 99;
    let mut all = programming(0x100, &words, &back);
    all.truncate(4); // 32 and 8 words, both ways
    let mut chip = Akd1500::new(Mock::new(&all.concat()));
    let expected = ChipError::ReadBack { address: 0x100 + 4 * 35, written: 35, read: 99 };
    assert_eq!(chip.program(0x100, &words), Err(expected));
    chip.release().done();
}

#[test]
fn bad_addresses_and_values_are_refused_without_a_byte() {
    let mut chip = Akd1500::new(Mock::new(&[]));
    assert!(matches!(chip.write(2, &[0]), Err(ChipError::OutOfRange { .. })));
    assert!(matches!(chip.write(0xFFFF_FFFC, &[0, 0]), Err(ChipError::OutOfRange { max: 4, .. })));
    assert!(matches!(chip.read(1, &mut [0]), Err(ChipError::OutOfRange { .. })));
    assert_eq!(chip.write(0, &[]), Ok(()));
    chip.release().done();

    let event = ConvolutionEvent { x: 4096, y: 0, feature: 0, activation: 0 };
    assert!(matches!(event.words::<()>(), Err(ChipError::OutOfRange { what: "x", .. })));
    let event = DenseEvent { feature: 1 << 18, activation: 0 };
    assert!(matches!(event.words::<()>(), Err(ChipError::OutOfRange { what: "feature", .. })));
}
