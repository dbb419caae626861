//! An ICM-42688-P's samples as spikes, by `flight.toml`, out of the serial port of an STM32F405, with embassy-stm32.

#![no_std]
#![no_main]

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::{
    Config, bind_interrupts, dma,
    gpio::{Level, Output, Pull, Speed},
    mode::Async,
    pac,
    peripherals::{DMA2_CH0, DMA2_CH3, DMA2_CH6, IWDG, RNG},
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv,
        PllSource, Sysclk,
    },
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
    usart::{self, UartTx},
    wdg::IndependentWatchdog,
};
use embassy_time::{Duration, Ticker, with_timeout};
use icm42688p::{Polled, TIMING};
use imu::{Channels, Device, Registers, Rounds, Sender, Spin, Station};
use panic_probe as _;
use spikewire::{EventQueue, Overflow, link::Session};

include!(concat!(env!("OUT_DIR"), "/flight.rs"));

// The board.
type Sensor = Polled<Device<Spi<'static, Async, Master>, Output<'static>, Spin>>;
const CRYSTAL: Hertz = Hertz(8_000_000);
const SPI: u32 = 10_500_000;
const BAUD: u32 = 921_600;

bind_interrupts!(struct Interrupts {
    DMA2_STREAM0 => dma::InterruptHandler<DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<DMA2_CH3>;
    DMA2_STREAM6 => dma::InterruptHandler<DMA2_CH6>;
    RNG => rng::InterruptHandler<RNG>;
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
    pac::DBGMCU.apb1fzr().modify(|frozen| frozen.set_iwdg(true));
    // SAFETY: nobody else takes the watchdog.
    let mut watchdog = IndependentWatchdog::new(unsafe { IWDG::steal() }, 500_000);
    watchdog.unleash();

    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: CRYSTAL, mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2), // 168 MHz
        divq: Some(PllQDiv::DIV7), // 48 MHz, for random numbers
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    let p = embassy_stm32::init(config);
    defmt::info!("reset by the watchdog: {}", pac::RCC.csr().read().wdgrstf());
    pac::RCC.csr().modify(|flags| flags.set_rmvf(true));

    let mut at = spi::Config::default(); // mode 0
    at.frequency = Hertz(SPI);
    at.gpio_speed = Speed::VeryHigh;
    at.miso_pull = Pull::Up; // a line that nobody drives reads as ones
    let bus = Spi::new(p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, at);
    let select = Output::new(p.PA4, Level::High, Speed::VeryHigh);
    let spin = Spin::new(168_000_000);
    let Ok(device) = Device::new(bus, select, spin, const { TIMING.at(SPI) });
    spawner.spawn(sample(Polled::new(device, flight::PERIOD)).expect("spawned once"));

    let mut at = usart::Config::default();
    at.baudrate = BAUD;
    let port = UartTx::new(p.USART6, p.PC6, p.DMA2_CH6, Interrupts, at);
    let mut port = port.expect("the rate is one that the clock gives");
    // Another session at each start.
    let session = Session::random(Rng::new(p.RNG, Interrupts).next_u64());
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
