//! The timer's interrupt, and below it one that the timer sets off.

use crate::source::strike;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::SeqCst};
use cortex_m::{
    Peripherals,
    peripheral::{
        SCB, SYST,
        scb::SystemHandler::{PendSV, SysTick},
        syst::SystClkSource,
    },
};
use cortex_m_rt::exception;

/// The upper one surely strikes within the lower one.
pub const NESTS: bool = true;

/// Some 2000 to 3000 instructions on the emulated boards: main must get some of them.
const TIMER_RELOAD: u32 = 8_000;
/// Strikes of the timer for one of the other, which lasts several of them.
const STRIKES: u32 = 16;
const BURSTS: [u32; 2] = [3, 100];

static BOTH: AtomicBool = AtomicBool::new(false);
static STRUCK: AtomicU32 = AtomicU32::new(0);

pub fn start(both: bool) {
    BOTH.store(both, SeqCst);
    // SAFETY: nothing else has the timer or sets priorities.
    let Peripherals { mut SYST, mut SCB, .. } = unsafe { Peripherals::steal() };
    // SAFETY: no critical section depends on priorities.
    unsafe {
        SCB.set_priority(SysTick, 0x00);
        SCB.set_priority(PendSV, 0xFF);
    }
    SYST.set_clock_source(SystClkSource::Core);
    SYST.set_reload(TIMER_RELOAD - 1);
    SYST.clear_current();
    SYST.enable_interrupt();
    SYST.enable_counter();
}

/// The lower interrupt is over, as main goes on only then.
pub fn stop() {
    // SAFETY: as above.
    let mut timer: SYST = unsafe { Peripherals::steal() }.SYST;
    timer.disable_counter();
    timer.disable_interrupt();
    SCB::clear_pendst();
}

#[exception]
fn SysTick() {
    strike(0, BURSTS[0]);
    let struck = STRUCK.load(SeqCst).wrapping_add(1);
    STRUCK.store(struck, SeqCst);
    if BOTH.load(SeqCst) && struck.is_multiple_of(STRIKES) {
        SCB::set_pendsv();
    }
}

#[exception]
fn PendSV() {
    strike(1, BURSTS[1]);
}
