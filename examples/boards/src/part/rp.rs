//! An RP2040 or an RP2350: watchdog and time.

use embassy_rp::{
    Peripherals,
    clocks::{RoscRng, clk_sys_freq},
    config::Config,
    pac,
    peripherals::WATCHDOG,
    watchdog::{ResetReason, Watchdog as Dog},
};
use embassy_time::{Duration, Instant};
use flight::Spin;
use spikewire::{Tick, link::Session};

use crate::Reset;

/// The watchdog, which stands still while a debugger halts the core.
pub struct Watchdog {
    dog: Dog,
    limit: Duration,
}

impl Watchdog {
    /// Starts it. Until the crystal runs it counts the ring oscillator's ticks, of which one is 1 to 7 µs.
    pub fn start(limit: Duration) -> Self {
        // SAFETY: nobody else takes the watchdog.
        let mut dog = Dog::new(unsafe { WATCHDOG::steal() });
        #[cfg(not(feature = "pico2"))]
        dog.enable_tick_generation(12);
        #[cfg(feature = "pico2")]
        pac::TICKS.watchdog_cycles().write(|cycles| cycles.0 = 12);
        #[cfg(feature = "pico2")]
        pac::TICKS.watchdog_ctrl().write(|control| control.set_enable(true));
        dog.pause_on_debug(true);
        dog.start(limit);
        Self { dog, limit }
    }

    pub fn feed(&mut self) {
        self.dog.feed(self.limit);
    }

    pub fn reset(&self) -> Reset {
        match self.dog.reset_reason() {
            Some(ResetReason::TimedOut) => Reset::Watchdog,
            Some(ResetReason::Forced) => Reset::Software,
            None => Reset::PowerOrPin,
        }
    }
}

/// Starts the clocks: a crystal of 12 MHz, and the HAL's 125 or 150 MHz.
pub fn start() -> Peripherals {
    embassy_rp::init(Config::default())
}

/// Waits by the core's cycles.
pub fn spin() -> Spin {
    Spin::new(clk_sys_freq())
}

/// Pulls an input up that the HAL leaves floating: a line that nobody drives then reads as ones.
pub fn pull_up(pin: usize) {
    pac::PADS_BANK0.gpio(pin).modify(|pad| pad.set_pue(true));
}

pub fn session() -> Session {
    Session::random(RoscRng.next_u64())
}

/// Microseconds since the start.
pub fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}
