//! The BMI323: six channels, a pulse on INT1 for each sample.

use bmi323_driver::{
    AccelConfig, AccelMode, AccelRange, ActiveLevel, Bmi323, Error, GyroConfig, GyroMode,
    GyroRange, ImuData, InterruptChannel, InterruptPinConfig, InterruptRoute, InterruptSource,
    OutputDataRate, OutputMode, SpiTransport,
};
use embedded_hal::{delay::DelayNs, spi::SpiDevice};
use fixed::{FixedI32, types::extra::U16};
use spikewire::temporal::StepForward;

/// Samples a second, and the time between two.
pub const SAMPLE_RATE: u16 = 800;
pub const PERIOD_US: u16 = (1_000_000 / SAMPLE_RATE as u32) as u16;

/// A rate in °/s or an acceleration in g: every count of the sensor is one of these, exactly.
pub type Value = FixedI32<U16>;

/// ±2000 °/s and ±16 g in 16 bits: what a count is, in steps of 2^-16.
const RATE_COUNT: i32 = 4_000;
const ACCELERATION_COUNT: i32 = 32;

/// A spike for every 6 °/s.
static RATE: StepForward<Value> = StepForward::new(Value::lit("6"));
/// A spike for every 0.05 g.
static ACCELERATION: StepForward<Value> = StepForward::new(Value::lit("0.05"));
/// Rates about x, y and z, then accelerations along them.
pub const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
pub type Schemes = [&'static StepForward<Value>; 6];

pub type Imu<D> = Bmi323<SpiTransport<D>>;

/// Resets the sensor, and lets it sample at 800 Hz.
pub fn start<D: SpiDevice>(device: D, delay: &mut impl DelayNs) -> Result<Imu<D>, Error<D::Error>> {
    let mut imu = Bmi323::new_spi(device);
    imu.init(delay)?;
    imu.set_accel_config(AccelConfig {
        mode: AccelMode::HighPerformance,
        range: AccelRange::G16,
        odr: OutputDataRate::Hz800,
        ..Default::default()
    })?;
    imu.set_gyro_config(GyroConfig {
        mode: GyroMode::HighPerformance,
        range: GyroRange::Dps2000,
        odr: OutputDataRate::Hz800,
        ..Default::default()
    })?;
    imu.configure_interrupt_pin(
        InterruptChannel::Int1,
        InterruptPinConfig {
            active_level: ActiveLevel::High,
            output_mode: OutputMode::PushPull,
            enabled: true,
        },
    )?;
    // Both sensors sample together: one of them says when.
    imu.map_interrupt(InterruptSource::GyroDataReady, InterruptRoute::Int1)?;
    Ok(imu)
}

/// Rates, then accelerations.
pub fn read<D: SpiDevice>(imu: &mut Imu<D>) -> Result<[Value; 6], Error<D::Error>> {
    let ImuData { gyro, accel } = imu.read_imu_data()?;
    let rate = |count: i16| Value::from_bits(i32::from(count) * RATE_COUNT);
    let acceleration = |count: i16| Value::from_bits(i32::from(count) * ACCELERATION_COUNT);
    Ok([
        rate(gyro.x),
        rate(gyro.y),
        rate(gyro.z),
        acceleration(accel.x),
        acceleration(accel.y),
        acceleration(accel.z),
    ])
}
