//! The recording: a hexarotor taking off, flying and landing hard. `data/README.md` tells where it comes from.

use fixed::{
    FixedI16, FixedI32,
    types::extra::{U8, U16},
};
use spikewire::Sample;

/// Gyroscope x, y, z in rad/s, then accelerometer x, y, z in m/s².
pub const CHANNELS: usize = 6;

/// A sample type, and what one of its units is on either sensor.
pub trait Recorded: Sample {
    /// Units for 1 rad/s.
    const GYRO: f64 = 1.0;
    /// Units for 1 m/s².
    const ACCEL: f64 = 1.0;
}

impl Recorded for f32 {}
impl Recorded for FixedI16<U8> {}
impl Recorded for FixedI32<U16> {}

/// Counts of a usual inertial sensor at its widest ranges, ±2000 °/s and ±16 g.
impl Recorded for i16 {
    const GYRO: f64 = 32_768.0 / 2000.0 * 57.295_779_513_082_32;
    const ACCEL: f64 = 32_768.0 / 16.0 / 9.806_65;
}

/// One channel's samples, in order.
pub fn channel<S: Recorded>(index: usize) -> impl Iterator<Item = S> + Clone {
    let unit = if index < 3 { S::GYRO } else { S::ACCEL };
    let values = flight_data::channel(flight_data::HEXAROTOR, index);
    values.map(move |value| S::from_f64(f64::from(value) * unit))
}
