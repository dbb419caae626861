//! The sensor on its bus.

use embedded_hal_async::{delay::DelayNs, spi::SpiDevice};

use flight::{Burst, CHANNELS, Fault, Imu, Plan, Sample, Timing};
use spikewire::temporal::StepForward;

use crate::{
    burst::{PACKET, WATERMARK, samples},
    registers::{
        CONFIGURATION, DEVICE_CONFIG, FIFO_FLUSH, FIFO_FULL, IDENTITY, INT_STATUS, READ,
        REG_BANK_SEL, SIGNAL_PATH_RESET, SOFT_RESET, WHO_AM_I,
    },
};

/// Bytes before the packets of a burst: address, status, count.
const HEAD: usize = 4;

/// The bytes of every transfer, which DMA must reach.
pub type Buffer = [u8; HEAD + WATERMARK * PACKET];

/// A buffer before its first use.
pub const NEW_BUFFER: Buffer = [0; HEAD + WATERMARK * PACKET];

/// Bytes that the FIFO holds. A count from here on is none.
const FIFO_BYTES: u16 = 2048;

/// From power on, or a reset, to the first access.
const RESET_MS: u32 = 2;
/// From both sensors on to samples that are good: 30 ms for the gyroscope, and a margin.
const SETTLE_MS: u32 = 50;

/// Chip select's times: longer than half a clock from 5 MHz on.
pub const TIMING: Timing = Timing { guard: 100, pause: 0 };

/// Number of samples a second.
pub const SAMPLE_RATE: u16 = 8_000;

/// A spike for every 6 °/s: it follows 47 800 °/s².
static RATE: StepForward<i16> = StepForward::new(98);
/// A spike for every 0.16 g: it follows 1281 g/s, the steepest of 1 g at 200 Hz.
static ACCELERATION: StepForward<i16> = StepForward::new(328);

/// An ICM-42688-P on SPI, mode 0 or 3, up to 24 MHz.
#[derive(Debug)]
pub struct Icm42688p<'b, D> {
    device: D,
    bytes: &'b mut Buffer,
}

impl<'b, D: SpiDevice> Icm42688p<'b, D> {
    /// A sensor that was not started, whose transfers go through these bytes.
    pub fn new(device: D, bytes: &'b mut Buffer) -> Self {
        Self { device, bytes }
    }

    async fn write(&mut self, address: u8, value: u8) -> Result<(), Fault> {
        self.two_bytes([address, value]).await.map(drop)
    }

    async fn read_register(&mut self, address: u8) -> Result<u8, Fault> {
        self.two_bytes([READ | address, 0]).await
    }

    async fn two_bytes(&mut self, bytes: [u8; 2]) -> Result<u8, Fault> {
        self.bytes[..2].copy_from_slice(&bytes);
        self.device.transfer_in_place(&mut self.bytes[..2]).await.map_err(|_| Fault::Bus)?;
        Ok(self.bytes[1])
    }
}

/// A start takes 52 ms, and all of the configuration is read back. A read is one transfer of 132 bytes, and tells by the
/// packets' headers whether the sensor is there. Counts are 16.4 for 1 °/s and 2048 for 1 g.
impl<D: SpiDevice> Imu for Icm42688p<'_, D> {
    type Scheme = StepForward<i16>;

    const SCHEMES: [&'static StepForward<i16>; CHANNELS] =
        [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];

    /// The start has let the sensor settle. Ten milliseconds of silence, or of equal samples, are no accident.
    const PLAN: Plan = Plan {
        period: 1_000_000 / SAMPLE_RATE as u32,
        settle: 0,
        keyframe_every: SAMPLE_RATE / flight::KEYFRAMES,
        patience: 10_000,
        burst: WATERMARK as u8,
        most_alike: 80,
        most_spikes: 1,
    };

    async fn start(&mut self, delay: &mut impl DelayNs) -> Result<(), Fault> {
        self.write(REG_BANK_SEL, 0).await?;
        self.write(DEVICE_CONFIG, SOFT_RESET).await?;
        delay.delay_ms(RESET_MS).await;
        let identity = self.read_register(WHO_AM_I).await?;
        if identity != IDENTITY {
            return Err(Fault::Identity(identity.into()));
        }
        for (address, value) in CONFIGURATION {
            self.write(address, value).await?;
        }
        delay.delay_ms(SETTLE_MS).await;
        for (address, wrote) in CONFIGURATION {
            let read = self.read_register(address).await?;
            if read != wrote {
                let [address, wrote, read] = [address, wrote, read].map(u16::from);
                return Err(Fault::Register { address, wrote, read });
            }
        }
        // The FIFO ran over meanwhile. Only a look takes that out of the status.
        self.write(SIGNAL_PATH_RESET, FIFO_FLUSH).await?;
        self.read_register(INT_STATUS).await.map(drop)
    }

    async fn read(
        &mut self,
    ) -> Result<Burst<impl ExactSizeIterator<Item = Option<Sample>>>, Fault> {
        self.bytes.fill(0);
        self.bytes[0] = READ | INT_STATUS;
        self.device.transfer_in_place(&mut self.bytes[..]).await.map_err(|_| Fault::Bus)?;
        let [_, status, high, low, packets @ ..] = &self.bytes[..] else { return Err(Fault::Bus) };
        let count = u16::from_be_bytes([*high, *low]);
        if status & FIFO_FULL != 0 || count >= FIFO_BYTES {
            return Err(Fault::Overrun);
        }
        let (packets, _) = packets.as_chunks();
        let held = usize::from(count) / PACKET;
        Ok(Burst { held, samples: samples(&packets[..held.min(packets.len())]) })
    }

    /// Empties the FIFO. If this fails, so does the next read.
    async fn recover(&mut self) {
        _ = self.write(SIGNAL_PATH_RESET, FIFO_FLUSH).await;
    }
}
