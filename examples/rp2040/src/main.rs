//! From the IMU's interrupt to link frames out of the UART, on an RP2040.
//!
//! ```text
//! BMI323 --INT1--> IO_IRQ_BANK0: SPI0, bank of encoders --> queue --> main: frames --> UART0
//! ```
//!
//! A Cortex-M0+ has no floating-point unit: the encoders work in fixed point, in the sensor's units and without
//! rounding. Wiring and clocks: `examples/README.md`.

#![no_std]
#![no_main]

mod board;
mod imu;

use core::cell::RefCell;

use bmi323_driver::Bmi323;
use critical_section::Mutex;
use defmt_rtt as _;
use flight::{Counters, Sampler, bmi323, code::Schemes};
use panic_probe as _;
use rp2040_hal::{gpio::Interrupt::EdgeHigh, pac, pac::interrupt};
use spikewire::{
    Bank, EventQueue, Overflow, Tick,
    link::{Coding, Transmitter},
    out::SerialSink,
};

const CHANNELS: usize = imu::SCHEMES.len();
/// How often the counters are logged, in µs.
const REPORT: i32 = 1_000_000;
/// How long to wait, in µs, before a sensor that did not start is tried again.
const AGAIN: i32 = 100_000;

/// What the interrupt has for main.
static EVENTS: EventQueue<256> = EventQueue::new(Overflow::DropOldest);
/// What the interrupt works with, while the sensor is not being started.
static SENSOR: Mutex<RefCell<Option<Sensor>>> = Mutex::new(RefCell::new(None));

struct Sensor {
    data_ready: board::DataReady,
    imu: imu::Imu,
    clock: rp2040_hal::Timer,
    sampler: Sampler<Schemes<imu::Value>, CHANNELS>,
}

impl Sensor {
    fn now(&self) -> Tick {
        Tick::from(self.clock.get_counter_low())
    }

    /// Takes one sample: 24 µs on the bus, then six encoders.
    fn sample(&mut self) {
        let edge = self.now();
        self.data_ready.clear_interrupt(EdgeHigh);
        self.sampler.take(edge, imu::read(&mut self.imu), &EVENTS);
    }

    /// Starts the sensor, which takes some ms.
    fn start(&mut self) -> bool {
        let mut clock = self.clock;
        let started = bmi323::start(&mut self.imu, &mut clock);
        match &started {
            Ok(()) => self.sampler.started(self.now()),
            Err(error) => {
                defmt::error!("it does not start: {}", defmt::Debug2Format(error));
                self.sampler.failed_to_start(self.now(), &EVENTS);
            }
        }
        started.is_ok()
    }
}

#[interrupt]
fn IO_IRQ_BANK0() {
    critical_section::with(|cs| {
        if let Some(sensor) = SENSOR.borrow(cs).borrow_mut().as_mut() {
            sensor.sample();
        }
    });
}

/// Wakes main, which looks after everything.
#[cortex_m_rt::exception]
fn SysTick() {}

/// Whether the sensor lives; starts it where it has to be.
fn look_after(next: &mut Tick, now: Tick) {
    let why = critical_section::with(|cs| {
        SENSOR.borrow_ref_mut(cs).as_mut().and_then(|sensor| sensor.sampler.look(now, &EVENTS))
    });
    let Some(why) = why.filter(|_| now.since(*next) >= 0) else { return };
    defmt::warn!("the sensor is to be started: {}", why);
    // Out of the interrupt's reach: a start is too long to hold interrupts off.
    pac::NVIC::mask(pac::Interrupt::IO_IRQ_BANK0);
    if let Some(mut sensor) = critical_section::with(|cs| SENSOR.take(cs)) {
        if !sensor.start() {
            *next = now.shifted(AGAIN);
        }
        critical_section::with(|cs| SENSOR.replace(cs, Some(sensor)));
    }
    // SAFETY: main is in no critical section that this could break.
    unsafe { pac::NVIC::unmask(pac::Interrupt::IO_IRQ_BANK0) };
}

#[rp2040_hal::entry]
fn main() -> ! {
    let board::Board { imu, data_ready, uart, clock, watchdog, is_bitten, session } =
        board::start();
    defmt::info!("reset by the watchdog: {}", is_bitten);

    data_ready.set_interrupt_enabled(EdgeHigh, true);
    let imu = Bmi323::new_spi(imu);
    let sampler = Sampler::new(Bank::per_channel(imu::SCHEMES), imu::PLAN);
    let sensor = Sensor { data_ready, imu, clock, sampler };
    critical_section::with(|cs| SENSOR.replace(cs, Some(sensor)));

    // The sensor's clock is not ours: its samples come a few µs early or late.
    let coding = Coding::for_channels(CHANNELS as u16, imu::PLAN.period).with_jitter_bits(4);
    let mut link = SerialSink::<_, _, 128>::new(uart, Transmitter::new(coding, session));
    let mut events = EVENTS.consumer().expect("taken once");
    let now = || Tick::from(clock.get_counter_low());
    let (mut bytes, mut before) = (0_u32, Counters::default());
    let (mut next_report, mut next_start) = (now(), now());
    loop {
        watchdog.feed();
        look_after(&mut next_start, now());
        match link.send(&mut events) {
            Ok(0) => cortex_m::asm::wfi(), // a millisecond at most
            Ok(count) => bytes = bytes.wrapping_add(count as u32),
            Err(_) => defmt::warn!("the UART failed; the frame is kept"),
        }

        if now().since(next_report) >= 0 {
            next_report = next_report.shifted(REPORT);
            let counters = critical_section::with(|cs| {
                SENSOR.borrow_ref(cs).as_ref().map(|sensor| sensor.sampler.counters())
            });
            let counters = counters.unwrap_or_default();
            defmt::info!(
                "{}; {} bytes sent; {} items lost, peak {}",
                counters.since(&before),
                bytes,
                EVENTS.lost(),
                EVENTS.peak(),
            );
            before = counters;
        }
    }
}
