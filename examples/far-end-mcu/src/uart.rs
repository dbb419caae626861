//! Two USARTs of an STM32F405 as QEMU's netduinoplus2 has them: no clock to enable, no baud rate.

use core::ptr::{read_volatile, write_volatile};

const USART1: usize = 0x4001_1000;
const USART2: usize = 0x4000_4400;
const STATUS: usize = 0x00;
const DATA: usize = 0x04;
const CONTROL: usize = 0x0C;

const RECEIVED: u32 = 1 << 5;
const ENABLE: u32 = 1 << 13;
const TRANSMIT: u32 = 1 << 3;
const RECEIVE: u32 = 1 << 2;

/// USART1.
pub struct Listener(());

impl Listener {
    pub fn new() -> Self {
        write(USART1 + CONTROL, ENABLE | RECEIVE);
        Self(())
    }

    /// A byte, if one has come. Firmware for a real part takes it in the interrupt, or by DMA.
    pub fn byte(&mut self) -> Option<u8> {
        (read(USART1 + STATUS) & RECEIVED != 0).then(|| read(USART1 + DATA) as u8)
    }
}

/// USART2, which is always ready.
pub struct Speaker(());

impl Speaker {
    pub fn new() -> Self {
        write(USART2 + CONTROL, ENABLE | TRANSMIT);
        Self(())
    }

    pub fn send(&mut self, bytes: [u8; 8]) {
        for byte in bytes {
            write(USART2 + DATA, byte.into());
        }
    }
}

fn read(register: usize) -> u32 {
    // SAFETY: a register of the part, which nothing else touches.
    unsafe { read_volatile(core::ptr::with_exposed_provenance(register)) }
}

fn write(register: usize, value: u32) {
    // SAFETY: as above.
    unsafe { write_volatile(core::ptr::with_exposed_provenance_mut(register), value) };
}
