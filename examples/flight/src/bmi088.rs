//! The BMI088 of a Crazyflie 2.1, on I2C: 1000 samples a second, ±2000 °/s, ±24 g, a pulse on INT3 for each rate.
//!
//! Two sensors in one case, each with an address. Registers and values are those of the data sheet, BST-BMI088-DS001.

use core::fmt;

#[cfg(feature = "blocking")]
use embedded_hal::{delay::DelayNs, i2c::I2c};
#[cfg(not(feature = "blocking"))]
use embedded_hal_async::{delay::DelayNs, i2c::I2c};

use crate::Plan;

/// The addresses that the Crazyflie has: SDO1 low, SDO2 high.
pub const ACCEL: u8 = 0x18;
pub const GYRO: u8 = 0x69;

/// A second's samples.
pub const SAMPLE_RATE: u16 = 1_000;

/// Ten periods of silence, or twenty equal samples, are no accident; 100 ms to settle.
pub const fn plan(most_spikes: u8) -> Plan {
    Plan {
        period: (1_000_000 / SAMPLE_RATE as u32) as u16,
        settle: SAMPLE_RATE / 10,
        keyframe_every: SAMPLE_RATE,
        patience: 10_000,
        most_alike: 20,
        most_spikes,
    }
}

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

/// Why the sensor could not be started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartError<E> {
    /// The bus failed; nobody at an address is such a failure too.
    Bus(E),
    /// A register of the sensor at this address does not hold what was written, or another sensor's identity.
    Differs { address: u8, register: u8, expected: u8, found: u8 },
}

/// The sensor on its bus.
pub struct Bmi088<B> {
    bus: B,
}

impl<B> fmt::Debug for Bmi088<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bmi088").finish_non_exhaustive()
    }
}

#[maybe_async::maybe_async]
impl<B: I2c> Bmi088<B> {
    pub fn new(bus: B) -> Self {
        Self { bus }
    }

    /// Resets both sensors, configures them, and reads back what they were told: 0.1 s. May be called again.
    ///
    /// # Errors
    /// One of them is not there, or not as it was told to be.
    pub async fn start(&mut self, delay: &mut impl DelayNs) -> Result<(), StartError<B::Error>> {
        for (address, register) in SOFT_RESETS {
            self.write(address, register, SOFT_RESET).await?;
        }
        delay.delay_ms(RESET_MS).await;
        for (address, identity) in IDENTITIES {
            self.expect(address, 0x00, identity).await?;
        }
        for (address, register, value, _) in SETTINGS {
            self.write(address, register, value).await?;
            delay.delay_ms(SETTING_MS).await;
        }
        for (address, register, _, expected) in SETTINGS {
            self.expect(address, register, expected).await?;
        }
        Ok(())
    }

    /// Rates in °/s, then accelerations in g.
    ///
    /// # Errors
    /// The bus failed.
    pub async fn read(&mut self) -> Result<[f32; 6], B::Error> {
        let [rx, ry, rz] = self.axes(GYRO, GYRO_DATA, 2000.0).await?;
        let [ax, ay, az] = self.axes(ACCEL, ACCEL_DATA, 24.0).await?;
        Ok([rx, ry, rz, ax, ay, az])
    }

    async fn axes(&mut self, address: u8, register: u8, range: f32) -> Result<[f32; 3], B::Error> {
        let mut bytes = [0; 6];
        self.bus.write_read(address, &[register], &mut bytes).await?;
        let [xl, xh, yl, yh, zl, zh] = bytes;
        let counts = [[xl, xh], [yl, yh], [zl, zh]].map(i16::from_le_bytes);
        Ok(counts.map(|count| f32::from(count) / 32_768.0 * range))
    }

    async fn write(
        &mut self,
        address: u8,
        register: u8,
        value: u8,
    ) -> Result<(), StartError<B::Error>> {
        self.bus.write(address, &[register, value]).await.map_err(StartError::Bus)
    }

    async fn expect(
        &mut self,
        address: u8,
        register: u8,
        expected: u8,
    ) -> Result<(), StartError<B::Error>> {
        let mut found = [0];
        let read = self.bus.write_read(address, &[register], &mut found).await;
        read.map_err(StartError::Bus)?;
        let [found] = found;
        if found == expected {
            Ok(())
        } else {
            Err(StartError::Differs { address, register, expected, found })
        }
    }
}
