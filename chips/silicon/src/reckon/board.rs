//! The simulated board with a `ReckOn`, and the port for its driver.

use spikewire_chips::ReckOnPort;

use super::{Inputs, ReckOn};
use crate::board::{self, Model};

/// The pins of `ReckOn`, and their faults.
pub type Pins = board::Pins<ReckOn>;

/// A simulated board with a `ReckOn`.
pub type Board = board::Board<ReckOn>;

/// The SPI device of `ReckOn`.
pub type Spi = board::Spi<ReckOn>;

/// The port of `ReckOn`: all pins other than SPI.
pub type Port = board::Port<ReckOn>;

impl Model for ReckOn {
    fn run(&mut self, clocks: u32) {
        self.run(clocks);
    }

    fn miso(&self) -> bool {
        self.outputs().miso
    }

    fn rise(&mut self, bit: bool) {
        self.rise(bit);
    }

    fn fall(&mut self) {
        self.fall();
    }
}

impl Port {
    fn set(&mut self, change: impl FnOnce(&mut Inputs)) -> Result<(), u64> {
        self.call(|pins| {
            let mut inputs = pins.chip.inputs();
            change(&mut inputs);
            pins.chip.set_inputs(inputs);
        })
    }
}

impl ReckOnPort for Port {
    type Error = u64;

    fn set_input(&mut self, byte: u8, is_target: bool) -> Result<(), u64> {
        self.set(|pins| (pins.address, pins.is_target) = (byte, is_target))
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.request = is_high)
    }

    fn input_acknowledge(&mut self) -> Result<bool, u64> {
        self.call(|pins| pins.chip.outputs().acknowledge)
    }

    fn output_request(&mut self) -> Result<bool, u64> {
        self.call(|pins| pins.chip.outputs().request)
    }

    fn output(&mut self) -> Result<u8, u64> {
        self.call(|pins| pins.chip.outputs().data)
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.output_acknowledge = is_high)
    }

    fn set_sample(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.sample = is_high)
    }

    fn set_tick(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.tick = is_high)
    }

    fn set_target_valid(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.target_valid = is_high)
    }

    fn set_infer(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.infer = is_high)
    }

    fn ready(&mut self) -> Result<bool, u64> {
        self.call(|pins| pins.chip.outputs().error_or_ready)
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.reset = is_high)
    }
}
