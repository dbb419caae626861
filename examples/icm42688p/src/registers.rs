//! The sensor's registers, all of bank 0: DS-000347, section 14.

pub(crate) const DEVICE_CONFIG: u8 = 0x11;
const INT_CONFIG: u8 = 0x14;
const FIFO_CONFIG: u8 = 0x16;
/// The FIFO's count and the FIFO itself follow it.
pub(crate) const INT_STATUS: u8 = 0x2D;
pub(crate) const SIGNAL_PATH_RESET: u8 = 0x4B;
const INTF_CONFIG0: u8 = 0x4C;
const INTF_CONFIG1: u8 = 0x4D;
const PWR_MGMT0: u8 = 0x4E;
const GYRO_CONFIG0: u8 = 0x4F;
const ACCEL_CONFIG0: u8 = 0x50;
const FIFO_CONFIG1: u8 = 0x5F;
const FIFO_CONFIG2: u8 = 0x60;
const FIFO_CONFIG3: u8 = 0x61;
const INT_CONFIG1: u8 = 0x64;
const INT_SOURCE0: u8 = 0x65;
pub(crate) const WHO_AM_I: u8 = 0x75;
pub(crate) const REG_BANK_SEL: u8 = 0x76;

/// Set in the first byte of a read.
pub(crate) const READ: u8 = 0x80;
pub(crate) const IDENTITY: u8 = 0x47;
pub(crate) const SOFT_RESET: u8 = 0x01;
/// In [`SIGNAL_PATH_RESET`].
pub(crate) const FIFO_FLUSH: u8 = 0x02;
/// In [`INT_STATUS`].
pub(crate) const FIFO_FULL: u8 = 0x02;

/// What is written after a reset, in this order, and read back. The filters stay as the reset leaves them.
pub(crate) const CONFIGURATION: [(u8, u8); 12] = [
    (INT_CONFIG, 0x03),   // INT1 is pulsed, push-pull, active high
    (INT_CONFIG1, 0x60),  // pulses of 8 µs, as 4 kHz and more require, and INT_ASYNC_RESET off
    (INTF_CONFIG0, 0x33), // count in bytes, big endian; SPI alone
    (INTF_CONFIG1, 0x51), // AFSR off, which stalls the gyroscope's output at times
    (FIFO_CONFIG, 0x40),  // the FIFO streams: the oldest packet gives way
    (FIFO_CONFIG1, 0x27), // accelerometer, gyroscope, temperature; an interrupt for each packet above the watermark
    (FIFO_CONFIG2, (crate::WATERMARK * crate::PACKET) as u8),
    (FIFO_CONFIG3, 0),
    (INT_SOURCE0, 0x04),   // the watermark, on INT1
    (GYRO_CONFIG0, 0x03),  // ±2000 °/s at 8 kHz
    (ACCEL_CONFIG0, 0x03), // ±16 g at 8 kHz
    (PWR_MGMT0, 0x0F), // both on, low noise; last, as no register may be written for 200 µs after it
];

/// What is written where the sensor's newest sample is read from its registers; ranges and rates come in between.
pub(crate) const POLLED: [(u8, u8); 3] = [
    (INTF_CONFIG0, 0x33), // big endian; SPI alone
    (INTF_CONFIG1, 0x51), // AFSR off, which stalls the gyroscope's output at times
    (PWR_MGMT0, 0x0F),    // both on, low noise
];
