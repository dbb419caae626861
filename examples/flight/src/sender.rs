//! Frames to a UART or a USB port.

use embedded_io_async::Write;
use spikewire::{
    Bank, Source, Tick,
    link::{Coding, MAX_FRAME, Session, Transmitter},
};

use crate::{CHANNELS, Imu};

/// Turns a queue's items into frames, and writes them.
#[derive(Debug)]
pub struct Sender {
    transmitter: Transmitter,
    frame: [u8; MAX_FRAME],
    /// Number of bytes that the port took.
    pub bytes: u32,
    /// Number of frames that the port did not take. The far end notices the gap, and is exact again after the next
    /// keyframe.
    pub failed: u32,
}

impl Sender {
    /// A sender for the sensor's channels, before the first frame of this session.
    pub fn new<I: Imu>(session: Session) -> Self {
        // The sensor's clock is not ours: its samples come a few µs early or late.
        let coding = Coding::for_channels(CHANNELS as u16, I::PLAN.period).with_jitter_bits(4);
        let bank = Bank::<_, CHANNELS>::per_channel(I::SCHEMES);
        Self::of(Transmitter::new(coding, session).with_fingerprint(bank.fingerprint()))
    }

    /// A sender of these frames, such as those of a flight's module.
    pub const fn of(transmitter: Transmitter) -> Self {
        Self { transmitter, frame: [0; MAX_FRAME], bytes: 0, failed: 0 }
    }

    /// Says that all items before this time are in the source, so that events that wait for others may go. Needed at each
    /// turn if the flight's file has `gathering`.
    pub fn observe(&mut self, now: Tick) {
        self.transmitter.observe(now);
    }

    /// Sends all items that the source has, and lets the port send what it keeps.
    pub async fn send(&mut self, mut items: impl Source, port: &mut impl Write) {
        let before = self.bytes;
        while let Some(frame) = self.next_frame(&mut items) {
            let length = frame.len() as u32;
            match port.write_all(frame).await {
                Ok(()) => self.bytes = self.bytes.wrapping_add(length),
                Err(_) => self.failed = self.failed.wrapping_add(1),
            }
        }
        if self.bytes != before && port.flush().await.is_err() {
            self.failed = self.failed.wrapping_add(1);
        }
    }

    /// Returns the next frame, for a port of another kind, or `None` if the source has no item.
    pub fn next_frame(&mut self, items: impl Source) -> Option<&[u8]> {
        // The buffer has room for any frame.
        self.transmitter.next_frame(items, &mut self.frame).ok().flatten()
    }
}
