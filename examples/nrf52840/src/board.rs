//! An nRF52840-DK: its clocks and pins. Another board changes this file only.

use embassy_nrf::{
    bind_interrupts,
    config::{Config, HfclkSource, LfclkSource},
    gpio::{Input, Level, Output, OutputDrive, Pull},
    pac::TIMER1,
    peripherals::{SPI2, UARTE0},
    rng::Rng,
    spim::{self, Frequency, Spim},
    timer::Timer,
    uarte::{self, Baudrate, UarteTx},
    wdt::{self, Watchdog, WatchdogHandle},
};
use embedded_hal::delay::DelayNs;
use flight::Timing;
use spikewire::Tick;

bind_interrupts!(struct Interrupts {
    SPI2 => spim::InterruptHandler<SPI2>;
    UARTE0 => uarte::InterruptHandler<UARTE0>;
});

pub type Imu = flight::Device<Spim<'static>, Output<'static>, Spin>;

/// The fastest of SPIM0 to 2; a burst takes 132 µs of each millisecond. SPIM3 is faster, and may send wrong bytes when the
/// processor writes to the same block of memory (anomaly 198).
const IMU: Frequency = Frequency::M8;
const IMU_TIMING: Timing = Timing { guard: 100, pause: 0 }.at(8_000_000);
const BAUD: Baudrate = Baudrate::Baud921600;
/// Ticks of 32 768 Hz: half a second, longer than the sensor takes to start, with a pause to the next try.
const WATCHDOG: u32 = 16_384;

pub struct Board {
    pub imu: Imu,
    pub data_ready: Input<'static>,
    pub uart: UarteTx<'static>,
    pub watchdog: WatchdogHandle,
    /// A number from the part's generator: another after most starts.
    pub session: u16,
}

pub fn start() -> Board {
    let mut config = Config::default();
    config.hfclk_source = HfclkSource::ExternalXtal;
    config.lfclk_source = LfclkSource::ExternalXtal;
    let p = embassy_nrf::init(config);

    let mut config = wdt::Config::default();
    config.timeout_ticks = WATCHDOG;
    // It may run already, from before a reset; with these settings it is ours.
    let Ok((_, [watchdog])) = Watchdog::try_new(p.WDT, config) else {
        panic!("the watchdog runs with other settings");
    };
    // The HAL's clock has 32 768 Hz; 8 kHz wants a finer one.
    Timer::new(p.TIMER1).start();

    let mut config = spim::Config::default(); // mode 0
    config.frequency = IMU;
    let (clock, back, out) = (p.P1_15, p.P1_14, p.P1_13);
    let bus = Spim::new(p.SPI2, Interrupts, clock, back, out, config);
    let select = Output::new(p.P1_12, Level::High, OutputDrive::Standard);
    let Ok(imu) = flight::Device::new(bus, select, Spin, IMU_TIMING);

    let mut config = uarte::Config::default();
    config.baudrate = BAUD;
    Board {
        imu,
        data_ready: Input::new(p.P1_11, Pull::Down),
        uart: UarteTx::new(p.UARTE0, Interrupts, p.P0_06, config),
        watchdog,
        session: Rng::new_blocking(p.RNG).blocking_next_u32() as u16,
    }
}

/// Microseconds, for ticks.
pub fn now() -> Tick {
    // The interrupt that stamps log lines must not take the register in between.
    cortex_m::interrupt::free(|_| {
        TIMER1.tasks_capture(0).write_value(1);
        Tick::from(TIMER1.cc(0).read())
    })
}

/// Waits by counting cycles: a tick of the HAL's clock is 30 µs.
pub struct Spin;

impl DelayNs for Spin {
    fn delay_ns(&mut self, ns: u32) {
        const CYCLES_A_MICROSECOND: u32 = 64;
        cortex_m::asm::delay(ns.div_ceil(1000).saturating_mul(CYCLES_A_MICROSECOND));
    }
}
