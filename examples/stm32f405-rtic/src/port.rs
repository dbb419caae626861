//! tinyODIN's two event buses on the GPIO ports.

use core::convert::Infallible;
use cortex_m::asm;
use spikewire::chip::AerPort;
use stm32f4xx_hal::gpio::{
    Input, Output, PB8, PB9, PC10, PC11, PC12, PEPin, outport::OutPortArray,
};

/// How long a word may take to settle at the chip: 100 ns at 168 MHz. Longer wires want more.
const SETTLE: u32 = 17;

pub struct Port {
    /// Bit n of a word is PCn.
    pub input: OutPortArray<'C', 10>,
    pub input_request: PC10<Output>,
    pub input_acknowledge: PC11<Input>,
    /// Bit n of a neuron's address is PBn.
    pub output: [PEPin<'B', Input>; 8],
    pub output_request: PB8<Input>,
    pub output_acknowledge: PB9<Output>,
    pub reset: PC12<Output>,
}

impl AerPort for Port {
    type Error = Infallible;

    /// One store to BSRR: the ten lines change together, and no other pin of the port does.
    fn set_input(&mut self, word: u32) -> Result<(), Infallible> {
        self.input.write(word);
        asm::delay(SETTLE);
        Ok(())
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), Infallible> {
        self.input_request.set_state(is_high.into());
        Ok(())
    }

    fn input_acknowledge(&mut self) -> Result<bool, Infallible> {
        Ok(self.input_acknowledge.is_high())
    }

    fn output_request(&mut self) -> Result<bool, Infallible> {
        Ok(self.output_request.is_high())
    }

    /// The chip holds the address until the acknowledge, so the pins need not be read at once.
    fn output(&mut self) -> Result<u8, Infallible> {
        Ok(self.output.iter().rev().fold(0, |bits, pin| bits << 1 | u8::from(pin.is_high())))
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), Infallible> {
        self.output_acknowledge.set_state(is_high.into());
        Ok(())
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), Infallible> {
        self.reset.set_state(is_high.into());
        Ok(())
    }
}
