//! An ICM-42688-P at 8 kHz: six channels through the sensor's FIFO into spikes, and frames out of any port.
//!
//! - [`Icm42688p`] starts the sensor, reads its configuration back, and reads bursts of eight packets.
//! - [`Watch`] runs for ever: it samples and encodes, and starts the sensor again when it falls silent.
//! - [`Sender`] writes frames to a UART or a USB port.
//!
//! A part whose DMA does not reach every memory gives the driver a [`Buffer`] in one that it reaches: every transfer goes
//! through that buffer.

#![cfg_attr(not(test), no_std)]

mod burst;
mod driver;
mod pace;
mod registers;
mod sender;
mod watch;

pub use burst::{Burst, PACKET, WATERMARK};
pub use driver::{Buffer, Fault, Icm42688p, NEW_BUFFER};
pub use pace::Pace;
pub use sender::Sender;
pub use watch::{CHANNELS, PERIOD, PLAN, SAMPLE_RATE, SCHEMES, Schemes, Watch, encode};
