//! An ICM-42688-P's samples as spikes, by `flight.toml`, out of the serial port of an nRF52840, with embassy-nrf.

#![no_std]
#![no_main]

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_nrf::{
    bind_interrupts,
    config::{Config, HfclkSource, LfclkSource},
    gpio::{Level, Output, OutputDrive},
    pac,
    peripherals::{SPI2, UARTE0, WDT},
    rng::Rng,
    spim::{self, Frequency, Spim},
    uarte::{self, Baudrate, UarteTx},
    wdt::{self, HaltConfig, Watchdog},
};
use embassy_time::{Duration, Instant, Ticker, Timer, with_timeout};
use icm42688p::{Polled, TIMING};
use imu::{Channels, Device, Registers, Rounds, Sender, Spin, Station};
use panic_probe as _;
use spikewire::{EventQueue, Overflow, link::Session};

include!(concat!(env!("OUT_DIR"), "/flight.rs"));

// The board.
type Sensor = Polled<Device<Spim<'static>, Output<'static>, Spin>>;
/// Exact. What the part calls 921 600 is 941 176.
const BAUD: Baudrate = Baudrate::Baud1m;

bind_interrupts!(struct Interrupts {
    SPI2 => spim::InterruptHandler<SPI2>;
    UARTE0 => uarte::InterruptHandler<UARTE0>;
});

/// The sensor's axes in the order of the flight's channels, in their units.
const CHANNELS: Channels<{ flight::CHANNELS }> =
    Channels::new(Sensor::COUNTS, flight::NAMES, flight::SI, flight::COUNTS);
static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropOldest);
static ROUNDS: Rounds = Rounds::new();

#[embassy_executor::task]
async fn sample(sensor: Sensor) {
    let (bank, every) = (flight::BANK, flight::KEYFRAME_EVERY);
    let mut station = Station::new(sensor, CHANNELS, bank, flight::PERIOD, every);
    // Not a `Ticker`: the clock has 32768 ticks a second, and a period in whole ticks would be up to 30 µs too long.
    let mut next = Instant::now().as_micros();
    loop {
        next += u64::from(flight::PERIOD);
        Timer::at(Instant::from_micros(next)).await;
        if let Some(news) = station.tick(&EVENTS).await {
            defmt::info!("{}; {}; {} lost", news, station.counters(), EVENTS.lost());
        }
        ROUNDS.count();
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // Before the clocks: a crystal that does not start ends in a reset. It stands still while a debugger halts the core.
    let mut config = wdt::Config::default();
    config.timeout_ticks = 32_768 / 2;
    config.action_during_debug_halt = HaltConfig::Pause;
    // SAFETY: nobody else takes the watchdog. If it runs since before a reset, the same settings are ours.
    let watchdog = Watchdog::try_new(unsafe { WDT::steal() }, config);
    let Ok((_, [mut watchdog])) = watchdog else { panic!("the watchdog has other settings") };

    let mut config = Config::default();
    config.hfclk_source = HfclkSource::ExternalXtal;
    config.lfclk_source = LfclkSource::ExternalXtal;
    let p = embassy_nrf::init(config);
    let reasons = pac::POWER.resetreas().read();
    pac::POWER.resetreas().write_value(reasons); // ones clear
    defmt::info!("reset by the watchdog: {}", reasons.dog());

    let mut at = spim::Config::default(); // mode 0
    at.frequency = Frequency::M8;
    let bus = Spim::new(p.SPI2, Interrupts, p.P1_15, p.P1_14, p.P1_13, at);
    // MISO is pulled up: a line that nobody drives reads as ones.
    pac::P1.pin_cnf(14).modify(|pin| pin.set_pull(pac::gpio::vals::Pull::Pullup));
    let select = Output::new(p.P1_12, Level::High, OutputDrive::Standard);
    let spin = Spin::new(64_000_000);
    let Ok(device) = Device::new(bus, select, spin, const { TIMING.at(8_000_000) });
    spawner.spawn(sample(Polled::new(device, flight::PERIOD)).expect("spawned once"));

    let mut at = uarte::Config::default();
    at.baudrate = BAUD;
    let mut port = UarteTx::new(p.UARTE0, Interrupts, p.P0_06, at);
    // Another session at each start.
    let session = Session::random(Rng::new_blocking(p.RNG).blocking_next_u64());
    let mut sender = Sender::of(flight::transmitter(session));
    let mut events = EVENTS.consumer().expect("taken once");
    let (mut gather, mut seen) = (Ticker::every(Duration::from_millis(5)), 0);
    loop {
        gather.next().await;
        sender.observe(ROUNDS.time(flight::PERIOD));
        // A frame that is not through by then is a gap to the far end.
        _ = with_timeout(Duration::from_millis(20), sender.send(&mut events, &mut port)).await;
        if ROUNDS.went_on(&mut seen) {
            watchdog.pet();
        }
    }
}
