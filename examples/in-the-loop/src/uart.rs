//! USART1 of an STM32F405 as QEMU's netduinoplus2 has it: no clock to enable, no baud rate.

use core::ptr::{
    read_volatile, with_exposed_provenance, with_exposed_provenance_mut, write_volatile,
};

const STATUS: usize = 0x4001_1000;
const DATA: usize = 0x4001_1004;
const CONTROL: usize = 0x4001_100C;

const RECEIVED: u32 = 1 << 5;
const ENABLE: u32 = 1 << 13;
const TRANSMIT: u32 = 1 << 3;
const RECEIVE: u32 = 1 << 2;

pub struct Uart(());

impl Uart {
    pub fn new() -> Self {
        write(CONTROL, ENABLE | TRANSMIT | RECEIVE);
        Self(())
    }

    /// Waits for as many bytes.
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        [(); N].map(|()| {
            while read(STATUS) & RECEIVED == 0 {}
            read(DATA) as u8
        })
    }

    pub fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            write(DATA, (*byte).into());
        }
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
