//! The Crazyflie's sensor on I2C.

use embedded_hal::i2c::ErrorKind;
use embedded_hal_mock::eh1::{delay::NoopDelay, i2c::Mock, i2c::Transaction};
use flight::bmi088::{ACCEL, Bmi088, GYRO, StartError};

use crate::finish;

fn writes(address: u8, register: u8, value: u8) -> Transaction {
    Transaction::write(address, vec![register, value])
}

fn reads(address: u8, register: u8, value: u8) -> Transaction {
    Transaction::write_read(address, vec![register], vec![value])
}

/// A start that succeeds.
fn transactions() -> Vec<Transaction> {
    vec![
        writes(ACCEL, 0x7E, 0xB6),
        writes(GYRO, 0x14, 0xB6),
        reads(ACCEL, 0x00, 0x1E),
        reads(GYRO, 0x00, 0x0F),
        writes(ACCEL, 0x7C, 0x00),
        writes(ACCEL, 0x7D, 0x04),
        writes(ACCEL, 0x40, 0x8C),
        writes(ACCEL, 0x41, 0x03),
        writes(GYRO, 0x0F, 0x00),
        writes(GYRO, 0x10, 0x02),
        writes(GYRO, 0x16, 0x01),
        writes(GYRO, 0x18, 0x01),
        writes(GYRO, 0x15, 0x80),
        reads(ACCEL, 0x7C, 0x00),
        reads(ACCEL, 0x7D, 0x04),
        reads(ACCEL, 0x40, 0x8C),
        reads(ACCEL, 0x41, 0x03),
        reads(GYRO, 0x0F, 0x00),
        reads(GYRO, 0x10, 0x82),
        reads(GYRO, 0x16, 0x01),
        reads(GYRO, 0x18, 0x01),
        reads(GYRO, 0x15, 0x80),
    ]
}

fn start(transactions: &[Transaction]) -> Result<(), StartError<ErrorKind>> {
    let mut bus = Mock::new(transactions);
    let started = finish(Bmi088::new(bus.clone()).start(&mut NoopDelay));
    bus.done();
    started
}

#[test]
fn the_start_writes_and_reads_back_exactly_this() {
    assert_eq!(start(&transactions()), Ok(()));
}

#[test]
fn an_error_at_every_access_ends_the_start() {
    for access in 0..transactions().len() {
        let mut until = transactions();
        until.truncate(access + 1);
        let failing = until.pop().map(|one| one.with_error(ErrorKind::Other));
        until.extend(failing);
        assert_eq!(start(&until), Err(StartError::Bus(ErrorKind::Other)), "{access}");
    }
}

#[test]
fn a_setting_that_is_not_kept_ends_the_start() {
    for (access, address, register, expected) in
        [(2, ACCEL, 0x00, 0x1E), (15, ACCEL, 0x40, 0x8C), (18, GYRO, 0x10, 0x82)]
    {
        let mut until = transactions();
        until.truncate(access);
        until.push(reads(address, register, 0x55));
        let differs = StartError::Differs { address, register, expected, found: 0x55 };
        assert_eq!(start(&until), Err(differs), "{access}");
    }
}

#[test]
fn samples_are_rates_then_accelerations() {
    let mut bus = Mock::new(&[
        Transaction::write_read(GYRO, vec![0x02], vec![0, 0x40, 0, 0xC0, 1, 0]),
        Transaction::write_read(ACCEL, vec![0x12], vec![0, 0x80, 0, 0, 0, 0x20]),
        Transaction::write_read(GYRO, vec![0x02], vec![0; 6]).with_error(ErrorKind::Other),
    ]);
    let mut imu = Bmi088::new(bus.clone());
    let step = 2000.0 / 32_768.0;
    assert_eq!(finish(imu.read()), Ok([1000.0, -1000.0, step, -24.0, 0.0, 6.0]));
    assert_eq!(finish(imu.read()), Err(ErrorKind::Other));
    bus.done();
}
