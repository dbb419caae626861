//! The time of an event, and short waits.

use cortex_m::asm;
use embedded_hal::delay::DelayNs;
use rtic_time::Monotonic;
use spikewire::Tick;
use stm32f4xx_hal::{pac, timer::MonoTimerUs};

/// Microseconds since the start.
type Clock = MonoTimerUs<pac::TIM5>;

pub fn now() -> Tick {
    Tick::from_micros(Clock::now().duration_since_epoch().to_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());

/// Waits by spinning, at least as long as asked for.
pub struct Spin;

impl DelayNs for Spin {
    fn delay_ns(&mut self, time: u32) {
        asm::delay((u64::from(time) * 168 / 1_000) as u32 + 1);
    }
}
