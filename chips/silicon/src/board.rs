//! A board with a chip: the SPI device and the port of a driver, which share the chip, and the port of tinyODIN and
//! ODIN.
//!
//! The chip's time advances with the driver's calls: by `ratio` clocks for each SPI clock, and by `call_clocks` for
//! each call of the port.

use alloc::collections::VecDeque;
use alloc::rc::Rc;
use core::cell::{RefCell, RefMut};

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use spikewire_chips::AerPort;

use super::chip::{Chip, Kind};

/// A chip's model: its clock, and the pins of its SPI.
pub trait Model: Default {
    /// Runs the chip for this many clocks.
    fn run(&mut self, clocks: u32);

    /// Returns the level of MISO.
    fn miso(&self) -> bool;

    /// Raises SCK, with MOSI at `bit`.
    fn rise(&mut self, bit: bool);

    /// Lowers SCK.
    fn fall(&mut self);
}

/// A fault of an SPI clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockFault {
    /// The chip does not see the clock.
    Lost,
    /// The chip sees two clocks.
    Doubled,
}

/// A fault of a call of the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallFault {
    /// The call fails before it has any effect.
    Before,
    /// The call takes effect, and returns an error.
    After,
}

/// The chip, the wires and their faults.
#[derive(Debug)]
pub struct Pins<C> {
    /// The chip.
    pub chip: C,
    /// Number of the chip's clocks for one SPI clock: 1 or more; 2 or more for `ReckOn`.
    pub ratio: u32,
    /// Number of the chip's clocks for one call of the port.
    pub call_clocks: u32,
    /// Extra clocks of the chip between the read of an output and its ACK, one entry for each output in turn.
    pub output_delays: VecDeque<u32>,
    /// Number of SPI clocks so far.
    pub spi_clocks: u64,
    /// Faults of SPI clocks, each with the clock's number, in order.
    pub clock_faults: VecDeque<(u64, ClockFault)>,
    /// Number of calls of the port so far.
    pub calls: u64,
    /// Faults of calls of the port, each with the call's number, in order.
    pub call_faults: VecDeque<(u64, CallFault)>,
    /// Whether `SCHED_FULL` is wired to the microcontroller.
    pub has_full_pin: bool,
}

/// A board, shared between a driver and a test.
#[derive(Debug)]
pub struct Board<C>(Rc<RefCell<Pins<C>>>);

impl<C> Clone for Board<C> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<C: Model> Board<C> {
    /// Makes a board with a chip just powered up, `ratio` of its clocks for one SPI clock and `call_clocks` for a call
    /// of the port.
    pub fn new(ratio: u32, call_clocks: u32) -> Self {
        Self(Rc::new(RefCell::new(Pins {
            chip: C::default(),
            ratio,
            call_clocks,
            output_delays: VecDeque::new(),
            spi_clocks: 0,
            clock_faults: VecDeque::new(),
            calls: 0,
            call_faults: VecDeque::new(),
            has_full_pin: false,
        })))
    }

    /// Borrows the chip and the wires.
    ///
    /// # Panics
    /// Panics if they are borrowed already.
    pub fn pins(&self) -> RefMut<'_, Pins<C>> {
        self.0.borrow_mut()
    }

    /// Returns the SPI device.
    pub fn spi(&self) -> Spi<C> {
        Spi(self.clone())
    }

    /// Returns the port.
    pub fn port(&self) -> Port<C> {
        Port(self.clone())
    }

    /// Lets the chip run for this many clocks.
    pub fn run(&self, clocks: u32) {
        self.pins().chip.run(clocks);
    }
}

/// The chip's SPI pins.
#[derive(Debug)]
pub struct Spi<C>(Board<C>);

impl<C> ErrorType for Spi<C> {
    type Error = ErrorKind;
}

