//! USARTs of an STM32F405 as QEMU's netduinoplus2 has them: no clock to enable, no baud rate, always ready to send.

use core::{
    convert::Infallible,
    ptr::{read_volatile, with_exposed_provenance, with_exposed_provenance_mut, write_volatile},
};

const STATUS: usize = 0x00;
const DATA: usize = 0x04;
const CONTROL: usize = 0x0C;

const RECEIVED: u32 = 1 << 5;
const ENABLE: u32 = 1 << 13;
const TRANSMIT: u32 = 1 << 3;
const RECEIVE: u32 = 1 << 2;

/// A port, by the address of its registers.
pub struct Usart<const AT: usize>(());

pub type Usart1 = Usart<0x4001_1000>;
pub type Usart2 = Usart<0x4000_4400>;

impl<const AT: usize> Usart<AT> {
    pub fn new() -> Self {
        write(AT + CONTROL, ENABLE | TRANSMIT | RECEIVE);
        Self(())
    }

    /// A byte, if one has come. Firmware for a real part takes it in the interrupt, or by DMA.
    pub fn byte(&mut self) -> Option<u8> {
        (read(AT + STATUS) & RECEIVED != 0).then(|| read(AT + DATA) as u8)
    }

    /// Waits for as many bytes.
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        [(); N].map(|()| {
            loop {
                if let Some(byte) = self.byte() {
                    break byte;
                }
            }
        })
    }

    pub fn send(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            write(AT + DATA, byte.into());
        }
    }
}

impl<const AT: usize> Default for Usart<AT> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const AT: usize> embedded_io::ErrorType for Usart<AT> {
    type Error = Infallible;
}

impl<const AT: usize> embedded_io::Write for Usart<AT> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.send(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn read(register: usize) -> u32 {
    // SAFETY: a register of the part, which nothing else touches.
    unsafe { read_volatile(with_exposed_provenance(register)) }
}

fn write(register: usize, value: u32) {
    // SAFETY: as above.
    unsafe { write_volatile(with_exposed_provenance_mut(register), value) };
}
