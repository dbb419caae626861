//! The chip's sources of random numbers: shift registers with feedback that give many bits a clock.

/// A register of `width` bits whose bits follow `s[n] = s[n - width] ^ s[n - tap]`, and which gives `bits` of them
/// a clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lfsr {
    width: i32,
    tap: i32,
    bits: i32,
    state: u32,
}

/// A clock's bits, the first in bit 0 of the first word.
pub(super) type Bits = [u64; 8];

/// Up to 25 bits from before the clock, and 512 of the clock and after.
const LENGTH: usize = 26 + 512 + 26;
const NOW: i32 = 26;

impl Lfsr {
    pub(super) const fn new(width: i32, tap: i32, bits: i32) -> Self {
        Self { width, tap, bits, state: 0 }
    }

    pub(super) fn set(&mut self, state: u32) {
        self.state = state & ((1 << self.width) - 1);
    }

    /// The place in the sequence of a bit of the state; 0 is the first bit that is given now.
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

    /// The bits of this clock.
    pub(super) fn bits(&self) -> Bits {
        let s = self.sequence(self.bits);
        let mut bits = [0; 8];
        for at in 0..self.bits {
            bits[at as usize / 64] |= u64::from(s[(NOW + at) as usize]) << (at % 64);
        }
        bits
    }

    /// The bits of this clock, if there are no more than 32.
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
