//! The chip's random generators: linear-feedback shift registers that produce many bits in each clock cycle.

/// A shift register of `width` bits with the sequence `s[n] = s[n - width] ^ s[n - tap]`. It produces `bits` bits of
/// the sequence in each clock cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lfsr {
    width: i32,
    tap: i32,
    bits: i32,
    state: u32,
}

/// The bits that a generator produces in one clock cycle; the first is bit 0 of the first word.
pub(super) type Bits = [u64; 8];

/// Length in bits of the part of the sequence that is computed: 26 bits from before this clock cycle, 512 bits of this
/// clock cycle, and 26 bits from after it. No generator uses more than this.
const LENGTH: usize = 26 + 512 + 26;
const NOW: i32 = 26;

impl Lfsr {
    pub(super) const fn new(width: i32, tap: i32, bits: i32) -> Self {
        Self { width, tap, bits, state: 0 }
    }

    pub(super) fn set(&mut self, state: u32) {
        self.state = state & ((1 << self.width) - 1);
    }

    /// Returns the position of bit `bit` of the state in the generator's sequence. Position 0 is the first bit that the
    /// generator produces in this clock cycle; earlier bits have negative positions.
    fn place(&self, bit: i32) -> i32 {
        match (self.bits, bit) {
            (_, bit) if bit < self.tap => bit,
            (7, bit) if bit & 1 == 1 => bit / 2 - 14,
            (7, bit) => bit / 2 - 8,
            (_, bit) => bit - self.width,
        }
    }

    fn sequence(&self, end: i32) -> [bool; LENGTH] {
        let mut s = [false; LENGTH];
        for bit in 0..self.width {
            s[(NOW + self.place(bit)) as usize] = self.state >> bit & 1 == 1;
        }
        for at in NOW + self.tap..NOW + end {
            s[at as usize] = s[(at - self.width) as usize] ^ s[(at - self.tap) as usize];
        }
        s
    }

    /// Returns the bits that the generator produces in this clock cycle.
    pub(super) fn bits(&self) -> Bits {
        let s = self.sequence(self.bits);
        let mut bits = [0; 8];
        for at in 0..self.bits {
            bits[at as usize / 64] |= u64::from(s[(NOW + at) as usize]) << (at % 64);
        }
        bits
    }

    /// Returns the bits that the generator produces in this clock cycle, as one number. Only for generators of at most
    /// 32 bits in a clock cycle.
    pub(super) fn word(&self) -> u32 {
        self.bits()[0] as u32
    }

    pub(super) fn step(&mut self) {
        let s = self.sequence(self.bits + self.tap);
        let mut state = 0;
        for bit in 0..self.width {
            let at = NOW + self.place(bit) + self.bits;
            state |= u32::from(s[at as usize]) << bit;
        }
        self.state = state;
    }
}
