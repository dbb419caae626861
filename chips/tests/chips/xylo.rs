//! Tests of the Xylo driver: how counts are packed, which registers a time step accesses, and errors at every access.

use std::num::NonZeroU32;

use proptest::prelude::*;
use spikewire::{Bins, Event, Polarity, Tick};
use spikewire_chips::{ChipError, InputBank, Registers, Xylo, XyloMap, pack_counts};

/// Registers of a chip. From the read with number `busy` on, they show that the time step is done. Outputs 0, 2 and 31
/// fired (on an A2, which has 8 outputs, 0 and 2).
#[derive(Debug, Default)]
struct Chip {
    accesses: Vec<(char, u16, u32)>,
    busy: u32,
    /// Whether the next time step reads the second bank of inputs.
    is_second: bool,
    fails_at: Option<usize>,
}

impl Chip {
    fn access(&mut self, kind: char, address: u16, value: u32) -> Result<u32, usize> {
        self.accesses.push((kind, address, value));
        let number = self.accesses.len();
        if self.fails_at == Some(number) { Err(number) } else { Ok(value) }
    }
}

impl Registers for Chip {
    type Error = usize;

    fn write(&mut self, address: u16, value: u32) -> Result<(), usize> {
        self.access('w', address, value).map(|_| ())
    }

    fn read(&mut self, address: u16) -> Result<u32, usize> {
        self.busy = self.busy.saturating_sub(1);
        let is_done = u32::from(self.busy == 0);
        let value = match address {
            0x152 => 0x8000_0005,
            0x153 => 0xF0 | is_done,
            0x171 => 0x7FFE_FFFF | u32::from(self.is_second) << 16,
            0x15 => 0xFE_0F05 | is_done << 16,
            _ => panic!("{address:#x} is not read"),
        };
        self.access('r', address, value)
    }
}

proptest! {
    #![proptest_config(crate::cases(256))]

    #[test]
    fn every_channel_is_a_nibble(counts: [u8; 16]) {
        let [low, high] = pack_counts(counts);
        for (channel, count) in counts.into_iter().enumerate() {
            let register = if channel < 8 { low } else { high };
            prop_assert_eq!(register >> (4 * (channel % 8)) & 0xF, u32::from(count.min(15)));
        }
    }
}

#[test]
fn a_time_step_from_events_to_outputs() {
    let mut bins = Bins::<16>::new(Tick::from(0), NonZeroU32::new(1_000).unwrap()).with_limit(15);
    for tick in 0..20 {
        bins.add(Event { tick: Tick::from(tick), address: 9, polarity: Polarity::Up }).unwrap();
    }
    let mut xylo = Xylo::new(Chip { busy: 3, ..Chip::default() }, XyloMap::AUDIO_3, 10);
    xylo.set_input(InputBank::First, bins.take()).unwrap();
    xylo.set_input(InputBank::Second, [1; 16]).unwrap();
    assert_eq!(bins.saturated(), 5);
    assert_eq!(xylo.step(), Ok(0x8000_0005));
    let expected = [
        ('w', 0x149, 0),
        ('w', 0x14A, 0xF0),
        ('w', 0x14B, 0x1111_1111),
        ('w', 0x14C, 0x1111_1111),
        ('w', 0x10, 1 << 4), // bit 0 would reset the chip
        ('r', 0x153, 0xF0),
        ('r', 0x153, 0xF0),
        ('r', 0x153, 0xF1),
        ('r', 0x152, 0x8000_0005),
    ];
    assert_eq!(xylo.release().accesses, expected);
}

#[test]
fn counts_go_to_the_bank_that_the_next_step_reads() {
    for (is_second, first) in [(false, 0x149), (true, 0x14B)] {
        let mut xylo = Xylo::new(Chip { is_second, ..Chip::default() }, XyloMap::AUDIO_3, 5);
        xylo.set_next_input([2; 16]).unwrap();
        let pointer = 0x7FFE_FFFF | u32::from(is_second) << 16;
        let counts = [first, first + 1].map(|register| ('w', register, 0x2222_2222));
        assert_eq!(xylo.release().accesses, [&[('r', 0x171, pointer)][..], &counts].concat());
    }
    // The A2 map has no register for the next bank, so both banks get the counts.
    let mut xylo = Xylo::new(Chip::default(), XyloMap::a2(0x40), 5);
    assert_eq!(xylo.next_bank(), Ok(None));
    xylo.set_next_input([3; 16]).unwrap();
    let expected: Vec<_> = (0x11..=0x14).map(|register| ('w', register, 0x3333_3333)).collect();
    assert_eq!(xylo.release().accesses, expected);

    let mut xylo = Xylo::new(Chip { busy: 9, ..Chip::default() }, XyloMap::AUDIO_3, 1);
    assert_eq!(xylo.step(), Err(ChipError::Unfinished));
    assert_eq!(xylo.set_next_input([1; 16]), Err(ChipError::Unfinished));
}

