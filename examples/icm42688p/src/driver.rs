//! The sensor on its bus.

use embedded_hal_async::{delay::DelayNs, spi::SpiDevice};

use crate::{
    burst::{Burst, PACKET, WATERMARK},
    registers::{
        CONFIGURATION, DEVICE_CONFIG, FIFO_FLUSH, FIFO_FULL, IDENTITY, INT_STATUS, READ,
        REG_BANK_SEL, SIGNAL_PATH_RESET, SOFT_RESET, WHO_AM_I,
    },
};

/// Bytes before the packets of a burst: address, status, count.
const HEAD: usize = 4;

/// What every transfer goes through.
pub type Buffer = [u8; HEAD + WATERMARK * PACKET];

/// A buffer before its first use.
pub const NEW_BUFFER: Buffer = [0; HEAD + WATERMARK * PACKET];

/// Bytes that the FIFO holds. A count from here on is none.
const FIFO_BYTES: u16 = 2048;

/// From power on, or a reset, to the first access.
const RESET_MS: u32 = 2;
/// From both sensors on to samples that are good: 30 ms for the gyroscope, and a margin.
const SETTLE_MS: u32 = 50;

/// Why the sensor could not be started or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// The bus failed.
    Bus,
    /// Another device answers, or none: 0x00 and 0xFF are an open line.
    Identity(u8),
    /// A register does not keep what was written.
    Register {
        /// Its address.
        address: u8,
        /// What was written.
        wrote: u8,
        /// What was read back.
        read: u8,
    },
    /// The FIFO ran over: samples are lost.
    Overrun,
}

/// An ICM-42688-P on SPI, mode 0 or 3, up to 24 MHz.
#[derive(Debug)]
pub struct Icm42688p<'b, D> {
    device: D,
    bytes: &'b mut Buffer,
}

impl<'b, D: SpiDevice> Icm42688p<'b, D> {
    /// The sensor, before its start.
    pub fn new(device: D, bytes: &'b mut Buffer) -> Self {
        Self { device, bytes }
    }

    /// Resets the sensor, lets it sample at 8 kHz, and reads all of its configuration back; 52 ms.
    ///
    /// # Errors
    /// It is not there, or not as it should be.
    pub async fn start(&mut self, delay: &mut impl DelayNs) -> Result<(), Fault> {
        self.write(REG_BANK_SEL, 0).await?;
        self.write(DEVICE_CONFIG, SOFT_RESET).await?;
        delay.delay_ms(RESET_MS).await;
        let identity = self.read_register(WHO_AM_I).await?;
        if identity != IDENTITY {
            return Err(Fault::Identity(identity));
        }
        for (address, value) in CONFIGURATION {
            self.write(address, value).await?;
        }
        delay.delay_ms(SETTLE_MS).await;
        for (address, wrote) in CONFIGURATION {
            let read = self.read_register(address).await?;
            if read != wrote {
                return Err(Fault::Register { address, wrote, read });
            }
        }
        self.flush().await
    }

    /// Reads the oldest packets, [`WATERMARK`] at most, in one transfer of 132 bytes.
    ///
    /// # Errors
    /// The bus failed, or samples are lost: then [`flush`](Self::flush).
    pub async fn read(&mut self) -> Result<Burst<'_>, Fault> {
        self.bytes.fill(0);
        self.bytes[0] = READ | INT_STATUS;
        self.device.transfer_in_place(&mut self.bytes[..]).await.map_err(|_| Fault::Bus)?;
        let [_, status, high, low, packets @ ..] = &self.bytes[..] else { return Err(Fault::Bus) };
        let count = u16::from_be_bytes([*high, *low]);
        if status & FIFO_FULL != 0 || count >= FIFO_BYTES {
            return Err(Fault::Overrun);
        }
        let (packets, _) = packets.as_chunks();
        Ok(Burst::new(packets, usize::from(count) / PACKET))
    }

    /// Empties the FIFO.
    ///
    /// # Errors
    /// The bus failed.
    pub async fn flush(&mut self) -> Result<(), Fault> {
        self.write(SIGNAL_PATH_RESET, FIFO_FLUSH).await
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
