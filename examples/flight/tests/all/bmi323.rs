//! The BMI323's start and its samples.

use embedded_hal_async::spi::SpiDevice;
use embedded_hal_mock::eh1::{delay::NoopDelay, spi::Mock, spi::Transaction};
use flight::{Fault, Imu, Sample, bmi323::Bmi323};

use crate::{
    finish,
    simulated::{Sensor, Trouble},
};

fn start(device: impl SpiDevice) -> Result<(), Fault> {
    finish(Bmi323::new(device).start(&mut NoopDelay))
}

fn read(device: impl SpiDevice) -> Result<Sample, Fault> {
    let mut imu = Bmi323::new(device);
    let mut burst = finish(imu.read())?;
    assert_eq!((burst.held, burst.samples.len()), (1, 1));
    burst.samples.next().flatten().ok_or(Fault::NoData)
}

/// Chip select around each access.
fn selected(inner: impl IntoIterator<Item = Transaction<u8>>) -> Vec<Transaction<u8>> {
    let (start, end) = (Transaction::transaction_start(), Transaction::transaction_end());
    [start].into_iter().chain(inner).chain([end]).collect()
}

fn writes(register: u8, word: u16) -> Vec<Transaction<u8>> {
    let [low, high] = word.to_le_bytes();
    selected([Transaction::write_vec(vec![register, low, high])])
}

fn reads(register: u8, words: &[u16]) -> Vec<Transaction<u8>> {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    let answer = [0xFF].into_iter().chain(bytes).collect();
    selected([Transaction::write_vec(vec![register | 0x80]), Transaction::read_vec(answer)])
}

#[test]
fn the_start_writes_and_reads_back_exactly_this() {
    let transactions = [
        writes(0x7E, 0xDEAF), // reset
        reads(0x00, &[0]),    // makes it SPI
        reads(0x00, &[0x0043]),
        reads(0x01, &[0]),
        reads(0x02, &[1]),
        writes(0x20, 0x703B), // high performance, ±16 g, 800 Hz
        writes(0x21, 0x704B), // high performance, ±2000 °/s, 800 Hz
        reads(0x38, &[0]),
        writes(0x38, 0b101), // INT1: on, push-pull, active high
        reads(0x3B, &[0]),
        writes(0x3B, 1 << 8), // the gyroscope's data-ready on INT1
        reads(0x01, &[0]),
        reads(0x20, &[0x703B]),
        reads(0x21, &[0x704B]),
        reads(0x38, &[0b101]),
        reads(0x3B, &[1 << 8]),
    ];
    let mut bus = Mock::new(&transactions.concat());
    assert_eq!(start(bus.clone()), Ok(()));
    bus.done();
}

/// The accesses of a start that succeeds.
const ACCESSES: usize = 16;

#[test]
fn an_error_at_every_access_is_told_and_the_next_start_succeeds() {
    for access in 0..ACCESSES {
        let mut sensor = Sensor::default();
        sensor.set(Trouble::Fails { access });
        assert_eq!(start(&mut sensor), Err(Fault::Bus), "{access}");
        assert_eq!(start(&mut sensor), Ok(()), "{access}");
        assert!(sensor.sample([1; 6]), "{access}");
    }
}

/// A write that the sensor does not hear never passes as a start: no data-ready would come, or with other ranges.
#[test]
fn a_lost_access_at_any_place_is_found_by_reading_back() {
    for access in 0..ACCESSES {
        let mut sensor = Sensor::default();
        sensor.set(Trouble::Deaf { access });
        let started = start(&mut sensor);
        // Before the identity it is not SPI yet, and what is read there is not looked at; reads of zeros
        // where zero is right are right.
        let is_harmless = [0, 1, 3, 4, 7, 9, 11].contains(&access);
        assert_eq!(started.is_ok(), is_harmless, "{access}: {started:?}");
        assert!(sensor.sample([1; 6]) || started.is_err(), "{access}");
    }
}

#[test]
fn nobody_on_the_bus_is_no_sensor() {
    for level in [0x00, 0xFF] {
        let mut sensor = Sensor::default();
        sensor.set(Trouble::Absent { level });
        assert_eq!(start(&mut sensor), Err(Fault::Identity(level.into())));
    }
}

#[test]
fn a_read_is_one_transfer_from_the_identity_on() {
    let words = [0x0043, 0, 0x00C0, 4, 5, 6, 1, 2, 3];
    let mut bus = Mock::new(&reads(0x00, &words));
    assert_eq!(read(bus.clone()), Ok([1, 2, 3, 4, 5, 6]));
    bus.done();
}

#[test]
fn samples_are_rates_then_accelerations_and_each_is_read_once() {
    let mut sensor = Sensor::default();
    start(&mut sensor).unwrap();
    let mut next = |counts| {
        assert!(sensor.sample(counts));
        (read(&mut sensor), read(&mut sensor))
    };
    let none = Err(Fault::NoData);
    assert_eq!(next([1, -2, 3, -4, 5, 2048]), (Ok([1, -2, 3, -4, 5, 2048]), none));
    // One axis at its end is a sample, three are the sensor's word for none.
    let end = i16::MIN;
    assert_eq!(next([end, end, 3, 4, 5, 6]).0, Ok([end, end, 3, 4, 5, 6]));
    assert_eq!(next([end, end, end, 4, 5, 6]).0, none);
    assert_eq!(next([1, 2, 3, end, end, end]).0, none);
}

/// Ones and zeros as a line picks them up, with the sensor's pulses still coming.
#[test]
fn a_line_that_floats_is_no_sample_whatever_it_picks_up() {
    let mut noise = 1_u32;
    for _ in 0..20_000 {
        let mut next = || {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let levels = [0x0000, 0x00FF, 0xFF00, 0xFFFF];
            levels[(noise >> 30) as usize]
        };
        let words: [u16; 9] = core::array::from_fn(|_| next());
        let mut bus = Mock::new(&reads(0x00, &words));
        assert_eq!(read(bus.clone()), Err(Fault::Identity(words[0])));
        bus.done();
    }
}

#[test]
fn a_brown_out_silences_the_sensor_until_it_is_started_again() {
    let mut sensor = Sensor::default();
    assert!(!sensor.sample([1; 6]));
    for _ in 0..2 {
        start(&mut sensor).unwrap();
        assert!(sensor.sample([1; 6]));
        sensor.brown_out();
        assert!(!sensor.sample([1; 6]));
        // The first access makes it SPI again, the second hears of the reset.
        assert_eq!(read(&mut sensor), Err(Fault::Identity(0)));
        assert_eq!(read(&mut sensor), Err(Fault::Restarted));
    }
}
