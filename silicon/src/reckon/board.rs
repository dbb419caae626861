//! `ReckOn` on a board: the SPI device and the port of a driver, which share it.

use alloc::collections::VecDeque;
use alloc::rc::Rc;
use core::cell::{RefCell, RefMut};

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use spikewire::chip::ReckOnPort;

use super::{Inputs, ReckOn};
use crate::board::{CallFault, ClockFault, due, transact};

/// Chip and wires.
#[derive(Debug)]
pub struct Pins {
    /// The chip.
    pub chip: ReckOn,
    /// Clocks of the chip to one of SCK, 2 and above.
    pub ratio: u32,
    /// Clocks of the chip to a call of the port.
    pub call_clocks: u32,
    /// SPI clocks so far.
    pub spi_clocks: u64,
    /// What befalls them, in order.
    pub clock_faults: VecDeque<(u64, ClockFault)>,
    /// Calls of the port so far.
    pub calls: u64,
    /// What befalls them, in order.
    pub call_faults: VecDeque<(u64, CallFault)>,
}

/// Where a driver and a test meet.
#[derive(Clone, Debug)]
pub struct Board(Rc<RefCell<Pins>>);

impl Board {
    /// A chip as after power-up.
    pub fn new(ratio: u32, call_clocks: u32) -> Self {
        Self(Rc::new(RefCell::new(Pins {
            chip: ReckOn::default(),
            ratio,
            call_clocks,
            spi_clocks: 0,
            clock_faults: VecDeque::new(),
            calls: 0,
            call_faults: VecDeque::new(),
        })))
    }

    /// Chip and wires.
    ///
    /// # Panics
    /// They are in use.
    pub fn pins(&self) -> RefMut<'_, Pins> {
        self.0.borrow_mut()
    }

    /// The SPI device.
    pub fn spi(&self) -> Spi {
        Spi(self.clone())
    }

    /// The port.
    pub fn port(&self) -> Port {
        Port(self.clone())
    }
}

/// The chip's SPI pins.
#[derive(Debug)]
pub struct Spi(Board);

impl ErrorType for Spi {
    type Error = ErrorKind;
}

impl Pins {
    fn fault(&mut self) -> Option<ClockFault> {
        let clock = self.spi_clocks;
        self.spi_clocks += 1;
        due(&mut self.clock_faults, clock)
    }

    fn spi_bit(&mut self, bit: bool) -> bool {
        self.chip.run(self.ratio / 2);
        let fault = self.fault();
        let out = self.chip.outputs().miso;
        if fault != Some(ClockFault::Lost) {
            self.chip.rise(bit);
        }
        if fault == Some(ClockFault::Doubled) {
            self.chip.run(1);
            self.chip.fall();
            self.chip.run(1);
            self.chip.rise(bit);
        }
        self.chip.run(self.ratio.div_ceil(2));
        if fault != Some(ClockFault::Lost) {
            self.chip.fall();
        }
        out
    }
}

impl SpiDevice for Spi {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut pins = self.0.pins();
        transact(operations, |bit| pins.spi_bit(bit))
    }
}

/// The chip's other pins.
#[derive(Debug)]
pub struct Port(Board);

impl Port {
    /// Time passes, then `act` does what the call is for. The error is the call's number.
    fn call<T>(&mut self, act: impl FnOnce(&mut ReckOn) -> T) -> Result<T, u64> {
        let mut pins = self.0.pins();
        let call = pins.calls;
        pins.calls += 1;
        let clocks = pins.call_clocks;
        pins.chip.run(clocks);
        let fault = due(&mut pins.call_faults, call);
        if fault == Some(CallFault::Before) {
            return Err(call);
        }
        let value = act(&mut pins.chip);
        if fault == Some(CallFault::After) { Err(call) } else { Ok(value) }
    }

    fn set(&mut self, change: impl FnOnce(&mut Inputs)) -> Result<(), u64> {
        self.call(|chip| {
            let mut inputs = chip.inputs();
            change(&mut inputs);
            chip.set_inputs(inputs);
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
        self.call(|chip| chip.outputs().acknowledge)
    }

    fn output_request(&mut self) -> Result<bool, u64> {
        self.call(|chip| chip.outputs().request)
    }

    fn output(&mut self) -> Result<u8, u64> {
        self.call(|chip| chip.outputs().data)
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
        self.call(|chip| chip.outputs().error_or_ready)
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), u64> {
        self.set(|pins| pins.reset = is_high)
    }
}

/// Delays are of the chip's clock, taken as 10 MHz.
impl DelayNs for Board {
    fn delay_ns(&mut self, ns: u32) {
        self.pins().chip.run(ns.div_ceil(100));
    }
}
