//! One line of the report: counts and a hash, gathered sample by sample.

use core::fmt;

use crate::Log;
use spikewire::{Code, Polarity, Sample};

/// What one scheme did with one sample type.
pub struct Line {
    samples: u32,
    spikes: u32,
    decoded: u32,
    squares: f64,
    hash: u64,
}

impl Default for Line {
    fn default() -> Self {
        Self {
            samples: 0,
            spikes: 0,
            decoded: 0,
            squares: 0.0,
            hash: 0xcbf2_9ce4_8422_2325, // FNV-1a's start value
        }
    }
}

impl Log for Line {
    fn code(&mut self, code: &impl Code) {
        self.samples += 1;
        for firing in code.firings() {
            self.spikes += 1;
            self.hash(&firing.neuron.to_le_bytes());
            self.hash(&firing.slot.to_le_bytes());
            self.hash(&[u8::from(firing.polarity == Polarity::Up)]);
        }
        self.hash(&[0xff]);
    }

    fn decoded<S: Sample>(&mut self, sample: S, value: S) {
        let error = value.to_f64() - sample.to_f64();
        self.decoded += 1;
        self.squares += error * error;
        self.hash(&value.to_f64().to_bits().to_le_bytes());
    }
}

impl Line {
    /// `scheme sample spikes=<n> efficiency=<percent> rmse=<f32 bits> hash=<FNV-1a, 64 bits>`
    pub fn write(&self, out: &mut impl fmt::Write, scheme: &str, sample: &str) -> fmt::Result {
        // Hundredths of a percent, as the text of a float takes more flash than the smallest core has left.
        let firing = (u64::from(self.spikes) * 10_000).div_ceil(u64::from(self.samples.max(1)));
        let efficiency = 10_000 - firing as i32;
        let sign = if efficiency < 0 { "-" } else { "" };
        let (percent, hundredths) = (efficiency.abs() / 100, efficiency.abs() % 100);
        let rmse = libm::sqrt(self.squares / f64::from(self.decoded)) as f32;
        writeln!(
            out,
            "{scheme} {sample} spikes={} efficiency={sign}{percent}.{hundredths:02} rmse={:08x} hash={:016x}",
            self.spikes,
            rmse.to_bits(),
            self.hash,
        )
    }

    fn hash(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