#[test]
fn a2_has_outputs_and_their_end_in_one_register() {
    let mut xylo = Xylo::new(Chip { busy: 2, ..Chip::default() }, XyloMap::a2(0x40), 10);
    xylo.set_input(InputBank::Second, [1; 16]).unwrap();
    assert_eq!(xylo.step(), Ok(0b101));
    let expected = [
        ('w', 0x13, 0x1111_1111),
        ('w', 0x14, 0x1111_1111),
        ('w', 0x0E, 0x40),
        ('r', 0x15, 0xFE_0F05),
        ('r', 0x15, 0xFF_0F05),
        ('r', 0x15, 0xFF_0F05),
    ];
    assert_eq!(xylo.release().accesses, expected);
}

#[test]
fn a_step_that_does_not_finish_times_out() {
    let mut xylo = Xylo::new(Chip { busy: 100, ..Chip::default() }, XyloMap::AUDIO_3, 5);
    assert_eq!(xylo.step(), Err(ChipError::Unfinished));
    assert_eq!(xylo.release().accesses.len(), 6);
}

#[test]
fn a_step_under_way_takes_no_counts_and_no_second_trigger() {
    let mut xylo = Xylo::new(Chip { busy: 8, ..Chip::default() }, XyloMap::AUDIO_3, 5);
    assert_eq!(xylo.step(), Err(ChipError::Unfinished));
    assert_eq!(xylo.set_input(InputBank::First, [1; 16]), Err(ChipError::Unfinished));
    assert_eq!(xylo.clear_input(), Err(ChipError::Unfinished));
    assert_eq!(xylo.step(), Ok(0x8000_0005));
    assert_eq!(xylo.clear_input(), Ok(()));
    let accesses = xylo.release().accesses;
    let written: Vec<_> = accesses.into_iter().filter(|(kind, ..)| *kind == 'w').collect();
    let cleared = (0x149..=0x14C).map(|register| ('w', register, 0));
    let expected: Vec<_> = [('w', 0x10, 1 << 4)].into_iter().chain(cleared).collect();
    assert_eq!(written, expected, "one trigger, and no counts while it ran");
}

/// One access of a step fails: the trigger (access 3), the read of the status (4) or the read of the outputs (5). The
/// next call of `step` must return the outputs.
#[test]
fn an_error_of_the_bus_loses_no_outputs() {
    for (number, triggers) in [(3, 2), (4, 1), (5, 1)] {
        let chip = Chip { fails_at: Some(number), ..Chip::default() };
        let mut xylo = Xylo::new(chip, XyloMap::AUDIO_3, 5);
        xylo.set_input(InputBank::First, [0; 16]).unwrap();
        assert_eq!(xylo.step(), Err(ChipError::Bus(number)));
        assert_eq!(xylo.step(), Ok(0x8000_0005));
        let accesses = xylo.release().accesses;
        assert_eq!(accesses.iter().filter(|(_, register, _)| *register == 0x10).count(), triggers);
    }
}

#[test]
fn an_error_at_every_access_comes_back_typed() {
    for number in 1..=5 {
        let chip = Chip { fails_at: Some(number), ..Chip::default() };
        let mut xylo = Xylo::new(chip, XyloMap::AUDIO_3, 5);
        let result = xylo.set_input(InputBank::First, [0; 16]).and_then(|()| xylo.step());
        assert_eq!(result, Err(ChipError::Bus(number)));
    }
}

/// Registers that hold what `peers/xylo.py` recorded.
struct Table(Vec<u32>);

impl Registers for Table {
    type Error = ();

    fn write(&mut self, _address: u16, _value: u32) -> Result<(), ()> {
        Ok(())
    }

    fn read(&mut self, address: u16) -> Result<u32, ()> {
        let addresses = [0x149, 0x14A, 0x14B, 0x14C, 0x152, 0x153, 0x171];
        let at = addresses.iter().position(|one| *one == address).ok_or(())?;
        Ok(self.0[at])
    }
}

/// Reads numbers that spaces separate.
fn numbers(column: &str) -> Vec<u32> {
    column.split_whitespace().map(|one| one.parse().unwrap()).collect()
}

/// The vendor's own software, run by `peers/xylo.py`, takes as many of the counts as [`pack_counts`], and reads counts,
/// bank, end of a step and outputs from the same registers as the driver.
#[test]
fn the_vendors_software_reads_the_same_registers() {
    for line in include_str!("../peers/xylo.txt").lines() {
        let columns: Vec<Vec<u32>> = line.split(';').map(numbers).collect();
        let [counts, taken, values, read, done, outputs] = &columns[..] else { panic!("{line}") };
        let packed = |counts: &[u32]| pack_counts(std::array::from_fn(|at| counts[at] as u8));
        assert_eq!(packed(counts), packed(taken), "{line}");
        assert!(taken.iter().all(|count| *count <= 15), "{line}");

        let mut xylo = Xylo::new(Table(values.clone()), XyloMap::AUDIO_3, 1);
        let first = usize::from(xylo.next_bank() == Ok(Some(InputBank::Second))) * 2;
        assert_eq!(packed(read), values[first..first + 2], "{line}");
        let fired = outputs.iter().fold(0, |fired, output| fired | 1 << output);
        let expected = if done == &[1] { Ok(fired) } else { Err(ChipError::Unfinished) };
        assert_eq!(xylo.step(), expected, "{line}");
    }
}
