//! The SPI slave of `ReckOn`. A frame is a header of 32 bits, followed by as many 32-bit words as the header says. The
//! slave has no chip select, and counts clock pulses from reset.

/// Flag in [`SpiSlave::writing`]: write the parameters of a pair of neurons.
pub(super) const PROG_NEURON: u16 = 1;
/// Flag in [`SpiSlave::writing`]: write the potential of an output.
pub(super) const PROG_OUTPUT: u16 = 1 << 1;
/// Flag in [`SpiSlave::writing`]: write weights from inputs.
pub(super) const PROG_INPUT_WEIGHTS: u16 = 1 << 2;
/// Flag in [`SpiSlave::writing`]: write weights between neurons.
pub(super) const PROG_RECURRENT_WEIGHTS: u16 = 1 << 3;
/// Flag in [`SpiSlave::writing`]: write weights to outputs.
pub(super) const PROG_OUTPUT_WEIGHTS: u16 = 1 << 4;
/// Flag in [`SpiSlave::writing`]: write the seed of the first random generator. The next eight bits are the flags of
/// the other generators.
pub(super) const PROG_SEED: u16 = 1 << 5;

/// Number of registers; the highest register number is 104.
pub(super) const REGISTERS: usize = 105;

/// The state of the slave, which changes with SCK only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SpiSlave {
    count: u32,
    header: u32,
    shift_in: u32,
    shift_out: u32,
    /// Address of the memory word that the chip's core is to access.
    pub(super) address: u16,
    /// The word that the core is to write.
    pub(super) data: u32,
    /// The writes that the core is to make, with one bit for each kind of write: the `PROG_` constants.
    pub(super) writing: u16,
    /// The memory reads that the core is to make, with one bit for each memory, from bit 0 on: pairs of neurons,
    /// outputs' potentials, weights from inputs, weights between neurons, weights to outputs.
    pub(super) reading: u8,
    registers: [u32; REGISTERS],
}

impl Default for SpiSlave {
    fn default() -> Self {
        Self {
            count: 0,
            header: 0,
            shift_in: 0,
            shift_out: 0,
            address: 0,
            data: 0,
            writing: 0,
            reading: 0,
            registers: [0; REGISTERS],
        }
    }
}

/// Returns the number of bits in a register; 0 if the chip has no such register.
const fn width(register: usize) -> u32 {
    match register {
        0 | 2 | 3 | 8 | 10 | 11 | 21 | 23 | 25..=27 | 30..=33 => 1,
        20 => 2,
        9 | 12..=17 | 19 => 3,
        18 | 96 | 104 => 4,
        74..=84 | 99..=103 => 5,
        22 | 69 | 94 | 95 => 8,
        1 => 9,
        98 => 12,
        89 => 15,
        70..=73 => 16,
        93 => 17,
        87 => 22,
        85 | 86 => 25,
        88 | 90..=92 => 30,
        64..=68 => 32,
        _ => 0,
    }
}

/// Returns a register's value after reset; `None` if reset does not change it.
const fn reset_value(register: usize) -> Option<u32> {
    match register {
        0 | 3 | 11 | 26 | 31 => Some(1),
        9 => Some(7),
        69 => Some(0x7A),
        94 | 95 => Some(0xFF),
        96 => Some(0xF),
        2 | 8 | 10 | 12..=23 | 25 | 27 | 30 | 32 | 33 | 65..=68 => Some(0),
        _ => None,
    }
}

impl SpiSlave {
    /// Resets the slave, and all registers that have a reset value.
    pub(super) fn reset(&mut self) {
        (self.count, self.header, self.shift_out) = (0, 0, 0);
        (self.writing, self.reading) = (0, 0);
        for (at, register) in self.registers.iter_mut().enumerate() {
            if let Some(value) = reset_value(at) {
                *register = value;
            }
        }
    }

    /// Returns the value of a configuration register.
    pub(super) const fn register(&self, register: usize) -> u32 {
        self.registers[register]
    }

    /// Sets a register without SPI. Bits of `value` beyond the register's width are dropped.
    pub(super) fn set_register(&mut self, register: usize, value: u32) {
        self.registers[register] = value & ((1_u64 << width(register)) - 1) as u32;
    }

    /// Returns the level of MISO. `read` is the memory word that the core read last.
    pub(super) const fn output(&self, read: u32) -> bool {
        let is_first = self.header >> 31 == 1 && self.count & 31 == 0 && self.count >> 5 != 0;
        (if is_first { read } else { self.shift_out }) >> 31 == 1
    }

    /// Raises SCK, with MOSI at `bit`. If this bit completes the word for a register, writes the register, unless the
    /// chip's reset is high (`is_reset`).
    pub(super) fn rise(&mut self, bit: bool, is_reset: bool) {
        let word = self.shift_in << 1 | u32::from(bit);
        let is_register = self.header >> 28 == 0 && self.count & 31 == 31 && self.count >> 5 != 0;
        let register = usize::from(self.header as u16);
        if is_register && !is_reset && register < REGISTERS {
            self.set_register(register, word);
        }
        self.shift_in = word;
    }

    /// Lowers SCK. `read` is the memory word that the core read last.
    pub(super) fn fall(&mut self, read: u32) {
        let Self { count, header, shift_in, shift_out, .. } = *self;
        let (words, is_last) = (count >> 5, count & 31 == 31);
        let asked = if count == 31 { shift_in } else { header } >> 16 & 0xFFF;
        self.shift_out = shift_out << 1;
        let memory = |header: u32| match header >> 28 & 7 {
            code @ 1..=5 => 1_u8 << (code - 1),
            _ => 0,
        };
        if header >> 31 == 0 && is_last && words != 0 {
            self.shift_out = 0;
            let seed = match (header >> 28 & 7, header as u16) {
                (0, register @ 85..=93) => PROG_SEED << (register - 85),
                _ => 0,
            };
            self.writing = u16::from(memory(header)) | seed;
            self.address = (header as u16).wrapping_add(words as u16).wrapping_sub(1);
            self.data = shift_in;
        } else if shift_in >> 31 == 1 && count == 31 {
            self.reading = memory(shift_in);
            self.address = shift_in as u16;
        } else if header >> 31 == 1 && is_last && words != 0 && words < asked {
            self.reading = memory(header);
            self.address = (header as u16).wrapping_add(words as u16);
        } else if header >> 31 == 1 && count & 31 == 0 && words != 0 {
            self.shift_out = read << 1;
            (self.reading, self.writing) = (0, 0);
        } else if count & 31 == 0 {
            self.shift_out = shift_out;
            self.writing = 0;
        }
        if count == 31 {
            self.header = shift_in;
        }
        let is_end = is_last && words >= asked;
        self.count = if is_end { 0 } else { (count + 1) & 0x1_FFFF };
    }
}
