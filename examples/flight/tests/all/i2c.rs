//! Freeing an I2C bus.

use std::{cell::RefCell, convert::Infallible, rc::Rc};

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use embedded_hal_mock::eh1::delay::NoopDelay;
use flight::free_bus;

/// Two open-drain lines, and a sensor that holds SDA until it has seen so many clocks.
#[derive(Debug)]
struct Wires {
    scl: bool,
    sda: bool,
    held_for: u32,
    stops: u32,
}

#[derive(Clone)]
struct Scl(Rc<RefCell<Wires>>);
#[derive(Clone)]
struct Sda(Rc<RefCell<Wires>>);

impl ErrorType for Scl {
    type Error = Infallible;
}
impl ErrorType for Sda {
    type Error = Infallible;
}

impl OutputPin for Scl {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let mut wires = self.0.borrow_mut();
        if std::mem::replace(&mut wires.scl, false) {
            wires.held_for = wires.held_for.saturating_sub(1);
        }
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().scl = true;
        Ok(())
    }
}

impl OutputPin for Sda {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().sda = false;
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        let mut wires = self.0.borrow_mut();
        let rises = !std::mem::replace(&mut wires.sda, true) && wires.held_for == 0;
        wires.stops += u32::from(rises && wires.scl);
        Ok(())
    }
}

impl InputPin for Sda {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        let wires = self.0.borrow();
        Ok(wires.sda && wires.held_for == 0)
    }
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|is_high| !is_high)
    }
}

#[test]
fn a_sensor_in_the_midst_of_a_byte_lets_go() {
    for held_for in 0..=20 {
        let wires = Wires { scl: true, sda: true, held_for, stops: 0 };
        let wires = Rc::new(RefCell::new(wires));
        let is_free = free_bus(&mut Scl(wires.clone()), &mut Sda(wires.clone()), &mut NoopDelay);
        // Nine clocks, and that of the stop.
        assert_eq!(is_free, held_for <= 10, "{held_for}");
        assert_eq!(wires.borrow().stops, u32::from(is_free), "{held_for}");
        assert!(wires.borrow().scl && wires.borrow().sda, "both lines are let go: {wires:?}");
    }
}
