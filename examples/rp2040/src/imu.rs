//! The sensor's samples in fixed point, and the code for them.

use bmi323_driver::{Bmi323, SpiTransport};
use fixed::{FixedI32, types::extra::U16};
use flight::{
    Plan,
    bmi323::{self, ReadError},
    code::{MOST, Schemes},
};
use spikewire::temporal::SendOnDelta;

use crate::board::{BusError, ImuDevice};

/// A rate in °/s or an acceleration in g: every count of the sensor is one of these, exactly.
pub type Value = FixedI32<U16>;
pub type Imu = Bmi323<SpiTransport<ImuDevice>>;

/// ±2000 °/s and ±16 g in 16 bits: what a count is, in steps of 2^-16.
const RATE_COUNT: i32 = 4_000;
const ACCELERATION_COUNT: i32 = 32;

/// The thresholds of `flight::code`, which says why.
static RATE: SendOnDelta<Value, MOST> = SendOnDelta::new(Value::lit("6"));
static ACCELERATION: SendOnDelta<Value, MOST> = SendOnDelta::new(Value::lit("0.1"));
/// Rates about x, y and z, then accelerations along them.
pub const SCHEMES: Schemes<Value> =
    [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];

/// What the sensor promises.
pub const PLAN: Plan = bmi323::plan(MOST as u8);

/// Rates, then accelerations.
pub fn read(imu: &mut Imu) -> Result<[Value; 6], ReadError<BusError>> {
    let [rx, ry, rz, ax, ay, az] = bmi323::read(imu)?.map(i32::from);
    let rates = [rx, ry, rz].map(|count| Value::from_bits(count * RATE_COUNT));
    let accelerations = [ax, ay, az].map(|count| Value::from_bits(count * ACCELERATION_COUNT));
    let ([rx, ry, rz], [ax, ay, az]) = (rates, accelerations);
    Ok([rx, ry, rz, ax, ay, az])
}
