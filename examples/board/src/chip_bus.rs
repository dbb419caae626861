//! A bus to a tinyODIN that only remembers: what is written to its memories reads back, all else as 0.

use core::convert::Infallible;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

/// Room for what a start writes: the byte of the step check, and the beacon's neuron.
#[derive(Default)]
pub struct ChipBus([(u32, u8); 4]);

impl ChipBus {
    /// A frame: 20 bits of address, of which the highest is for a read and the next for a write, and 20 of data.
    fn answer(&mut self, &[a0, a1, a2, keep, value]: &[u8; 5]) -> u8 {
        let command = u32::from_be_bytes([0, a0, a1, a2]) >> 4;
        let address = command & 0x3_FFFF;
        let is_here = |&&mut (known, _): &&mut (u32, u8)| known == address || known == 0;
        let Some((known, byte)) = self.0.iter_mut().find(is_here) else { return 0 };
        if command >> 18 == 1 {
            *known = address;
            *byte = *byte & keep | value & !keep;
        }
        if *known == address { *byte } else { 0 }
    }
}

impl ErrorType for ChipBus {
    type Error = Infallible;
}

impl SpiDevice for ChipBus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    if let Some(frame) = bytes.first_chunk() {
                        self.answer(frame);
                    }
                }
                Operation::TransferInPlace(bytes) => {
                    let answer = bytes.first_chunk().map(|frame| self.answer(frame));
                    if let (Some(answer), Some(last)) = (answer, bytes.last_mut()) {
                        *last = answer;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }
}
