//! Bytes as a script of decisions: after their end all are 0.

use spikewire::Sample;

/// A script, read from its start.
pub struct Script<'a>(&'a [u8]);

impl<'a> Script<'a> {
    /// The decisions of these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Returns whether all decisions are made.
    pub fn is_over(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes the next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// Takes a number below `end`, which is at most 256.
    pub fn below(&mut self, end: usize) -> usize {
        usize::from(self.byte()) % end
    }

    /// Takes four bytes.
    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes([self.byte(), self.byte(), self.byte(), self.byte()])
    }

    /// Takes a float: any bits, or a handy number.
    pub fn float(&mut self) -> f32 {
        match self.byte() {
            0..8 => f32::from_bits(self.word()),
            8 => f32::NAN,
            9 => f32::INFINITY,
            10 => f32::MAX,
            11 => -f32::MIN_POSITIVE,
            _ => (f32::from(self.byte()) - 128.0) / 16.0 + f32::from(self.byte()) / 4096.0,
        }
    }

    /// Takes a sample: any bits, or a small number.
    pub fn sample<S: Sample>(&mut self) -> S {
        if self.below(4) == 0 {
            S::from_bits32(self.word())
        } else {
            let small = f64::from(self.byte()) - 128.0;
            S::from_f64(small / 16.0)
        }
    }

    /// Takes all that is left.
    pub fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.0)
    }
}
