//! The SPI slave of tinyODIN and ODIN: frames of 40 clock pulses, counted from reset, without a chip select.

/// The state of the slave, which changes with SCK only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpiSlave {
    count: u8,
    address: u32,
    shift_in: u32,
    shift_out: u32,
    /// Whether the controller is to read a memory.
    pub is_reading: bool,
    /// Whether the controller is to write a memory.
    pub is_writing: bool,
    /// Address of the last access to a memory.
    pub memory_address: u16,
    /// Memory of the last access: 1 for neurons, 2 for synapses.
    pub memory: u8,
    /// For a write: the byte in bits 0 to 7, and in bits 8 to 15 the mask of the bits that keep their value.
    pub data: u16,
}

/// A complete write to a configuration register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Number of the register to write.
    pub register: u16,
    /// Value to write: the last 20 bits of the frame.
    pub value: u32,
}

impl SpiSlave {
    /// Resets the slave, except for the bits that were shifted in.
    pub fn reset(&mut self) {
        *self = Self { shift_in: self.shift_in, ..Self::default() };
    }

    /// Returns the level of MISO.
    pub const fn output(&self) -> bool {
        self.shift_out >> 19 & 1 == 1
    }

    /// Raises SCK, with MOSI at `bit`. Returns the write to a configuration register if it is now complete.
    pub fn rise(&mut self, bit: bool) -> Option<Written> {
        let before = self.shift_in;
        self.shift_in = (before << 1 | u32::from(bit)) & 0xF_FFFF;
        let is_register = self.count == 39 && self.address >> 16 & 3 == 0;
        is_register.then_some(Written { register: self.address as u16, value: self.shift_in })
    }

    /// Lowers SCK. `neuron` and `synapses` are the words that the controller last read from the two memories.
    pub fn fall(&mut self, neuron: u128, synapses: u32) {
        let shifted = self.shift_out << 1 & 0xF_FFFF;
        match self.count {
            19 if self.shift_in >> 18 != 0 => {
                let is_read = self.shift_in >> 19 == 1;
                self.shift_out = if is_read { shifted } else { 0 };
                self.memory = (self.shift_in >> 16 & 3) as u8;
                self.is_reading = is_read && self.memory != 0;
                self.is_writing = false;
                self.memory_address = self.shift_in as u16;
                self.data = 0;
            }
            31 if self.address >> 19 == 1 => {
                let byte = match self.memory {
                    2 => Some((synapses >> (8 * (self.memory_address >> 13 & 3))) as u8),
                    1 => {
                        neuron.checked_shr(8 * u32::from(self.memory_address >> 8)).map(|n| n as u8)
                    }
                    _ => None,
                };
                self.shift_out = match (byte, self.memory) {
                    (Some(byte), _) => u32::from(byte) << 12,
                    (None, 1) => 0,
                    _ => shifted,
                };
                self.is_reading = false;
                self.is_writing = false;
                self.data = 0;
            }
            39 if self.address >> 18 & 1 == 1 => {
                self.shift_out = shifted;
                self.is_reading = false;
                self.is_writing = self.memory != 0;
                self.data = self.shift_in as u16;
            }
            _ => {
                self.shift_out = shifted;
                self.is_writing = false;
            }
        }
        if self.count == 19 {
            self.address = self.shift_in;
        }
        self.count = if self.count == 39 { 0 } else { (self.count + 1) & 63 };
    }

    /// Returns the byte to write back to memory: the bits of `old` where the mask is 1, the bits of the data elsewhere.
    pub const fn merge(&self, old: u8) -> u8 {
        let (keep, byte) = ((self.data >> 8) as u8, self.data as u8);
        byte & !keep | old & keep
    }
}