impl<C: Model> Pins<C> {
    fn spi_bit(&mut self, bit: bool) -> bool {
        self.chip.run(self.ratio / 2);
        let fault = due(&mut self.clock_faults, self.spi_clocks);
        self.spi_clocks += 1;
        let out = self.chip.miso();
        if fault == Some(ClockFault::Lost) {
            self.chip.run(self.ratio.div_ceil(2));
            return out;
        }
        self.chip.rise(bit);
        if fault == Some(ClockFault::Doubled) {
            self.chip.run(1);
            self.chip.fall();
            self.chip.run(1);
            self.chip.rise(bit);
        }
        self.chip.run(self.ratio.div_ceil(2));
        self.chip.fall();
        out
    }
}

impl<C: Model> SpiDevice for Spi<C> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut pins = self.0.pins();
        transact(operations, |bit| pins.spi_bit(bit))
    }
}

/// Transfers bytes, the highest bit first.
fn transact(
    operations: &mut [Operation<'_, u8>],
    mut exchange: impl FnMut(bool) -> bool,
) -> Result<(), ErrorKind> {
    let mut byte = |byte: u8| {
        (0..8).rev().fold(0, |out, at| out << 1 | u8::from(exchange(byte >> at & 1 == 1)))
    };
    for operation in operations {
        match operation {
            Operation::Write(bytes) => bytes.iter().for_each(|&sent| {
                byte(sent);
            }),
            Operation::TransferInPlace(bytes) => {
                for place in bytes.iter_mut() {
                    *place = byte(*place);
                }
            }
            _ => return Err(ErrorKind::Other),
        }
    }
    Ok(())
}

/// Takes the fault that is due now, if there is one.
fn due<T: Copy>(faults: &mut VecDeque<(u64, T)>, now: u64) -> Option<T> {
    let &(at, fault) = faults.front()?;
    (at == now).then(|| {
        faults.pop_front();
        fault
    })
}

/// The chip's parallel pins.
#[derive(Debug)]
pub struct Port<C>(Board<C>);

impl<C: Model> Port<C> {
    /// Advances the chip's time, then acts. The error is the number of the call.
    pub(crate) fn call<T>(&mut self, act: impl FnOnce(&mut Pins<C>) -> T) -> Result<T, u64> {
        let mut pins = self.0.pins();
        let call = pins.calls;
        pins.calls += 1;
        let clocks = pins.call_clocks;
        pins.chip.run(clocks);
        let fault = due(&mut pins.call_faults, call);
        if fault == Some(CallFault::Before) {
            return Err(call);
        }
        let value = act(&mut pins);
        if fault == Some(CallFault::After) { Err(call) } else { Ok(value) }
    }
}

impl<K: Kind> AerPort for Port<Chip<K>> {
    type Error = u64;

    fn set_input(&mut self, word: u32) -> Result<(), u64> {
        self.call(|pins| pins.chip.set_word(word))
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), u64> {
        self.call(|pins| pins.chip.set_request(is_high))
    }

    fn input_acknowledge(&mut self) -> Result<bool, u64> {
        self.call(|pins| pins.chip.acknowledge())
    }

    fn output_request(&mut self) -> Result<bool, u64> {
        self.call(|pins| pins.chip.output().request)
    }

    fn output(&mut self) -> Result<u8, u64> {
        self.call(|pins| {
            let address = pins.chip.output().address;
            let delay = pins.output_delays.pop_front().unwrap_or(0);
            pins.chip.run(delay);
            address
        })
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), u64> {
        self.call(|pins| pins.chip.set_output_acknowledge(is_high))
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), u64> {
        self.call(|pins| pins.chip.set_reset(is_high))
    }

    /// Reads the pin together with the others, which takes no extra time.
    fn queue_full(&mut self) -> Result<Option<bool>, u64> {
        let pins = self.0.pins();
        Ok(pins.has_full_pin.then(|| pins.chip.is_full()))
    }
}

/// Delays run the chip's clock, which is taken to be 10 MHz.
impl<C: Model> DelayNs for Board<C> {
    fn delay_ns(&mut self, ns: u32) {
        self.run(ns.div_ceil(100));
    }
}
