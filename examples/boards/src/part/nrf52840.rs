//! An nRF52840: watchdog, clocks and time.

use embassy_nrf::{
    Peripherals,
    config::{Config, HfclkSource, LfclkSource},
    pac::{POWER, TIMER1},
    peripherals::WDT,
    timer::Timer,
    wdt::{self, HaltConfig, WatchdogHandle},
};
use embassy_time::Duration;
use flight::Spin;
use spikewire::Tick;

use crate::Reset;

const CORE_HZ: u32 = 64_000_000;
/// The watchdog's clock.
const SLOW_HZ: u64 = 32_768;

/// The watchdog, which stands still while a debugger halts the core.
pub struct Watchdog(WatchdogHandle);

impl Watchdog {
    /// Starts it. It may run already, from before a reset: with the same settings it is ours.
    pub fn start(limit: Duration) -> Self {
        let mut config = wdt::Config::default();
        config.timeout_ticks = (limit.as_micros() * SLOW_HZ / 1_000_000) as u32;
        config.action_during_debug_halt = HaltConfig::Pause;
        // SAFETY: nobody else takes the watchdog.
        match wdt::Watchdog::try_new(unsafe { WDT::steal() }, config) {
            Ok((_, [handle])) => Self(handle),
            Err(_) => panic!("the watchdog runs with other settings"),
        }
    }

    pub fn feed(&mut self) {
        self.0.pet();
    }

    pub fn reset(&self) -> Reset {
        let flags = POWER.resetreas().read();
        POWER.resetreas().write_value(flags); // ones clear
        match (flags.dog(), flags.sreq()) {
            (true, _) => Reset::Watchdog,
            (_, true) => Reset::Software,
            _ => Reset::PowerOrPin,
        }
    }
}

/// Starts both crystals, and TIMER1 for the ticks of events: the HAL's clock has 32 768 Hz, and 8 kHz wants a finer one.
pub fn start() -> Peripherals {
    let mut config = Config::default();
    config.hfclk_source = HfclkSource::ExternalXtal;
    config.lfclk_source = LfclkSource::ExternalXtal;
    let p = embassy_nrf::init(config);
    // SAFETY: nobody else takes the timer.
    let timer = Timer::new(unsafe { embassy_nrf::peripherals::TIMER1::steal() });
    timer.start();
    timer.persist(); // dropped, it would stop
    p
}

/// Waits by the core's cycles.
pub fn spin() -> Spin {
    Spin::new(CORE_HZ)
}

/// Microseconds since the start.
pub fn now() -> Tick {
    // The interrupt that stamps log lines must not take the register in between.
    cortex_m::interrupt::free(|_| {
        TIMER1.tasks_capture(0).write_value(1);
        Tick::from(TIMER1.cc(0).read())
    })
}
