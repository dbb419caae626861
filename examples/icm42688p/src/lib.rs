//! An ICM-42688-P at 8 kHz, on SPI, through its FIFO.
//!
//! The sensor raises INT1 for every eighth sample, and one transfer brings the eight: a thousand interrupts a second in place
//! of eight thousand, for up to a millisecond of latency. The FIFO holds 16 ms, so that a late task loses nothing.
//! [`Icm42688p`] keeps the contract of [`flight::Imu`]: give it to a [`flight::Watch`].
//!
//! [`Polled`] is the same sensor at the rate of a flight's file: its newest sample, out of its registers, for a
//! [`flight::Station`].
//!
//! A part whose DMA does not reach every memory gives the driver a [`Buffer`] in one that it reaches: every transfer goes
//! through that buffer.

#![cfg_attr(not(test), no_std)]

mod burst;
mod driver;
mod polled;
mod registers;

pub use burst::{PACKET, WATERMARK};
pub use driver::{Buffer, Icm42688p, NEW_BUFFER, SAMPLE_RATE, TIMING};
pub use polled::Polled;
