//! A sensor with its registers and its FIFO, a bus that takes time, and a clock that waits for nobody.

use std::{
    cell::RefCell,
    convert::Infallible,
    future::poll_fn,
    pin::pin,
    rc::Rc,
    task::{Context, Poll, Waker},
};

use embedded_hal::{digital, spi};
use embedded_hal_async::{
    delay::DelayNs,
    digital::Wait,
    spi::{Operation, SpiDevice},
};

pub const PACKET: usize = 16;
const ROOM: usize = 2048;
/// A byte on the bus, at 10 MHz.
const BYTE_NS: u64 = 800;

/// What happens to the sensor at a time, in ms.
#[derive(Clone, Copy, PartialEq)]
pub enum Fate {
    /// It loses its supply, and its line floats to this byte.
    Dies(u8),
    /// It samples on and raises its interrupt line, but MISO is stuck at this byte.
    Stuck(u8),
    /// It has its supply again, with its registers as after a reset.
    Revives,
    /// It samples on, but its interrupt line is broken, or whole.
    Line(bool),
    /// Nothing else runs for so many ms.
    Stall(u64),
}

pub struct World {
    /// In ns.
    now: u64,
    wakes: Vec<u64>,
    pub fates: Vec<(u64, Fate)>,
    pub is_alive: bool,
    floats_to: u8,
    stuck_at: Option<u8>,
    has_line: bool,
    registers: [u8; 128],
    fifo: Vec<u8>,
    is_full: bool,
    /// When the next sample comes, in ns.
    next_sample: u64,
    /// From one sample to the next, in ns.
    pub period: u64,
    /// Samples since the first start: each tells its number.
    pub sampled: u32,
    /// Transfers so far, and those that fail.
    pub transfers: usize,
    pub failing: Vec<usize>,
}

#[derive(Clone)]
pub struct Handle(pub Rc<RefCell<World>>);

thread_local! {
    static NOW: RefCell<u64> = const { RefCell::new(0) };
}

/// The time in µs, as a board's clock.
pub fn micros() -> u64 {
    NOW.with_borrow(|now| now / 1000)
}

impl Handle {
    pub fn new() -> Self {
        NOW.set(0);
        Self(Rc::new(RefCell::new(World {
            now: 0,
            wakes: Vec::new(),
            fates: Vec::new(),
            is_alive: true,
            floats_to: 0,
            stuck_at: None,
            has_line: true,
            registers: reset(),
            fifo: Vec::new(),
            is_full: false,
            next_sample: 0,
            period: 125_000,
            sampled: 0,
            transfers: 0,
            failing: Vec::new(),
        })))
    }

    /// Runs the task until this time in ms; `each` runs whenever time goes on.
    pub fn run(&self, task: impl Future, until: u64, mut each: impl FnMut(u64)) {
        let mut task = pin!(task);
        let mut context = Context::from_waker(Waker::noop());
        while task.as_mut().poll(&mut context).is_pending() {
            let wake = self.0.borrow_mut().wakes.drain(..).min();
            match wake {
                Some(wake) if wake <= until * 1_000_000 => self.0.borrow_mut().advance(wake),
                _ => return,
            }
            each(micros());
        }
    }

    async fn until(&self, mut time: impl FnMut(&World) -> Option<u64>) {
        poll_fn(|_| {
            let mut world = self.0.borrow_mut();
            match time(&world) {
                Some(time) if time <= world.now => return Poll::Ready(()),
                Some(time) => world.wakes.push(time),
                None => {}
            }
            // A fate may change it.
            let fate = world.fates.first().map(|(at, _)| at * 1_000_000);
            world.wakes.extend(fate);
            Poll::Pending
        })
        .await;
    }
}

fn reset() -> [u8; 128] {
    let mut registers = [0; 128];
    registers[0x4D] = 0x91;
    registers[0x64] = 0x10;
    registers[0x75] = 0x47;
    registers
}

impl World {
    fn advance(&mut self, mut to: u64) {
        while let Some(&(at, fate)) = self.fates.first().filter(|(at, _)| at * 1_000_000 <= to) {
            self.sample_until(at * 1_000_000);
            self.fates.remove(0);
            match fate {
                Fate::Dies(floats_to) => (self.is_alive, self.floats_to) = (false, floats_to),
                Fate::Stuck(byte) => self.stuck_at = Some(byte),
                Fate::Revives => self.power_on(),
                Fate::Line(is_whole) => self.has_line = is_whole,
                Fate::Stall(time) => to += time * 1_000_000,
            }
        }
        self.sample_until(to);
        self.now = to;
        NOW.set(to);
    }

