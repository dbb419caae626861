//! An ICM-42688-P's samples as spikes, by `flight.toml`, out of the serial port of an RP2040, with embassy-rp.

#![no_std]
#![no_main]

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_rp::{
    bind_interrupts,
    clocks::RoscRng,
    config::Config,
    dma,
    gpio::{Level, Output},
    pac,
    peripherals::{DMA_CH0, DMA_CH1, SPI0, UART0, WATCHDOG},
    spi::{self, Async, Spi},
    uart::{self, BufferedInterruptHandler, BufferedUartTx},
    watchdog::{ResetReason, Watchdog},
};
use embassy_time::{Duration, Ticker, with_timeout};
use icm42688p::{Polled, TIMING};
use imu::{Channels, Device, Registers, Rounds, Sender, Spin, Station};
use panic_probe as _;
use spikewire::{EventQueue, Overflow, link::Session};
use static_cell::StaticCell;

include!(concat!(env!("OUT_DIR"), "/flight.rs"));

// The board.
type Sensor = Polled<Device<Spi<'static, SPI0, Async>, Output<'static>, Spin>>;
const SPI: u32 = 12_500_000;
const BAUD: u32 = 921_600;
const WATCHDOG_LIMIT: Duration = Duration::from_millis(500);

bind_interrupts!(struct Interrupts {
    DMA_IRQ_0 => dma::InterruptHandler<DMA_CH0>, dma::InterruptHandler<DMA_CH1>;
    UART0_IRQ => BufferedInterruptHandler<UART0>;
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
    let mut period = Ticker::every(Duration::from_micros(flight::PERIOD.into()));
    loop {
        period.next().await;
        if let Some(news) = station.tick(&EVENTS).await {
            defmt::info!("{}; {}; {} lost", news, station.counters(), EVENTS.lost());
        }
        ROUNDS.count();
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // Before the clocks: a crystal that does not start ends in a reset. It stands still while a debugger halts the core.
    // SAFETY: nobody else takes the watchdog.
    let mut watchdog = Watchdog::new(unsafe { WATCHDOG::steal() });
    watchdog.enable_tick_generation(12); // of the ring oscillator, until the crystal runs
    watchdog.pause_on_debug(true);
    watchdog.start(WATCHDOG_LIMIT);
    let by_watchdog = matches!(watchdog.reset_reason(), Some(ResetReason::TimedOut));
    let p = embassy_rp::init(Config::default()); // a crystal of 12 MHz
    defmt::info!("reset by the watchdog: {}", by_watchdog);

    let mut at = spi::Config::default(); // mode 0
    at.frequency = SPI;
    let (clock, out, back) = (p.PIN_18, p.PIN_19, p.PIN_16);
    let bus = Spi::new(p.SPI0, clock, out, back, p.DMA_CH0, p.DMA_CH1, Interrupts, at);
    // MISO is pulled up: a line that nobody drives reads as ones.
    pac::PADS_BANK0.gpio(16).modify(|pad| pad.set_pue(true));
    let select = Output::new(p.PIN_17, Level::High);
    let spin = Spin::new(125_000_000);
    let Ok(device) = Device::new(bus, select, spin, const { TIMING.at(SPI) });
    spawner.spawn(sample(Polled::new(device, flight::PERIOD)).expect("spawned once"));

    static WAITING: StaticCell<[u8; 512]> = StaticCell::new();
    let mut at = uart::Config::default();
    at.baudrate = BAUD;
    let waiting = WAITING.init([0; 512]);
    let mut port = BufferedUartTx::new(p.UART0, Interrupts, p.PIN_0, waiting, at);
    // Another session at each start.
    let session = Session::random(RoscRng.next_u64());
    let mut sender = Sender::of(flight::transmitter(session));
    let mut events = EVENTS.consumer().expect("taken once");
    let (mut gather, mut seen) = (Ticker::every(Duration::from_millis(5)), 0);
    loop {
        gather.next().await;
        sender.observe(ROUNDS.time(flight::PERIOD));
        // A frame that is not through by then is a gap to the far end.
        _ = with_timeout(Duration::from_millis(20), sender.send(&mut events, &mut port)).await;
        if ROUNDS.went_on(&mut seen) {
            watchdog.feed(WATCHDOG_LIMIT);
        }
    }
}
