//! The simulated board: the model of a chip, and the SPI device and the port through which a driver accesses the chip.
//! Contains the port for tinyODIN and ODIN.
//!
//! The chip's time advances with the driver's calls: by `ratio` clock cycles for each SPI clock cycle, and by
//! `call_clocks` for each call of the port.

use alloc::collections::VecDeque;
use alloc::rc::Rc;
use core::cell::{RefCell, RefMut};

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use spikewire_chips::AerPort;

use super::chip::{Chip, Kind};

/// A model of a chip for a simulated board: runs the chip's clock, and drives and reads the chip's SPI pins.
pub trait Model: Default {
    /// Runs the chip for `clocks` clock cycles.
    fn run(&mut self, clocks: u32);

    /// Returns the level of MISO, the chip's SPI output.
    fn miso(&self) -> bool;

    /// Raises SCK, the SPI clock, with the chip's SPI input MOSI at `bit`.
    fn rise(&mut self, bit: bool);

    /// Lowers SCK, the SPI clock.
    fn fall(&mut self);
}

/// A fault of one SPI clock pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockFault {
    /// The chip does not see the clock pulse.
    Lost,
    /// The chip sees two clock pulses instead of one.
    Doubled,
}

/// A fault of one call of the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallFault {
    /// The call fails before it has any effect.
    Before,
    /// The call takes effect, and returns an error.
    After,
}

/// The chip, its clock settings, and the planned faults of its wires.
#[derive(Debug)]
pub struct Pins<C> {
    /// The model of the chip.
    pub chip: C,
    /// Number of the chip's clock cycles in one SPI clock cycle: at least 1, for `ReckOn` at least 2.
    pub ratio: u32,
    /// Number of the chip's clock cycles that one call of the port takes.
    pub call_clocks: u32,
    /// Extra clock cycles of the chip between the read of an output and the ACK for it. Each output takes the next
    /// entry, or 0 if no entry is left.
    pub output_delays: VecDeque<u32>,
    /// Number of SPI clock cycles so far.
    pub spi_clocks: u64,
    /// Planned faults of SPI clock pulses, each with the number of the pulse, in ascending order.
    pub clock_faults: VecDeque<(u64, ClockFault)>,
    /// Number of calls of the port so far.
    pub calls: u64,
    /// Planned faults of port calls, each with the number of its call, in ascending order.
    pub call_faults: VecDeque<(u64, CallFault)>,
    /// Whether the chip's pin `SCHED_FULL` is wired to the microcontroller.
    pub has_full_pin: bool,
}

/// A simulated board, which a driver and a test share.
#[derive(Debug)]
pub struct Board<C>(Rc<RefCell<Pins<C>>>);

impl<C> Clone for Board<C> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<C: Model> Board<C> {
    /// Makes a board with a chip that has just been powered up. `ratio` and `call_clocks` are the fields of [`Pins`].
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

    /// Borrows the chip and its wires.
    ///
    /// # Panics
    /// Panics if they are borrowed already.
    pub fn pins(&self) -> RefMut<'_, Pins<C>> {
        self.0.borrow_mut()
    }

    /// Returns an SPI device that accesses the chip.
    pub fn spi(&self) -> Spi<C> {
        Spi(self.clone())
    }

    /// Returns a port that drives the chip's pins other than SPI.
    pub fn port(&self) -> Port<C> {
        Port(self.clone())
    }

    /// Runs the chip for `clocks` clock cycles.
    pub fn run(&self, clocks: u32) {
        self.pins().chip.run(clocks);
    }
}

/// The chip's SPI pins, as an SPI device.
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

/// Transfers bytes bit by bit, the highest bit of a byte first.
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

/// Removes and returns the first planned fault if it is planned for `now`, the number of a clock pulse or of a call.
fn due<T: Copy>(faults: &mut VecDeque<(u64, T)>, now: u64) -> Option<T> {
    let &(at, fault) = faults.front()?;
    (at == now).then(|| {
        faults.pop_front();
        fault
    })
}

/// The chip's pins other than SPI, as a port.
#[derive(Debug)]
pub struct Port<C>(Board<C>);

impl<C: Model> Port<C> {
    /// Runs the chip for the clock cycles of a call, then applies `act` to the pins. If the call has a fault, returns
    /// the number of the call as the error.
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

    /// Reads `SCHED_FULL`. Unlike the other calls, this call does not advance the chip's time, because a port can read
    /// this pin together with the other pins.
    fn queue_full(&mut self) -> Result<Option<bool>, u64> {
        let pins = self.0.pins();
        Ok(pins.has_full_pin.then(|| pins.chip.is_full()))
    }
}

/// Runs the chip for the time of a delay, at a clock frequency of 10 MHz.
impl<C: Model> DelayNs for Board<C> {
    fn delay_ns(&mut self, ns: u32) {
        self.run(ns.div_ceil(100));
    }
}
