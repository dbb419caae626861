//! An ICM-42688-P's samples as spikes, by `flight.toml`, out of the serial port of an STM32F405, with stm32f4xx-hal: the timer's
//! interrupt reads and codes, main sends.

#![no_std]
#![no_main]

use core::cell::RefCell;
use cortex_m_rt::entry;
use critical_section::Mutex;
use defmt_rtt as _;
use icm42688p::{Polled, TIMING};
use imu::{Blocking, Channels, Device, Registers, Rounds, Sender, Spin, Station};
use panic_probe as _;
use rand_core::RngCore;
use spikewire::{EventQueue, Overflow, link::Session};
use stm32f4xx_hal::{
    gpio::{Output, PA4, Speed},
    hal::spi,
    interrupt,
    pac::{self, SPI1, TIM2},
    prelude::*,
    rcc::Config,
    serial,
    spi::Spi,
    timer::{CounterUs, Event, Flag},
    watchdog::IndependentWatchdog,
};

include!(concat!(env!("OUT_DIR"), "/flight.rs"));

// The board.
type Sensor = Polled<Device<Blocking<Spi<SPI1>>, PA4<Output>, Spin>>;
const CRYSTAL: u32 = 8;
const SPI: u32 = 10_500_000;
const BAUD: u32 = 921_600;

/// The sensor's axes in the order of the flight's channels, in their units.
const CHANNELS: Channels<{ flight::CHANNELS }> =
    Channels::new(Sensor::COUNTS, flight::NAMES, flight::SI, flight::COUNTS);
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);
static ROUNDS: Rounds = Rounds::new();
/// Samples that main sends together: those of 5 ms.
const GATHER: u32 = 5_000_u32.div_ceil(flight::PERIOD);

type Flown = Station<Sensor, [&'static flight::Code; flight::CHANNELS], { flight::CHANNELS }>;
type Own = (Flown, CounterUs<TIM2>);
/// Setup that main made, until the interrupt takes it.
static READY: Mutex<RefCell<Option<Own>>> = Mutex::new(RefCell::new(None));

#[interrupt]
fn TIM2() {
    static mut OWN: Option<Own> = None;
    if OWN.is_none() {
        *OWN = critical_section::with(|cs| READY.take(cs));
    }
    if let Some((station, timer)) = OWN {
        timer.clear_flags(Flag::Update);
        if let Some(news) = station.tick_blocking(&EVENTS) {
            defmt::info!("{}; {}; {} lost", news, station.counters(), EVENTS.lost());
        }
        ROUNDS.count();
    }
}

#[entry]
fn main() -> ! {
    let p = pac::Peripherals::take().expect("taken once");
    // Before the clocks: a crystal that does not start ends in a reset.
    let mut watchdog = IndependentWatchdog::new(p.IWDG);
    watchdog.stop_on_debug(&p.DBGMCU, true);
    watchdog.start(500.millis());
    defmt::info!("reset by the watchdog: {}", p.RCC.csr().read().wdgrstf().bit());
    p.RCC.csr().modify(|_, flags| flags.rmvf().set_bit());
    let clocks = Config::hse(CRYSTAL.MHz()).sysclk(168.MHz()).require_pll48clk();
    let mut rcc = p.RCC.freeze(clocks);
    let (a, c) = (p.GPIOA.split(&mut rcc), p.GPIOC.split(&mut rcc));

    // MISO is pulled up: a line that nobody drives reads as ones.
    let (clock, out) = (a.pa5.into_alternate().speed(Speed::VeryHigh), a.pa7.into_alternate());
    let back = a.pa6.into_alternate().internal_pull_up(true);
    let pins = (Some(clock), Some(back), Some(out.speed(Speed::VeryHigh)));
    let bus = Spi::new(p.SPI1, pins, spi::MODE_0, SPI.Hz(), &mut rcc);
    let spin = Spin::new(168_000_000);
    let select = a.pa4.into_push_pull_output_in_state(true.into());
    let Ok(device) = Device::new(Blocking(bus), select, spin, const { TIMING.at(SPI) });
    let sensor = Polled::new(device, flight::PERIOD);

    let settings = serial::Config::default().baudrate(BAUD.bps());
    let port = p.USART6.tx(c.pc6, settings, &mut rcc);
    let mut port = port.expect("the rate is one that the clock gives");
    // Another session at each start.
    let session = Session::random(p.RNG.constrain(&mut rcc).next_u64());
    let mut sender = Sender::of(flight::transmitter(session));

    let mut timer = p.TIM2.counter_us(&mut rcc);
    timer.start(flight::PERIOD.micros()).expect("a period of µs");
    timer.listen(Event::Update);
    let (bank, every) = (flight::BANK, flight::KEYFRAME_EVERY);
    let station = Station::new(sensor, CHANNELS, bank, flight::PERIOD, every);
    critical_section::with(|cs| READY.replace(cs, Some((station, timer))));
    // SAFETY: main is in no critical section.
    unsafe { cortex_m::peripheral::NVIC::unmask(pac::Interrupt::TIM2) };

    let mut events = EVENTS.consumer().expect("taken once");
    let mut seen = 0;
    loop {
        cortex_m::asm::wfi();
        if ROUNDS.passed(GATHER, &mut seen) {
            sender.observe(ROUNDS.time(flight::PERIOD));
            while let Some(frame) = sender.next_frame(&mut events) {
                // A UART without flow control takes every byte.
                _ = port.bwrite_all(frame);
            }
            watchdog.feed();
        }
    }
}
