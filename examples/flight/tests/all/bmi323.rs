//! The BMI323's start and its samples.

use bmi323_driver::{Bmi323, Error};
use embedded_hal_mock::eh1::{delay::NoopDelay, spi::Mock, spi::Transaction};
use flight::bmi323::{ReadError, StartError, read, start};
use flight::simulated::{Fault, Sensor, Trouble};

use crate::finish;

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
    let mut imu = Bmi323::new_spi(bus.clone());
    assert_eq!(finish(start(&mut imu, &mut NoopDelay)), Ok(()));
    bus.done();
}

/// The accesses of a start that succeeds.
const ACCESSES: usize = 16;

#[test]
fn an_error_at_every_access_is_told_and_the_next_start_succeeds() {
    for access in 0..ACCESSES {
        let mut sensor = Sensor::default();
        sensor.set(Trouble::Fails { access });
        let mut imu = Bmi323::new_spi(&mut sensor);
        let bus = StartError::Driver(Error::Bus(Fault));
        assert_eq!(finish(start(&mut imu, &mut NoopDelay)), Err(bus), "{access}");
        assert_eq!(finish(start(&mut imu, &mut NoopDelay)), Ok(()), "{access}");
        assert!(sensor.sample([1; 6]), "{access}");
    }
}

/// A write that the sensor does not hear never passes as a start: no data-ready would come, or with other ranges.
#[test]
fn a_lost_access_at_any_place_is_found_by_reading_back() {
    for access in 0..ACCESSES {
        let mut sensor = Sensor::default();
        sensor.set(Trouble::Deaf { access });
        let mut imu = Bmi323::new_spi(&mut sensor);
        let started = finish(start(&mut imu, &mut NoopDelay));
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
        let mut imu = Bmi323::new_spi(&mut sensor);
        let nobody = StartError::Driver(Error::InvalidChipId(level));
        assert_eq!(finish(start(&mut imu, &mut NoopDelay)), Err(nobody));
    }
}

#[test]
fn samples_are_rates_then_accelerations() {
    let mut sensor = Sensor::default();
    finish(start(&mut Bmi323::new_spi(&mut sensor), &mut NoopDelay)).unwrap();
    let mut next = |counts| {
        assert!(sensor.sample(counts));
        finish(read(&mut Bmi323::new_spi(&mut sensor)))
    };
    assert_eq!(next([1, -2, 3, -4, 5, 2048]), Ok([1, -2, 3, -4, 5, 2048]));
    // One axis at its end is a sample, three are the sensor's word for none.
    let (end, none) = (i16::MIN, Err(ReadError::NoData));
    assert_eq!(next([end, end, 3, 4, 5, 6]), Ok([end, end, 3, 4, 5, 6]));
    assert_eq!(next([end, end, end, 4, 5, 6]), none);
    assert_eq!(next([1, 2, 3, end, end, end]), none);
}

#[test]
fn a_brown_out_silences_the_sensor_until_it_is_started_again() {
    let mut sensor = Sensor::default();
    assert!(!sensor.sample([1; 6]));
    for _ in 0..2 {
        finish(start(&mut Bmi323::new_spi(&mut sensor), &mut NoopDelay)).unwrap();
        assert!(sensor.sample([1; 6]));
        sensor.brown_out();
        assert!(!sensor.sample([1; 6]));
    }
}
