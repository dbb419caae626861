//! A BMI323 on a bus, as far as its driver speaks to it: registers, data-ready, and the ways in which it fails.
//!
//! Not a model of the sensor's filters: the samples are the caller's.

use bmi323_driver::GyroMode;
use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation};
use embedded_hal_async::spi::SpiDevice;

/// A transfer that the bus broke off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault;

impl Error for Fault {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// What is wrong with the sensor or its wires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Trouble {
    #[default]
    None,
    /// No supply, or no wire: the bus reads as its pull-up or pull-down has it.
    Absent { level: u8 },
    /// This access, counted from 0, fails on the bus.
    Fails { access: usize },
    /// This access, counted from 0, is a write that the sensor does not hear, or a read of zeros.
    Deaf { access: usize },
}

/// The sensor as its master sees it.
#[derive(Clone, Debug)]
pub struct Sensor {
    registers: [u16; 128],
    /// After a power-up it takes the first access for I2C, and does not answer.
    is_spi: bool,
    trouble: Trouble,
    accesses: usize,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { registers: RESET, is_spi: false, trouble: Trouble::None, accesses: 0 }
    }
}

const CHIP_ID: u16 = 0x0043;
const STATUS: usize = 0x02;
const DATA: usize = 0x03;
const NO_DATA: u16 = 0x8000;

/// What the registers hold after a reset.
const RESET: [u16; 128] = {
    let mut registers = [0; 128];
    registers[0x00] = CHIP_ID;
    registers[0x02] = 1; // power-on reset detected
    let mut axis = DATA;
    while axis < DATA + 6 {
        registers[axis] = NO_DATA;
        axis += 1;
    }
    registers
};

impl Sensor {
    /// Whether there is a sample, and the pulse on INT1: rates, then accelerations, in counts.
    pub fn sample(&mut self, [rx, ry, rz, ax, ay, az]: [i16; 6]) -> bool {
        let gyro = (self.registers[0x21] >> 12) == GyroMode::HighPerformance as u16;
        let accel = (self.registers[0x20] >> 12) != 0;
        for (axis, (count, runs)) in
            [(ax, accel), (ay, accel), (az, accel), (rx, gyro), (ry, gyro), (rz, gyro)]
                .into_iter()
                .enumerate()
        {
            if runs {
                self.registers[DATA + axis] = count.cast_unsigned();
            }
        }
        self.registers[STATUS] |= 1 << 6; // a new sample of the gyroscope
        let is_on_int1 = (self.registers[0x3B] >> 8) & 3 == 1;
        let is_out = self.registers[0x38] & 0b100 != 0;
        gyro && is_on_int1 && is_out && !matches!(self.trouble, Trouble::Absent { .. })
    }

    /// Loses its supply and gets it back: everything is as after a reset.
    pub fn brown_out(&mut self) {
        *self = Self { accesses: self.accesses, trouble: self.trouble, ..Self::default() };
    }

    /// What is wrong from now on.
    pub fn set(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    fn access(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Fault> {
        let access = self.accesses;
        self.accesses += 1;
        // The rising edge of chip select at its end makes it SPI.
        let hears = core::mem::replace(&mut self.is_spi, true);
        let (hears, level) = match self.trouble {
            Trouble::Fails { access: bad } if bad == access => return Err(Fault),
            Trouble::Deaf { access: bad } if bad == access => (false, 0),
            Trouble::Absent { level } => {
                self.is_spi = false;
                (false, level)
            }
            _ => (hears, 0),
        };
        match operations {
            [Operation::Write([register, low, high])] => {
                if hears {
                    self.write(*register, u16::from_le_bytes([*low, *high]));
                }
            }
            [Operation::Write([command]), Operation::Read([dummy, bytes @ ..])] => {
                *dummy = level;
                let first = usize::from(*command & 0x7F);
                for (index, word) in bytes.chunks_mut(2).enumerate() {
                    let register = (first + index) & 0x7F;
                    let held = self.registers[register].to_le_bytes();
                    let read = if hears { held } else { [level; 2] };
                    word.copy_from_slice(&read);
                    if hears && register == STATUS {
                        self.registers[STATUS] = 0;
                    }
                }
            }
            _ => return Err(Fault),
        }
        Ok(())
    }

    fn write(&mut self, register: u8, word: u16) {
        match register {
            0x7E if word == 0xDEAF => self.registers = RESET,
            0x00..=0x1F | 0x7E => {}
            _ => self.registers[usize::from(register & 0x7F)] = word,
        }
    }
}

impl ErrorType for Sensor {
    type Error = Fault;
}

impl SpiDevice for Sensor {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Fault> {
        self.access(operations)
    }
}
