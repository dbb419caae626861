//! The Crazyflie's sensor on I2C.

use embedded_hal::i2c::ErrorKind;
use embedded_hal_mock::eh1::{delay::NoopDelay, i2c::Mock, i2c::Transaction};
use flight::{
    Fault, Imu,
    bmi088::{ACCEL, Bmi088, GYRO},
};

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

fn start(transactions: &[Transaction]) -> Result<(), Fault> {
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
        assert_eq!(start(&until), Err(Fault::Bus), "{access}");
    }
}

#[test]
fn another_identity_or_a_setting_that_is_not_kept_ends_the_start() {
    let register = |address, wrote| Fault::Register { address, wrote, read: 0x55 };
    for (access, die, address, fault) in [
        (2, ACCEL, 0x00, Fault::Identity(0x55)),
        (15, ACCEL, 0x40, register(0x1840, 0x8C)),
        (18, GYRO, 0x10, register(0x6910, 0x82)),
    ] {
        let mut until = transactions();
        until.truncate(access);
        until.push(reads(die, address, 0x55));
        assert_eq!(start(&until), Err(fault), "{access}");
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
    let sample = finish(imu.read()).unwrap().samples.next().unwrap();
    assert_eq!(sample, Some([0x4000, -0x4000, 1, i16::MIN, 0, 0x2000]));
    assert_eq!(finish(imu.read()).map(|_| ()), Err(Fault::Bus));
    bus.done();
}
