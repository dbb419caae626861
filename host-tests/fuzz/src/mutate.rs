//! Mutants of an input, from a fixed seed: what a fuzzer does, without its feedback.

/// A generator with a fixed start.
pub struct Random(u64);

impl Random {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed | 1)
    }

    /// A number below `end`, which is above 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 33) as usize % end
    }

    /// Changes a few places of the input: bits, bytes, a stretch cut out, doubled, or the end cut off.
    pub fn damage(&mut self, input: &mut Vec<u8>) {
        const TELLING: [u8; 8] = [0, 1, 0x7F, 0x80, 0xFF, b'\n', b',', b'-'];
        for _ in 0..=self.below(4) {
            if input.is_empty() {
                input.push(self.below(256) as u8);
            }
            let at = self.below(input.len());
            let end = (at + 1 + self.below(16)).min(input.len());
            match self.below(7) {
                0 => input[at] ^= 1 << self.below(8),
                1 => input[at] = self.below(256) as u8,
                2 => input[at] = TELLING[self.below(TELLING.len())],
                3 => drop(input.drain(at..end)),
                4 => input.splice(at..at, input[at..end].to_vec()).for_each(drop),
                5 => input.truncate(at),
                _ => input.insert(at, self.below(256) as u8),
            }
        }
    }
}
