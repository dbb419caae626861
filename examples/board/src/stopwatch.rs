//! Counts instructions and stack on an emulated core.
//!
//! In QEMU's `-icount shift=N` virtual time is the number of instructions times 2^N ns, so the core's own SysTick
//! timer counts them. `cargo bench-target` says at build time how many ticks make 10^9 instructions.

use core::{
    arch::asm,
    hint::black_box,
    ptr::{read_volatile, write_volatile},
};
use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// Ticks for 10^9 instructions; at least 2 a instruction, so that rounding gives the exact count.
const TICKS: u64 = match option_env!("TICKS_PER_GIGAINSTRUCTION") {
    Some(text) => match u64::from_str_radix(text, 10) {
        Ok(ticks) => ticks,
        Err(_) => panic!("TICKS_PER_GIGAINSTRUCTION must be a number"),
    },
    None => 1_000_000_000,
};

const FULL: u32 = 0x00ff_ffff;

/// The instructions of one call of `work`, without those of calling and of timing it.
///
/// Counts up to two turns of the 24-bit timer, some 1.5 million instructions.
#[inline(never)]
pub fn instructions(work: impl FnOnce()) -> u32 {
    let nothing = ticks(|| ());
    let ticks = ticks(work) - nothing;
    ((u64::from(ticks) * 1_000_000_000 + TICKS / 2) / TICKS) as u32
}

#[inline(always)]
fn ticks(work: impl FnOnce()) -> u32 {
    // SAFETY: nothing else in a bench program touches the timer.
    let timer: &mut SYST = unsafe { &mut cortex_m::Peripherals::steal().SYST };
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(FULL);
    timer.clear_current();
    timer.enable_counter();
    // A first read leaves the reload behind and clears the flag of a wrap.
    let start = SYST::get_current();
    black_box(timer.has_wrapped());
    work();
    let end = SYST::get_current();
    let wrapped = u32::from(timer.has_wrapped());
    timer.disable_counter();
    start.wrapping_sub(end).wrapping_add(wrapped * (FULL + 1))
}

/// How far below its caller the stack of `work` reaches, in bytes, up to 2048.
#[inline(never)]
pub fn stack_depth(work: impl FnOnce()) -> u32 {
    const WORDS: usize = 512;
    const PAINT: u32 = 0x5afe_c0de;
    let top: *mut u32;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack)) };
    let bottom = top.wrapping_sub(WORDS);
    for word in 0..WORDS - 16 {
        // SAFETY: below the stack pointer, less what this function itself may spill, lies free RAM: `memory.x`
        // leaves 2 KiB and more.
        unsafe { write_volatile(bottom.wrapping_add(word), PAINT) };
    }
    work();
    let untouched = (0..WORDS)
        // SAFETY: as above.
        .take_while(|&word| unsafe { read_volatile(bottom.wrapping_add(word)) } == PAINT)
        .count();
    (4 * (WORDS - untouched)) as u32
}
