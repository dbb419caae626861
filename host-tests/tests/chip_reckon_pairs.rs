//! A lost and a doubled SPI clock within one access to `ReckOn`, which bring chip and bus back into step.

use embedded_hal::spi::ErrorKind;
use host_tests::silicon::board::ClockFault::{self, Doubled, Lost};
use host_tests::silicon::reckon::{Board, Port, ReckOn as Model, Spi};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use spikewire::chip::{ChipError, ReckOn, ReckOnSettings};

type Chip = ReckOn<Spi, Port>;
type Outcome<T> = Result<T, ChipError<ErrorKind, u64>>;

/// Clocks of a frame.
const FRAME: u64 = 64;

/// Registers and memories, but for the word with which the driver checks its step.
fn all(chip: &Model) -> (Vec<u32>, Vec<u128>) {
    let registers = (0..=104).map(|register| chip.register_value(register)).collect();
    let outputs = chip.output_weights.iter().enumerate().filter(|(at, _)| *at != 0x1AA);
    let weights = chip.input_weights.iter().chain(chip.recurrent_weights.iter());
    let memories = chip.neurons.iter().copied().chain(weights);
    (registers, memories.chain(outputs.map(|(_, word)| word)).collect())
}

/// What an access does to a chip whose memories hold `words`, with these faults: its result, all that the chip then holds,
/// and its clocks.
fn with<T>(
    words: u128,
    faults: &[(u64, ClockFault)],
    access: impl FnOnce(&mut Chip) -> Outcome<T>,
) -> (Outcome<T>, (Vec<u32>, Vec<u128>), u64) {
    let board = Board::new(10, 1);
    let mut chip = ReckOn::new(board.spi(), board.port(), 1_000);
    chip.reset(&mut board.clone()).unwrap();
    let start = {
        let mut pins = board.pins();
        pins.chip.neurons.fill(words);
        for row in [0, 1, 2, 3, 5, 10, 21, 42].map(|row| row << 4) {
            pins.chip.input_weights.set(row, words);
            pins.chip.recurrent_weights.set(row, !words);
            pins.chip.output_weights.set(row >> 4, words.rotate_left(1));
        }
        pins.spi_clocks
    };
    board.pins().clock_faults.extend(faults.iter().map(|&(at, fault)| (start + at, fault)));
    let result = access(&mut chip);
    let mut pins = board.pins();
    pins.chip.run(20);
    (result, all(&pins.chip), pins.spi_clocks - start)
}

const WORDS: [u128; 3] = [0, u128::MAX, 0x8765_4321_0FED_CBA9_A5A5_3C3C_1234_5678];

/// Tries pairs of faults in an access but those in a register's own frame: the frames of which `is_register` says so.
/// Every pair whose second fault comes within `reach` clocks, or as many as `some` at random.
fn pairs<T: PartialEq + std::fmt::Debug>(
    some: Option<usize>,
    reach: u64,
    is_register: impl Fn(u64) -> bool,
    access: impl Fn(&mut Chip) -> Outcome<T>,
) -> usize {
    let mut random = Pcg32::seed_from_u64(7);
    let mut tried = 0;
    for words in WORDS {
        let (result, right, clocks) = with(words, &[], &access);
        let result = result.unwrap();
        let mut pair = |first: u64, second: u64| {
            let is_own = first / FRAME == second / FRAME && is_register(first / FRAME);
            if first == second || is_own {
                return;
            }
            for faults in [[(first, Lost), (second, Doubled)], [(first, Doubled), (second, Lost)]] {
                tried += 1;
                if let (Ok(told), held, _) = with(words, &faults, &access) {
                    assert_eq!(told, result, "{words:x}: {faults:?}");
                    assert!(held == right, "{words:x}: {faults:?}");
                }
            }
        };
        match some {
            Some(some) => (0..some).for_each(|_| {
                let first = u64::from(random.next_u32()) % clocks;
                pair(first, (first + u64::from(random.next_u32()) % reach).min(clocks - 1));
            }),
            None => (0..clocks).for_each(|first| {
                (first + 1..(first + reach).min(clocks)).for_each(|second| pair(first, second));
            }),
        }
    }
    tried
}

fn accesses(some: Option<usize>) -> usize {
    let none = |_| false;
    pairs(some, 400, none, |chip| chip.programmed()?.input_weight(5, 2))
        + pairs(some, 400, none, |chip| chip.programmed()?.recurrent_weight(21, 3))
        + pairs(some, 400, none, |chip| chip.programmed()?.output_weight(42, 1))
        // A register's frame, then four that check the step.
        + pairs(some, 400, |frame| frame == 0, |chip| chip.programmed()?.set_register(69, 110))
        // The same for each register; then the memories close.
        + pairs(
            some,
            2 * FRAME,
            |frame| frame % 5 == 0,
            |chip| chip.programmed()?.run(&ReckOnSettings::POTENTIALS).map(drop),
        )
}

#[test]
fn a_lost_and_a_doubled_clock_within_an_access_are_an_error_or_right() {
    assert!(accesses(Some(30)) > 500);
}

#[test]
#[ignore = "minutes: run with --release"]
fn every_lost_and_doubled_clock_within_an_access_are_an_error_or_right() {
    println!("{} pairs", accesses(None));
}
