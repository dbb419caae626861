//! Chip select, guard times and pauses, in their order.

use std::{cell::RefCell, rc::Rc};

use embedded_hal::spi::Operation;
use embedded_hal::{delay, digital, spi};
use embedded_hal_async::spi::{SpiBus, SpiDevice};
use flight::{Device, Timing};

use crate::finish;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Did {
    Select(bool),
    Wait(u32),
    Read(usize),
    Write(usize),
    Flush,
}
use Did::{Flush, Read, Select, Wait, Write};

/// Bus, pin and clock in one, that write down what they do; the bus or the pin fails at one index.
#[derive(Clone, Default)]
struct Bench {
    did: Rc<RefCell<Vec<Did>>>,
    fails_at: Option<usize>,
}

#[derive(Debug, PartialEq)]
struct Broken;

impl spi::Error for Broken {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl Bench {
    fn does(&self, did: Did) -> Result<(), Broken> {
        let index = self.did.borrow().len();
        self.did.borrow_mut().push(did);
        if self.fails_at == Some(index) { Err(Broken) } else { Ok(()) }
    }
}

impl spi::ErrorType for Bench {
    type Error = Broken;
}

impl SpiBus for Bench {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<(), Broken> {
        self.does(Read(bytes.len()))
    }
    async fn write(&mut self, bytes: &[u8]) -> Result<(), Broken> {
        self.does(Write(bytes.len()))
    }
    async fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Broken> {
        unreachable!()
    }
    async fn transfer_in_place(&mut self, _: &mut [u8]) -> Result<(), Broken> {
        unreachable!()
    }
    async fn flush(&mut self) -> Result<(), Broken> {
        self.does(Flush)
    }
}

impl digital::ErrorType for Bench {
    type Error = Broken;
}

impl digital::OutputPin for Bench {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.does(Select(false))
    }
    fn set_high(&mut self) -> Result<(), Broken> {
        self.does(Select(true))
    }
}

impl delay::DelayNs for Bench {
    fn delay_ns(&mut self, time: u32) {
        let _ = self.does(Wait(time));
    }
}

/// A read of a register, with the bench's fault at an index. Chip select rises first, when the device is made.
fn transaction(fails_at: Option<usize>) -> (bool, Vec<Did>) {
    let bench = Bench { did: Rc::default(), fails_at: None };
    let faulty = Bench { fails_at, ..bench.clone() };
    let timing = Timing { guard: 100, pause: 2_000 };
    let mut device = Device::new(faulty.clone(), faulty, bench.clone(), timing).unwrap();
    let mut bytes = [0; 3];
    let done =
        finish(device.transaction(&mut [Operation::Write(&[0x80]), Operation::Read(&mut bytes)]));
    drop(device);
    let did = bench.did.borrow().clone();
    (done.is_ok(), did)
}

#[test]
fn guard_times_are_within_chip_select_and_the_pause_behind_it() {
    let (is_good, did) = transaction(None);
    assert!(is_good);
    let wanted =
        [Select(false), Wait(100), Write(1), Read(3), Flush, Wait(100), Select(true), Wait(2_000)];
    assert_eq!(did[1..9], wanted);
}

#[test]
fn a_guard_time_shorter_than_half_a_clock_does_not_build() {
    let timing = Timing { guard: 100, pause: 0 };
    for (clock, is_good) in [(10_000_000, true), (5_000_000, true), (4_999_999, false)] {
        assert_eq!(std::panic::catch_unwind(|| timing.at(clock)).is_ok(), is_good, "{clock} Hz");
    }
}

/// At every index: the error is told, chip select ends high, and the pause is kept where the bus was used.
#[test]
fn chip_select_rises_whatever_fails() {
    for index in [1, 3, 4, 5, 7] {
        let (is_good, did) = transaction(Some(index));
        assert!(!is_good, "{index}");
        let raised = did.iter().rposition(|did| *did == Select(true));
        let used = did.iter().rposition(|did| matches!(did, Read(_) | Write(_) | Flush));
        assert!(raised > used, "{index}: {did:?}");
        assert!(index == 1 || did.contains(&Wait(2_000)), "{index}: {did:?}");
    }
}

#[test]
fn chip_select_rises_when_the_future_is_dropped() {
    use std::{pin::pin, task::Context, task::Waker};

    /// A bus whose transfer never ends.
    struct Hanging;
    impl spi::ErrorType for Hanging {
        type Error = Broken;
    }
    impl SpiBus for Hanging {
        async fn read(&mut self, _: &mut [u8]) -> Result<(), Broken> {
            std::future::pending().await
        }
        async fn write(&mut self, _: &[u8]) -> Result<(), Broken> {
            std::future::pending().await
        }
        async fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Broken> {
            std::future::pending().await
        }
        async fn transfer_in_place(&mut self, _: &mut [u8]) -> Result<(), Broken> {
            std::future::pending().await
        }
        async fn flush(&mut self) -> Result<(), Broken> {
            Ok(())
        }
    }
    let bench = Bench::default();
    let mut device = Device::new(Hanging, bench.clone(), bench.clone(), Timing::default()).unwrap();
    {
        let mut operations = [Operation::Write(&[1])];
        let mut future = pin!(device.transaction(&mut operations));
        assert!(future.as_mut().poll(&mut Context::from_waker(Waker::noop())).is_pending());
        assert_eq!(bench.did.borrow().last(), Some(&Wait(0)));
    }
    assert_eq!(bench.did.borrow().last(), Some(&Select(true)));
}
