//! The sensor at a flight's own rate: its newest sample, out of its registers.

use embedded_hal_async::spi::SpiDevice;
use flight::{Counts, Fault, Registers, Sample};

use crate::registers::{
    DEVICE_CONFIG, IDENTITY, INT_STATUS, POLLED, READ, REG_BANK_SEL, SOFT_RESET, WHO_AM_I,
};

/// Temperature, accelerations, rates, and what lies between them and the status; with the address.
const BURST: usize = 1 + (INT_STATUS - TEMP_DATA1) as usize + 1;
const TEMP_DATA1: u8 = 0x1D;
/// In the status: a new sample, and a reset since the last look.
const IS_NEW: u8 = 1 << 3;
const WAS_RESET: u8 = 1 << 4;
/// What an axis holds before there is a sample.
const NONE: i16 = i16::MIN;

/// The rates that the sensor has, in µs from sample to sample, with their code.
const RATES: [(u32, u8); 4] = [(1000, 6), (500, 5), (250, 4), (125, 3)];
/// What divides the rate into the bandwidth, with its code.
const DIVIDERS: [(u32, u8); 7] = [(4, 1), (5, 2), (8, 3), (10, 4), (16, 5), (20, 6), (40, 7)];

/// An ICM-42688-P on SPI, mode 0 or 3, up to 24 MHz, that is read once a period of a flight.
///
/// It samples at least twice a period, up to 8 kHz, behind its own filter, whose bandwidth is half of the flight's rate at
/// most (25 Hz at least, and 2 kHz at most): what the flight's rate cannot tell from slow motion does not come through.
#[derive(Debug)]
pub struct Polled<D> {
    device: D,
    settings: [(u8, u8); POLLED.len() + 3],
}

impl<D: SpiDevice> Polled<D> {
    /// A sensor that was not started, for a flight with this period in µs.
    pub const fn new(device: D, period: u32) -> Self {
        let [rate, bandwidth] = codes(period);
        let [clock, int, power] = POLLED;
        // Power comes last, as no register may be written for 200 µs after it.
        let settings =
            [clock, int, (0x4F, rate), (0x50, rate), (0x52, bandwidth << 4 | bandwidth), power];
        Self { device, settings }
    }

    async fn write(&mut self, address: u8, value: u8) -> Result<(), Fault> {
        self.device.transfer_in_place(&mut [address, value]).await.map_err(|_| Fault::Bus)
    }

    async fn register(&mut self, address: u8) -> Result<u8, Fault> {
        let mut bytes = [READ | address, 0];
        self.device.transfer_in_place(&mut bytes).await.map_err(|_| Fault::Bus)?;
        Ok(bytes[1])
    }

    async fn identify(&mut self) -> Result<(), Fault> {
        let identity = self.register(WHO_AM_I).await?;
        if identity == IDENTITY { Ok(()) } else { Err(Fault::Identity(identity.into())) }
    }
}

/// The codes of rate and bandwidth for a period.
const fn codes(period: u32) -> [u8; 2] {
    let (mut rate, mut at) = (RATES[RATES.len() - 1], RATES.len());
    while at > 0 {
        at -= 1;
        if 2 * RATES[at].0 <= period {
            rate = RATES[at];
        }
    }
    let (mut divider, mut at) = (DIVIDERS[DIVIDERS.len() - 1].1, DIVIDERS.len());
    while at > 0 {
        at -= 1;
        if DIVIDERS[at].0 * rate.0 >= 2 * period {
            divider = DIVIDERS[at].1;
        }
    }
    [rate.1, divider]
}

impl<D: SpiDevice> Registers for Polled<D> {
    /// ±2000 °/s and ±16 g.
    const COUNTS: Counts = Counts::of_ranges(2000.0, 16.0);
    const RESET_US: u32 = 2_000;
    /// 30 ms for the gyroscope, its filter, and a margin.
    const SETTLE_US: u32 = 80_000;

    async fn reset(&mut self) -> Result<(), Fault> {
        self.write(REG_BANK_SEL, 0).await?;
        self.write(DEVICE_CONFIG, SOFT_RESET).await
    }

    async fn configure(&mut self) -> Result<(), Fault> {
        self.identify().await?;
        for (address, value) in self.settings {
            self.write(address, value).await?;
        }
        Ok(())
    }

    async fn check(&mut self) -> Result<(), Fault> {
        for (address, wrote) in self.settings {
            let read = self.register(address).await?;
            if read != wrote {
                let [address, wrote, read] = [address, wrote, read].map(u16::from);
                return Err(Fault::Register { address, wrote, read });
            }
        }
        // A look takes the reset out of the status.
        self.register(INT_STATUS).await.map(drop)
    }

    async fn read(&mut self) -> Result<Sample, Fault> {
        let mut bytes = [0; BURST];
        bytes[0] = READ | TEMP_DATA1;
        self.device.transfer_in_place(&mut bytes).await.map_err(|_| Fault::Bus)?;
        // Behind the sample: a line that floats or is stuck in between is no identity.
        self.identify().await?;
        let [_, _, _, ax1, ax0, ay1, ay0, az1, az0, rx1, rx0, ry1, ry0, rz1, rz0, .., status] =
            bytes;
        if status & WAS_RESET != 0 {
            return Err(Fault::Restarted);
        }
        let sample = [[rx1, rx0], [ry1, ry0], [rz1, rz0], [ax1, ax0], [ay1, ay0], [az1, az0]]
            .map(i16::from_be_bytes);
        if status & IS_NEW == 0 || sample.contains(&NONE) {
            return Err(Fault::NoData);
        }
        Ok(sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensor_samples_twice_a_period_behind_half_of_the_rate() {
        for period in 250..=65_535 {
            let [rate, divider] = codes(period);
            let (own, _) = RATES.into_iter().find(|one| one.1 == rate).unwrap();
            let (by, _) = DIVIDERS.into_iter().find(|one| one.1 == divider).unwrap();
            assert!(2 * own <= period, "{period}");
            let hz = 1_000_000 / (own * by);
            assert!(hz * 2 * period <= 1_000_000 || divider == 7, "{period}: {hz} Hz");
        }
        assert_eq!(codes(5038), [6, 5]); // 1 kHz, 62.5 Hz
        assert_eq!(codes(125), [3, 1]);
    }
}
