//! Bytes to commands.

use core::{
    fmt::{self, Write},
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use far_end::FarEnd;

use board::{
    digest::Digest,
    usart::{Usart1, Usart2},
};

/// A millisecond at QEMU's 168 MHz.
const TIMER_RELOAD: u32 = 168_000;

static MILLISECONDS: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    MILLISECONDS.fetch_add(1, Relaxed);
}

pub fn run(out: &mut impl Write) -> fmt::Result {
    let mut timer = cortex_m::Peripherals::take().ok_or(fmt::Error)?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(TIMER_RELOAD - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();

    let (mut line, mut actuators) = (Usart1::new(), Usart2::new());
    let mut far = FarEnd::default();
    let (mut values, mut hash, mut commands) = (0_u32, Digest::new(), 0_u32);
    loop {
        let now = MILLISECONDS.load(Relaxed);
        // Before the first frame there is only noise. A vehicle is neutral then, and goes on listening after the last one.
        if let (Some(command), true) = (far.silence(now), commands > 0) {
            actuators.send(&command.bytes());
            break;
        }
        let Some(byte) = line.byte() else { continue };
        far.take(
            now,
            &[byte],
            |channel, tick, value| {
                values += 1;
                hash.add([channel.into(), tick.micros(), value.to_bits()]); // as the sender prints its own
            },
            |command| {
                commands += 1;
                actuators.send(&command.bytes());
            },
        );
    }
    writeln!(out, "{values} values and keyframes {hash}")?;
    writeln!(out, "{commands} commands, {} frames lost", far.lost_frames())
}
