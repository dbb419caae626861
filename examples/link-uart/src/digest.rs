//! All decoded values as one number.

use core::fmt;

use spikewire::Tick;

/// FNV-1a over channel, time and bits of every value, in order.
pub struct Digest {
    values: u32,
    hash: u64,
}

impl Digest {
    pub const fn new() -> Self {
        Self { values: 0, hash: 0xcbf2_9ce4_8422_2325 }
    }

    pub fn add(&mut self, channel: u16, tick: Tick, value: f32) {
        self.values += 1;
        let words = [u32::from(channel), tick.micros(), value.to_bits()];
        for byte in words.into_iter().flat_map(u32::to_le_bytes) {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} values hash={:016x}", self.values, self.hash)
    }
}
