//! Counts instructions and stack on an emulated core.
//!
//! In QEMU's `-icount shift=N` virtual time is the number of instructions times 2^N ns, so the core's own SysTick
//! timer counts them. `cargo bench-target` says at build time how many ticks make 10^9 instructions.

use core::{
    arch::{asm, naked_asm},
    hint::black_box,
    sync::atomic::{AtomicU32, Ordering::Relaxed, Ordering::SeqCst, compiler_fence},
};
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_semihosting::syscall;

pub use crate::count::Count;

/// Ticks for 10^9 instructions; more than 2 an instruction, so that rounding gives the exact count.
const TICKS: u64 = match option_env!("TICKS_PER_GIGAINSTRUCTION") {
    Some(text) => match u64::from_str_radix(text, 10) {
        Ok(ticks) => ticks,
        Err(_) => panic!("TICKS_PER_GIGAINSTRUCTION must be a number"),
    },
    None => 1_000_000_000,
};

/// The timer counts 24 bits down, then calls its handler.
const TURN: u32 = 1 << 24;

/// Where the timer stood at a measurement's start.
static START: AtomicU32 = AtomicU32::new(0);

/// Turns of the timer since a measurement's start.
static TURNS: AtomicU32 = AtomicU32::new(0);

/// Instructions of the handler, which run in the midst of what is measured.
const HANDLER: u64 = 5;

/// Bytes of the stack that are watched.
const PAINTED: usize = 2048;

unsafe extern "C" {
    /// Where the statics end: the linker's.
    static __sheap: u32;
}

/// In assembly, so that its instructions are known.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn SysTick() {
    naked_asm!(
        "ldr r0, ={turns}",
        "ldr r1, [r0]",
        "adds r1, #1",
        "str r1, [r0]",
        "bx lr",
        ".ltorg",
        turns = sym TURNS
    )
}

/// The instructions of one call of `work`, without those of calling and of timing it.
#[inline(never)]
pub fn instructions(work: impl FnOnce()) -> u32 {
    start();
    let nothing = stop();
    start();
    compiler_fence(SeqCst);
    work();
    compiler_fence(SeqCst);
    count(stop(), nothing)
}

/// What one call of `work` takes, without calling and counting it.
#[inline(never)]
pub fn counted(work: impl FnOnce()) -> Count {
    let (no_time, no_cycles) = nothing();
    start();
    let before = cycles();
    compiler_fence(SeqCst);
    work();
    compiler_fence(SeqCst);
    let after = cycles();
    Count { instructions: count(stop(), no_time), cycles: less(less(after, before), no_cycles) }
}

/// What an empty piece of work takes.
#[inline(never)]
fn nothing() -> (Time, [u32; 2]) {
    open();
    start();
    let (before, after) = (cycles(), cycles());
    (stop(), less(after, before))
}

/// The file in which the emulator keeps the sums of cycles, less one: 0 before it is open.
static FILE: AtomicU32 = AtomicU32::new(0);

#[inline(never)]
fn open() {
    const PATH: &[u8] = b"cycles\0";
    const READ_BINARY: usize = 1;
    if FILE.load(Relaxed) == 0 {
        // SAFETY: address and length of a text that ends with a zero.
        let file = unsafe { syscall!(OPEN, PATH.as_ptr(), READ_BINARY, PATH.len() - 1) };
        FILE.store((file as u32).wrapping_add(1), Relaxed);
    }
}

/// The bounds of the cycles so far, which the emulator puts there at every call of this kind.
#[inline(never)]
fn cycles() -> [u32; 2] {
    let mut sums = [0_u32; 2];
    let file = FILE.load(Relaxed).wrapping_sub(1);
    // SAFETY: the buffer has room for what is read.
    unsafe {
        syscall!(SEEK, file, 0);
        syscall!(READ, file, sums.as_mut_ptr(), size_of_val(&sums));
    }
    sums
}

#[inline(never)]
fn less(many: [u32; 2], less: [u32; 2]) -> [u32; 2] {
    [many[0].wrapping_sub(less[0]), many[1].wrapping_sub(less[1])]
}

/// What the timer told.
struct Time {
    ticks: u64,
    turns: u64,
}

// Functions of their own, as there are hundreds of measurements, and not much flash.

#[inline(never)]
fn start() {
    let timer = timer();
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(TURN - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
    // The first read leaves the reload behind, which may count as a turn.
    START.store(SYST::get_current(), Relaxed);
    TURNS.store(0, Relaxed);
}

#[inline(never)]
fn stop() -> Time {
    timer().disable_counter();
    let turns = u64::from(TURNS.load(Relaxed));
    let passed = u64::from(START.load(Relaxed)) + turns * u64::from(TURN);
    Time { ticks: passed - u64::from(SYST::get_current()), turns }
}

#[inline(never)]
fn count(Time { ticks, turns }: Time, nothing: Time) -> u32 {
    let count = ((ticks - nothing.ticks) * 1_000_000_000 + TICKS / 2) / TICKS;
    (count - turns * HANDLER) as u32
}

fn timer() -> &'static mut SYST {
    // SAFETY: nothing else in a bench program touches the timer.
    unsafe { &mut *core::ptr::without_provenance_mut::<SYST>(SYST::PTR.addr()) }
}

/// Whether counts are exact here, of little and of more than a turn of the timer.
pub fn is_exact() -> bool {
    // SAFETY: does nothing.
    let nops = instructions(|| unsafe { asm!("nop", "nop", "nop") });
    let of = |rounds: u32| {
        // SAFETY: counts a register down.
        instructions(|| unsafe {
            asm!("2:", "subs {0}, #1", "bne 2b", inout(reg) black_box(rounds) => _);
        })
    };
    let one = of(1);
    nops == 3
        && (2..64).chain([1000, 10_000_000]).all(|rounds| of(rounds) == one + 2 * (rounds - 1))
}

/// Makes the compiler believe that the value is looked at in memory, at no instruction.
#[inline(always)]
pub fn keep<T: ?Sized>(value: &T) {
    // SAFETY: a comment.
    unsafe {
        asm!("/* {} */", in(reg) (&raw const *value).cast::<()>(), options(nostack, preserves_flags))
    };
}

/// How far below its caller the stack of `work` reaches, in bytes, up to 2048 or what is free.
#[inline(never)]
pub fn stack_depth(work: impl FnOnce()) -> u32 {
    const PAINT: u32 = 0x5afe_c0de;
    let top: usize;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack)) };
    let bottom = (top - PAINTED).max((&raw const __sheap).addr());
    let mut touched = bottom;
    // SAFETY: what lies between the statics and the stack pointer is free. In assembly, as a function
    // that paints would have its own stack there.
    unsafe {
        asm!(
            "2:",
            "str {paint}, [{at}]",
            "adds {at}, #4",
            "cmp {at}, sp",
            "bne 2b",
            at = inout(reg) bottom => _,
            paint = in(reg) PAINT,
        );
    }
    work();
    // SAFETY: reads what was painted, and ends at what was not.
    unsafe {
        asm!(
            "2:",
            "ldr {word}, [{at}]",
            "adds {at}, #4",
            "cmp {word}, {paint}",
            "beq 2b",
            word = out(reg) _,
            at = inout(reg) touched,
            paint = in(reg) PAINT,
        );
    }
    // One word further, and at least there if nothing was touched.
    (top + 4).saturating_sub(touched) as u32
}
