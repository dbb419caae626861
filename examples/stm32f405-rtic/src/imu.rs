//! The BMI323: six channels, a pulse on INT1 for each sample.

use bmi323_driver::{
    AccelConfig, AccelMode, AccelRange, ActiveLevel, Bmi323, Error, GyroConfig, GyroMode,
    GyroRange, InterruptChannel, InterruptPinConfig, InterruptRoute, InterruptSource,
    OutputDataRate, OutputMode, SpiTransport,
};
use embedded_hal::{delay::DelayNs, spi::SpiDevice};
use spikewire::temporal::StepForward;

/// A spike for every 6 °/s.
static RATE: StepForward<f32> = StepForward::new(6.0);
/// A spike for every 0.05 g.
static ACCELERATION: StepForward<f32> = StepForward::new(0.05);
/// Rates about x, y and z, then accelerations along them.
pub const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
pub type Schemes = [&'static StepForward<f32>; 6];

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

/// Rates in °/s, then accelerations in g.
pub fn read<D: SpiDevice>(imu: &mut Imu<D>) -> Result<[f32; 6], Error<D::Error>> {
    let data = imu.read_imu_data()?;
    let [rx, ry, rz] = data.gyro.as_dps(imu.gyro_range());
    let [ax, ay, az] = data.accel.as_g(imu.accel_range());
    Ok([rx, ry, rz, ax, ay, az])
}
