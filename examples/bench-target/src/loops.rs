//! Small pieces of assembly whose cycles were worked out by hand, to check those that are counted: `xtask` knows both.

use core::{
    arch::naked_asm,
    fmt::{self, Write},
};

use board::stopwatch::counted;

pub fn measure(out: &mut impl Write) -> fmt::Result {
    let all: [(&str, extern "C" fn()); 5] = [
        ("count-down", count_down),
        ("copy", copy),
        ("call", call),
        ("save", save),
        ("multiple", multiple),
    ];
    all.into_iter().try_for_each(|(name, piece)| print(out, name, piece))?;
    #[cfg(target_has_atomic = "32")] // ARMv7-M, and not ARMv6-M
    large::measure(out)?;
    #[cfg(target_abi = "eabihf")]
    print(out, "floats", floats)?;
    Ok(())
}

/// Prints the instructions and both cycles of a piece, without its call and return.
#[inline(never)]
fn print(out: &mut impl Write, name: &str, piece: extern "C" fn()) -> fmt::Result {
    let of = |piece: extern "C" fn()| counted(|| piece());
    let count = of(piece).saturating_sub(of(nothing));
    writeln!(out, "{name} {} {} {}", count.instructions, count.cycles[0], count.cycles[1])
}

#[unsafe(naked)]
extern "C" fn nothing() {
    naked_asm!("bx lr")
}

#[unsafe(naked)]
extern "C" fn count_down() {
    naked_asm!("movs r0, #10", "2:", "subs r0, #1", "bne 2b", "bx lr")
}

#[unsafe(naked)]
extern "C" fn copy() {
    naked_asm!(
        "sub sp, #64",
        "mov r0, sp",
        "mov r1, sp",
        "adds r1, #32",
        "movs r2, #8",
        "2:",
        "ldr r3, [r0]",
        "str r3, [r1]",
        "adds r0, #4",
        "adds r1, #4",
        "subs r2, #1",
        "bne 2b",
        "add sp, #64",
        "bx lr",
    )
}

#[unsafe(naked)]
extern "C" fn call() {
    naked_asm!(
        "mov r3, lr",
        "movs r2, #5",
        "2:",
        "bl 3f",
        "subs r2, #1",
        "bne 2b",
        "bx r3",
        "3:",
        "bx lr",
    )
}

#[unsafe(naked)]
extern "C" fn save() {
    naked_asm!("mov r3, lr", "bl 2f", "bx r3", "2:", "push {{r0-r2, lr}}", "pop {{r0-r2, pc}}")
}

#[unsafe(naked)]
extern "C" fn multiple() {
    naked_asm!("mov r0, sp", "ldmia r0!, {{r1-r3}}", "bx lr")
}

#[cfg(target_has_atomic = "32")]
mod large {
    use super::{Write, fmt, naked_asm, print};

    pub(super) fn measure(out: &mut impl Write) -> fmt::Result {
        let all: [(&str, extern "C" fn()); 4] =
            [("divide", divide), ("block", block), ("pairs", pairs), ("unaligned", unaligned)];
        all.into_iter().try_for_each(|(name, piece)| print(out, name, piece))
    }

    #[unsafe(naked)]
    extern "C" fn divide() {
        naked_asm!("movs r0, #100", "movs r1, #7", "udiv r2, r0, r1", "bx lr")
    }

    #[unsafe(naked)]
    extern "C" fn block() {
        naked_asm!("movs r0, #1", "cmp r0, #1", "ite eq", "moveq r1, #2", "movne r1, #3", "bx lr",)
    }

    #[unsafe(naked)]
    extern "C" fn pairs() {
        naked_asm!("mov r0, sp", "ldr r1, [r0]", "ldr r2, [r0, #4]", "ldr r3, [r0, #8]", "bx lr")
    }

    #[unsafe(naked)]
    extern "C" fn unaligned() {
        naked_asm!("mov r0, sp", "ldr r1, [r0, #1]", "bx lr")
    }
}

#[cfg(target_abi = "eabihf")]
#[unsafe(naked)]
extern "C" fn floats() {
    naked_asm!(
        ".fpu fpv4-sp-d16", // a naked function begins without
        "vmov s0, r0",
        "vadd.f32 s1, s0, s0",
        "vmul.f32 s2, s1, s1",
        "vdiv.f32 s3, s2, s2",
        "vsqrt.f32 s4, s3",
        "vmov r0, s4",
        "bx lr",
    )
}
