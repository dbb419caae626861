//! The BMI088 of a Crazyflie 2.1, on I2C: 1000 samples a second, ±2000 °/s, ±24 g, a pulse on INT3 for each rate.
//!
//! Two sensors in one case, each with an address. Registers and values are those of the data sheet, BST-BMI088-DS001.

use core::fmt;

use embedded_hal_async::{delay::DelayNs, i2c::I2c};

use crate::{
    Burst, CHANNELS, Fault, Imu, Plan, Sample,
    code::{Jumps, MOST, threshold},
};

/// Address of the accelerometer, as the Crazyflie has it: SDO1 low.
pub const ACCEL: u8 = 0x18;
/// Address of the gyroscope: SDO2 high.
pub const GYRO: u8 = 0x69;

/// Number of samples a second.
pub const SAMPLE_RATE: u16 = 1_000;

/// A spike for every 6 °/s, of ±2000 °/s.
static RATE: Jumps = threshold(6.0, 2000.0);
/// A spike for every 0.1 g, of ±24 g.
static ACCELERATION: Jumps = threshold(0.1, 24.0);

/// A register's sensor and address, what is written, and what is then read: a bit is always 1.
type Setting = (u8, u8, u8, u8);

const IDENTITIES: [(u8, u8); 2] = [(ACCEL, 0x1E), (GYRO, 0x0F)];
const SOFT_RESETS: [(u8, u8); 2] = [(ACCEL, 0x7E), (GYRO, 0x14)];
const SOFT_RESET: u8 = 0xB6;

const SETTINGS: [Setting; 9] = [
    (ACCEL, 0x7C, 0x00, 0x00), // active
    (ACCEL, 0x7D, 0x04, 0x04), // on
    (ACCEL, 0x40, 0x8C, 0x8C), // 1600 Hz, fourfold oversampling: 145 Hz, as the Crazyflie flies
    (ACCEL, 0x41, 0x03, 0x03), // ±24 g
    (GYRO, 0x0F, 0x00, 0x00),  // ±2000 °/s
    (GYRO, 0x10, 0x02, 0x82),  // 1000 Hz, 116 Hz of bandwidth
    (GYRO, 0x16, 0x01, 0x01),  // INT3 push-pull, active high
    (GYRO, 0x18, 0x01, 0x01),  // data-ready on INT3
    (GYRO, 0x15, 0x80, 0x80),  // data-ready on
];
const ACCEL_DATA: u8 = 0x12;
const GYRO_DATA: u8 = 0x02;

/// From a reset to the first access: the gyroscope's 30 ms, and a margin.
const RESET_MS: u32 = 50;
/// From one setting to the next; the accelerometer, once it is on, takes 5 ms for the next.
const SETTING_MS: u32 = 5;

/// The sensor on its bus.
pub struct Bmi088<B> {
    bus: B,
}

impl<B> fmt::Debug for Bmi088<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bmi088").finish_non_exhaustive()
    }
}

impl<B: I2c> Bmi088<B> {
    /// A sensor that was not started.
    pub fn new(bus: B) -> Self {
        Self { bus }
    }

    async fn axes(&mut self, die: u8, register: u8) -> Result<[i16; 3], Fault> {
        let mut bytes = [0; 6];
        self.bus.write_read(die, &[register], &mut bytes).await.map_err(|_| Fault::Bus)?;
        let [xl, xh, yl, yh, zl, zh] = bytes;
        Ok([[xl, xh], [yl, yh], [zl, zh]].map(i16::from_le_bytes))
    }

    async fn write(&mut self, die: u8, register: u8, value: u8) -> Result<(), Fault> {
        self.bus.write(die, &[register, value]).await.map_err(|_| Fault::Bus)
    }

    async fn register(&mut self, die: u8, register: u8) -> Result<u8, Fault> {
        let mut found = [0];
        self.bus.write_read(die, &[register], &mut found).await.map_err(|_| Fault::Bus)?;
        Ok(found[0])
    }
}

/// A start takes 0.1 s. In [`Fault::Register`] the die's address is the upper byte.
impl<B: I2c> Imu for Bmi088<B> {
    type Scheme = Jumps;

    const SCHEMES: [&'static Jumps; CHANNELS] =
        [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];

    /// Ten periods of silence, or twenty equal samples, are no accident; 100 ms to settle.
    const PLAN: Plan = Plan {
        period: 1_000_000 / SAMPLE_RATE as u32,
        settle: SAMPLE_RATE / 10,
        keyframe_every: SAMPLE_RATE / crate::KEYFRAMES,
        patience: 10_000,
        burst: 1,
        most_alike: 20,
        most_spikes: MOST as u8,
    };

    async fn start(&mut self, delay: &mut impl DelayNs) -> Result<(), Fault> {
        for (die, register) in SOFT_RESETS {
            self.write(die, register, SOFT_RESET).await?;
        }
        delay.delay_ms(RESET_MS).await;
        for (die, identity) in IDENTITIES {
            let found = self.register(die, 0x00).await?;
            if found != identity {
                return Err(Fault::Identity(found.into()));
            }
        }
        for (die, register, value, _) in SETTINGS {
            self.write(die, register, value).await?;
            delay.delay_ms(SETTING_MS).await;
        }
        for (die, register, _, expected) in SETTINGS {
            let read = self.register(die, register).await?;
            if read != expected {
                let address = u16::from_be_bytes([die, register]);
                return Err(Fault::Register { address, wrote: expected.into(), read: read.into() });
            }
        }
        Ok(())
    }

    async fn read(
        &mut self,
    ) -> Result<Burst<impl ExactSizeIterator<Item = Option<Sample>>>, Fault> {
        let [rx, ry, rz] = self.axes(GYRO, GYRO_DATA).await?;
        let [ax, ay, az] = self.axes(ACCEL, ACCEL_DATA).await?;
        Ok(Burst { held: 1, samples: [Some([rx, ry, rz, ax, ay, az])].into_iter() })
    }
}
