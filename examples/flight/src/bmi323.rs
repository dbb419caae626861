//! The BMI323 on SPI: 800 samples a second, ±2000 °/s, ±16 g, a pulse on INT1 for each.

use bmi323_driver::{
    AccelConfig, AccelMode, AccelRange, Access, ActiveLevel, AverageSamples, Bandwidth, Error,
    GyroConfig, GyroMode, GyroRange, InterruptChannel, InterruptPinConfig, InterruptRoute,
    InterruptSource, OutputDataRate, OutputMode, SpiTransport,
};
use embedded_hal_async::{delay::DelayNs, spi::SpiDevice};

use crate::{
    Burst, CHANNELS, Fault, Imu, Plan, Sample, Timing,
    code::{Jumps, MOST, threshold},
};

/// Times between accesses: the vendor's driver waits 2 µs after each (`bmi3_get_regs` and `bmi3_set_regs` of
/// BMI323_SensorAPI). The guard is longer than half a period from 2.5 MHz on.
pub const TIMING: Timing = Timing { guard: 200, pause: 2_000 };

/// Number of samples a second.
pub const SAMPLE_RATE: u16 = 800;

/// A spike for every 6 °/s, of ±2000 °/s.
static RATE: Jumps = threshold(6.0, 2000.0);
/// A spike for every 0.1 g, of ±16 g.
static ACCELERATION: Jumps = threshold(0.1, 16.0);

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

/// Registers of one read: identity, errors, status, accelerations and rates.
const FIRST: u8 = 0x00;
const WORDS: usize = 9;
const IDENTITY: u16 = 0x43;
/// In the status: a power-on reset since the last look, and a new sample of the gyroscope.
const WAS_RESET: u16 = 1;
const IS_NEW: u16 = 1 << 6;
/// What all three axes hold before there is a sample.
const NO_DATA: u16 = 0x8000;

/// The sensor on its bus.
pub struct Bmi323<D>(bmi323_driver::Bmi323<SpiTransport<D>>);

impl<D> core::fmt::Debug for Bmi323<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Bmi323").finish_non_exhaustive()
    }
}

impl<D: SpiDevice> Bmi323<D> {
    /// A sensor that was not started, on SPI, mode 0 or 3, up to 10 MHz.
    pub fn new(device: D) -> Self {
        Self(bmi323_driver::Bmi323::new_spi(device))
    }

    async fn configure(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<D::Error>> {
        let Self(imu) = self;
        imu.init(delay).await?;
        imu.set_accel_config(ACCEL).await?;
        imu.set_gyro_config(GYRO).await?;
        imu.configure_interrupt_pin(InterruptChannel::Int1, INT1).await?;
        // Both sensors sample together: one of them says when.
        imu.map_interrupt(InterruptSource::GyroDataReady, InterruptRoute::Int1).await
    }
}

/// A start takes 3 ms. Each read brings the identity and the status with the sample, in one transfer of 20 bytes: a line
/// that floats cannot pass for a sensor, and a reset that nobody asked for is noticed.
impl<D: SpiDevice> Imu for Bmi323<D> {
    type Scheme = Jumps;

    const SCHEMES: [&'static Jumps; CHANNELS] =
        [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];

    /// 100 ms to settle, for starts of any kind: the data sheet's fastest takes 2.5 ms. Ten periods of silence, or twenty
    /// equal samples, are no accident.
    const PLAN: Plan = Plan {
        period: 1_000_000 / SAMPLE_RATE as u32,
        settle: SAMPLE_RATE / 10,
        keyframe_every: SAMPLE_RATE / crate::KEYFRAMES,
        patience: 12_500,
        burst: 1,
        most_alike: 20,
        most_spikes: MOST as u8,
    };

    async fn start(&mut self, delay: &mut impl DelayNs) -> Result<(), Fault> {
        self.configure(delay).await.map_err(|error| match error {
            Error::InvalidChipId(found) => Fault::Identity(found.into()),
            _ => Fault::Bus,
        })?;
        for (register, wrote) in READ_BACK {
            let read = self.0.read_word(register).await.map_err(|_| Fault::Bus)?;
            if read != wrote {
                return Err(Fault::Register { address: register.into(), wrote, read });
            }
        }
        Ok(())
    }

    async fn read(
        &mut self,
    ) -> Result<Burst<impl ExactSizeIterator<Item = Option<Sample>>>, Fault> {
        let mut words = [0; WORDS];
        self.0.read_words(FIRST, &mut words).await.map_err(|_| Fault::Bus)?;
        let [identity, errors, status, ax, ay, az, rx, ry, rz] = words;
        // The upper byte is reserved.
        if identity & 0xFF != IDENTITY {
            return Err(Fault::Identity(identity));
        }
        if status & WAS_RESET != 0 {
            return Err(Fault::Restarted);
        }
        let (rates, accelerations) = ([rx, ry, rz], [ax, ay, az]);
        let has_none = rates == [NO_DATA; 3] || accelerations == [NO_DATA; 3];
        if errors != 0 || status & IS_NEW == 0 || has_none {
            return Err(Fault::NoData);
        }
        let sample = [rx, ry, rz, ax, ay, az].map(u16::cast_signed);
        Ok(Burst { held: 1, samples: [Some(sample)].into_iter() })
    }
}