    fn power_on(&mut self) {
        (self.is_alive, self.registers) = (true, reset());
        self.fifo.clear();
    }

    fn is_sampling(&self) -> bool {
        self.is_alive && self.registers[0x4E] == 0x0F && self.registers[0x16] == 0x40
    }

    fn sample_until(&mut self, time: u64) {
        while self.next_sample <= time {
            self.next_sample += self.period;
            if !self.is_sampling() {
                continue;
            }
            self.sampled += 1;
            let n = self.sampled;
            let noise = (n.wrapping_mul(0x9E37_79B1) >> 24) as i16;
            let channels = [noise, 2048, -noise, (n % 2000) as i16 * 8, -5 * noise, 100];
            self.fifo.push(0x68);
            self.fifo.extend(channels.into_iter().flat_map(i16::to_be_bytes));
            self.fifo.extend([20, 0, 0]);
            if self.fifo.len() > ROOM {
                self.is_full = true;
                self.fifo.drain(..PACKET);
            }
        }
    }

    /// When INT1 rises next, from this moment on.
    fn next_edge(&self) -> Option<u64> {
        if !self.is_sampling() || !self.has_line || self.registers[0x65] != 0x04 {
            return None;
        }
        let missing = usize::from(self.registers[0x60]).saturating_sub(self.fifo.len()) / PACKET;
        Some(self.next_sample + self.period * missing.saturating_sub(1) as u64)
    }

    fn transfer(&mut self, bytes: &mut [u8]) {
        if !self.is_alive {
            return bytes.fill(self.floats_to);
        }
        self.answer(bytes);
        if let Some(byte) = self.stuck_at {
            bytes.fill(byte);
        }
    }

    fn answer(&mut self, bytes: &mut [u8]) {
        let address = bytes[0] & 0x7F;
        if bytes[0] & 0x80 == 0 {
            assert_eq!(bytes.len(), 2, "a write of one register");
            match (address, bytes[1]) {
                (0x11, 1) => self.power_on(),
                // The status stays until somebody looks.
                (0x4B, 2) => self.fifo.clear(),
                (address, value) => self.registers[usize::from(address)] = value,
            }
        } else if address == 0x2D {
            bytes[1] = 0x04 | u8::from(std::mem::take(&mut self.is_full)) << 1;
            if bytes.len() == 2 {
                return;
            }
            bytes[2..4].copy_from_slice(&(self.fifo.len() as u16).to_be_bytes());
            let read = self.fifo.len().min(bytes.len() - 4);
            bytes[4..].fill(0xFF);
            bytes[4..4 + read].copy_from_slice(&self.fifo[..read]);
            self.fifo.drain(..read);
        } else {
            bytes[1] = self.registers[usize::from(address)];
        }
    }
}

pub struct Bus(pub Handle);

impl spi::ErrorType for Bus {
    type Error = spi::ErrorKind;
}

impl SpiDevice for Bus {
    async fn transaction(
        &mut self,
        operations: &mut [Operation<'_, u8>],
    ) -> Result<(), Self::Error> {
        let [Operation::TransferInPlace(bytes)] = operations else { panic!("another operation") };
        let end = self.0.0.borrow().now + BYTE_NS * bytes.len() as u64;
        self.0.until(|_| Some(end)).await;
        let mut world = self.0.0.borrow_mut();
        world.transfers += 1;
        if world.failing.contains(&world.transfers) {
            return Err(spi::ErrorKind::Other);
        }
        world.transfer(bytes);
        Ok(())
    }
}

pub struct Line(pub Handle);

impl digital::ErrorType for Line {
    type Error = Infallible;
}

impl Wait for Line {
    /// An edge that comes while nobody waits is lost, as on most boards.
    async fn wait_for_rising_edge(&mut self) -> Result<(), Infallible> {
        let mut edge = None;
        self.0
            .until(|world| {
                let next = world.next_edge();
                // One that was seen coming and is here now.
                if edge.is_some_and(|edge| edge <= world.now) && world.has_line {
                    return edge;
                }
                edge = next;
                next
            })
            .await;
        Ok(())
    }

    async fn wait_for_high(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn wait_for_low(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }
}

#[derive(Clone)]
pub struct Pause(pub Handle);

impl DelayNs for Pause {
    async fn delay_ns(&mut self, ns: u32) {
        let end = self.0.0.borrow().now + u64::from(ns);
        self.0.until(|_| Some(end)).await;
    }
}
