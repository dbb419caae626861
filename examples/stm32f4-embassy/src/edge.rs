//! When the sensor's data-ready edge came: in the interrupt, however late the task runs.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use embassy_stm32::interrupt::typelevel::{Handler, Interrupt};
use embassy_time::Instant;
use spikewire::Tick;

static LAST: AtomicU32 = AtomicU32::new(0);

/// An interrupt handler in front of embassy's, which then masks the line until the task waits again: of edges that come
/// before that the first one counts, and the sampler finds the others missing.
pub struct Stamp;

impl<I: Interrupt> Handler<I> for Stamp {
    unsafe fn on_interrupt() {
        LAST.store(now().micros(), Relaxed);
    }
}

/// The last edge that was waited for.
pub fn last() -> Tick {
    Tick::from(LAST.load(Relaxed))
}

pub fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}

defmt::timestamp!("{=u32:us}", now().micros());
