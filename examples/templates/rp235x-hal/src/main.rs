//! An ICM-42688-P's samples as spikes, by `flight.toml`, out of the serial port of an RP2350, with rp235x-hal: an alarm's
//! interrupt reads and codes, main sends.

#![no_std]
#![no_main]

use core::cell::RefCell;
use critical_section::Mutex;
use defmt_rtt as _;
use icm42688p::{Polled, TIMING};
use imu::{Blocking, Channels, Device, Registers, Rounds, Sender, Spin, Station};
use panic_probe as _;
use rp235x_hal::{
    self as hal, Clock, Spi, Watchdog,
    clocks::init_clocks_and_plls,
    fugit::{ExtU32, MicrosDurationU64, RateExtU32},
    gpio::{
        FunctionSio, FunctionSpi, FunctionUart, Pin, PinState, Pins, PullDown, PullNone, PullUp,
        SioOutput, bank0,
    },
    pac::{self, interrupt},
    rosc::RingOscillator,
    spi::Enabled,
    timer::{Alarm as _, Alarm0, CopyableTimer0, Instant},
    uart::{DataBits, StopBits, UartConfig, UartPeripheral},
};
use spikewire::{EventQueue, Overflow, link::Session};

include!(concat!(env!("OUT_DIR"), "/flight.rs"));

#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: hal::block::ImageDef = hal::block::ImageDef::secure_exe();

// The board.
type Out = Pin<bank0::Gpio19, FunctionSpi, PullNone>;
type Back = Pin<bank0::Gpio16, FunctionSpi, PullUp>; // a line that nobody drives reads as ones
type Sclk = Pin<bank0::Gpio18, FunctionSpi, PullNone>;
type Select = Pin<bank0::Gpio17, FunctionSio<SioOutput>, PullDown>;
type Tx = Pin<bank0::Gpio0, FunctionUart, PullNone>;
type Rx = Pin<bank0::Gpio1, FunctionUart, PullUp>;
type Bus = Spi<Enabled, pac::SPI0, (Out, Back, Sclk)>;
type Sensor = Polled<Device<Blocking<Bus>, Select, Spin>>;
const CRYSTAL: u32 = 12_000_000;
const SPI: u32 = 12_500_000;
const BAUD: u32 = 921_600;
const PERIOD: MicrosDurationU64 = MicrosDurationU64::from_ticks(flight::PERIOD as u64);

/// The sensor's axes in the order of the flight's channels, in their units.
const CHANNELS: Channels<{ flight::CHANNELS }> =
    Channels::new(Sensor::COUNTS, flight::NAMES, flight::SI, flight::COUNTS);
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);
static ROUNDS: Rounds = Rounds::new();
/// Samples that main sends together: those of 5 ms.
const GATHER: u32 = 5_000_u32.div_ceil(flight::PERIOD);

type Flown = Station<Sensor, [&'static flight::Code; flight::CHANNELS], { flight::CHANNELS }>;
type Alarm = Alarm0<CopyableTimer0>;
type Own = (Flown, Alarm, Instant);
/// Setup that main made, until the interrupt takes it.
static READY: Mutex<RefCell<Option<Own>>> = Mutex::new(RefCell::new(None));

#[interrupt]
fn TIMER0_IRQ_0() {
    static mut OWN: Option<Own> = None;
    if OWN.is_none() {
        *OWN = critical_section::with(|cs| READY.take(cs));
    }
    if let Some((station, alarm, next)) = OWN {
        alarm.clear_interrupt();
        *next += PERIOD;
        _ = alarm.schedule_at(*next); // one that has passed comes at once
        if let Some(news) = station.tick_blocking(&EVENTS) {
            defmt::info!("{}; {}; {} lost", news, station.counters(), EVENTS.lost());
        }
        ROUNDS.count();
    }
}

#[hal::entry]
fn main() -> ! {
    let mut p = pac::Peripherals::take().expect("taken once");
    // Before the clocks: a crystal that does not start ends in a reset. It stands still while a debugger halts the core.
    let by_watchdog = p.WATCHDOG.reason().read().timer().bit();
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    watchdog.enable_tick_generation(12); // of the ring oscillator, until the crystal runs
    watchdog.pause_on_debug(true);
    watchdog.start(500.millis());
    let (xosc, pll_sys, pll_usb) = (p.XOSC, p.PLL_SYS, p.PLL_USB);
    let clocks = init_clocks_and_plls(
        CRYSTAL,
        xosc,
        p.CLOCKS,
        pll_sys,
        pll_usb,
        &mut p.RESETS,
        &mut watchdog,
    );
    let Ok(clocks) = clocks else { panic!("the clocks do not start") };
    defmt::info!("reset by the watchdog: {}", by_watchdog);

    let pins = Pins::new(p.IO_BANK0, p.PADS_BANK0, hal::Sio::new(p.SIO).gpio_bank0, &mut p.RESETS);
    let wires = (pins.gpio19.reconfigure(), pins.gpio16.reconfigure(), pins.gpio18.reconfigure());
    let clock = clocks.peripheral_clock.freq();
    let bus = Spi::<_, _, _, 8>::new(p.SPI0, wires);
    let bus = bus.init(&mut p.RESETS, clock, SPI.Hz(), embedded_hal::spi::MODE_0);
    let spin = Spin::new(clocks.system_clock.freq().to_Hz());
    let select = pins.gpio17.into_push_pull_output_in_state(PinState::High);
    let Ok(device) = Device::new(Blocking(bus), select, spin, const { TIMING.at(SPI) });
    let sensor = Polled::new(device, flight::PERIOD);

    let lines: (Tx, Rx) = (pins.gpio0.reconfigure(), pins.gpio1.reconfigure());
    let settings = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
    let port = UartPeripheral::new(p.UART0, lines, &mut p.RESETS).enable(settings, clock);
    let Ok(port) = port else { panic!("no such baud rate") };
    // Another session at each start.
    let noise = RingOscillator::new(p.ROSC).initialize();
    let session = (0..64).fold(0, |bits, _| bits << 1 | u64::from(noise.get_random_bit()));
    let mut sender = Sender::of(flight::transmitter(Session::random(session)));

    let mut timer = hal::Timer::new_timer0(p.TIMER0, &mut p.RESETS, &clocks);
    let mut alarm = timer.alarm_0().expect("taken once");
    let next = timer.get_counter() + PERIOD;
    alarm.schedule_at(next).expect("a period ahead");
    alarm.enable_interrupt();
    let (bank, every) = (flight::BANK, flight::KEYFRAME_EVERY);
    let station = Station::new(sensor, CHANNELS, bank, flight::PERIOD, every);
    critical_section::with(|cs| READY.replace(cs, Some((station, alarm, next))));
    // SAFETY: main is in no critical section.
    unsafe { cortex_m::peripheral::NVIC::unmask(pac::Interrupt::TIMER0_IRQ_0) };

    let mut events = EVENTS.consumer().expect("taken once");
    let mut seen = 0;
    loop {
        cortex_m::asm::wfi();
        if ROUNDS.passed(GATHER, &mut seen) {
            sender.observe(ROUNDS.time(flight::PERIOD));
            while let Some(frame) = sender.next_frame(&mut events) {
                port.write_full_blocking(frame);
            }
            watchdog.feed();
        }
    }
}
