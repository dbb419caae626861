//! The BMI323 of the examples: 800 samples a second, ±2000 °/s, ±16 g, a pulse on INT1 for each.

use bmi323_driver::{
    AccelConfig, AccelMode, AccelRange, Access, ActiveLevel, AverageSamples, Bandwidth, Bmi323,
    Error, GyroConfig, GyroMode, GyroRange, InterruptChannel, InterruptPinConfig, InterruptRoute,
    InterruptSource, OutputDataRate, OutputMode,
};
#[cfg(feature = "blocking")]
use embedded_hal::delay::DelayNs;
#[cfg(not(feature = "blocking"))]
use embedded_hal_async::delay::DelayNs;

use crate::{Plan, Timing};

/// The vendor's driver waits 2 µs after every access (`bmi3_get_regs` and `bmi3_set_regs` of BMI323_SensorAPI). The guard
/// is longer than half a period from 2.5 MHz on.
pub const TIMING: Timing = Timing { guard: 200, pause: 2_000 };

/// A second's samples.
pub const SAMPLE_RATE: u16 = 800;

/// 100 ms to settle, for starts of any kind: the data sheet's fastest takes 2.5 ms. Ten periods of silence, or twenty equal
/// samples, are no accident.
pub const fn plan(most_spikes: u8) -> Plan {
    Plan {
        period: (1_000_000 / SAMPLE_RATE as u32) as u16,
        settle: SAMPLE_RATE / 10,
        keyframe_every: SAMPLE_RATE,
        patience: 12_500,
        most_alike: 20,
        most_spikes,
    }
}

const ACCEL: AccelConfig = AccelConfig {
    mode: AccelMode::HighPerformance,
    average: AverageSamples::Avg1,
    bandwidth: Bandwidth::OdrOver2,
    range: AccelRange::G16,
    odr: OutputDataRate::Hz800,
};

const GYRO: GyroConfig = GyroConfig {
    mode: GyroMode::HighPerformance,
    average: AverageSamples::Avg1,
    bandwidth: Bandwidth::OdrOver2,
    range: GyroRange::Dps2000,
    odr: OutputDataRate::Hz800,
};

const INT1: InterruptPinConfig = InterruptPinConfig {
    active_level: ActiveLevel::High,
    output_mode: OutputMode::PushPull,
    enabled: true,
};

/// What the registers hold after the start: no error, both configurations, INT1 on, active high and push-pull, and the
/// gyroscope's data-ready on it.
const READ_BACK: [(u8, u16); 5] =
    [(0x01, 0), (0x20, ACCEL.to_word()), (0x21, GYRO.to_word()), (0x38, 0b101), (0x3B, 1 << 8)];

/// Why the sensor did not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartError<E> {
    /// The bus failed, or the sensor is another or none: a bus that nobody drives has the identity 0x00 or 0xFF.
    Driver(Error<E>),
    /// A register does not hold what was written.
    Differs { register: u8, expected: u16, found: u16 },
}

impl<E> From<Error<E>> for StartError<E> {
    fn from(error: Error<E>) -> Self {
        Self::Driver(error)
    }
}

/// Resets the sensor, configures it, and reads back what it was told. Takes 3 ms and some transfers; may be called again.
///
/// # Errors
/// The sensor is not there, or not as it was told to be.
#[maybe_async::maybe_async]
pub async fn start<T, E>(imu: &mut Bmi323<T>, delay: &mut impl DelayNs) -> Result<(), StartError<E>>
where
    Bmi323<T>: Access<BusError = E>,
{
    imu.init(delay).await?;
    imu.set_accel_config(ACCEL).await?;
    imu.set_gyro_config(GYRO).await?;
    imu.configure_interrupt_pin(InterruptChannel::Int1, INT1).await?;
    // Both sensors sample together: one of them says when.
    imu.map_interrupt(InterruptSource::GyroDataReady, InterruptRoute::Int1).await?;
    for (register, expected) in READ_BACK {
        let found = imu.read_word(register).await.map_err(Error::Bus)?;
        if found != expected {
            return Err(StartError::Differs { register, expected, found });
        }
    }
    Ok(())
}

/// Why there is no sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadError<E> {
    /// The driver's.
    Driver(Error<E>),
    /// The sensor says that it has none: 0x8000 on all axes, as before its first sample.
    NoData,
}

/// What all three axes hold before there is a sample.
const NO_DATA: i16 = i16::MIN;

/// Rates about x, y and z, then accelerations along them, in counts of 2000 °/s and of 16 g in 2¹⁵.
///
/// # Errors
/// The bus failed, or the sensor has no sample.
#[maybe_async::maybe_async]
pub async fn read<T, E>(imu: &mut Bmi323<T>) -> Result<[i16; 6], ReadError<E>>
where
    Bmi323<T>: Access<BusError = E>,
{
    let data = imu.read_imu_data().await.map_err(ReadError::Driver)?;
    let (rate, acceleration) = (data.gyro, data.accel);
    let counts = [rate.x, rate.y, rate.z, acceleration.x, acceleration.y, acceleration.z];
    let (rates, accelerations) = counts.split_at(3);
    if [rates, accelerations].iter().any(|axes| axes.iter().all(|&count| count == NO_DATA)) {
        return Err(ReadError::NoData);
    }
    Ok(counts)
}

/// Counts as °/s and g.
pub fn in_units(counts: [i16; 6]) -> [f32; 6] {
    let [rx, ry, rz, ax, ay, az] = counts.map(|count| f32::from(count) / 32_768.0);
    [rx * 2000.0, ry * 2000.0, rz * 2000.0, ax * 16.0, ay * 16.0, az * 16.0]
}
