//! The BMI323: six channels, a pulse on INT1 for each sample.

use bmi323_driver::{
    AccelConfig, AccelMode, AccelRange, ActiveLevel, Bmi323, Error, GyroConfig, GyroMode,
    GyroRange, ImuData, InterruptChannel, InterruptPinConfig, InterruptRoute, InterruptSource,
    OutputDataRate, OutputMode, SpiTransport,
};
use embedded_hal::{delay::DelayNs, spi::SpiDevice};
use spikewire::temporal::StepForward;

/// Samples a second, and the time between two.
pub const SAMPLE_RATE: u16 = 800;
pub const PERIOD_US: u16 = (1_000_000 / SAMPLE_RATE as u32) as u16;

/// A spike for every 6 °/s, in counts of ±2000 °/s.
const RATE: StepForward<i16> = StepForward::<i16>::checked(98);
/// A spike for every 0.05 g, in counts of ±16 g.
const ACCELERATION: StepForward<i16> = StepForward::<i16>::checked(102);
/// Rates about x, y and z, then accelerations along them.
pub const SCHEMES: [StepForward<i16>; 6] =
    [RATE, RATE, RATE, ACCELERATION, ACCELERATION, ACCELERATION];

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
pub fn read<D: SpiDevice>(imu: &mut Imu<D>) -> Result<[i16; 6], Error<D::Error>> {
    let ImuData { gyro, accel } = imu.read_imu_data()?;
    Ok([gyro.x, gyro.y, gyro.z, accel.x, accel.y, accel.z])
}
