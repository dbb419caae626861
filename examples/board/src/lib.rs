//! What every example needs from its surroundings: a console to print to, and an ending.
//!
//! On a microcontroller both go through semihosting, so a debugger or QEMU must be attached. On the host they are
//! standard output and the exit status. A program's `main` is the same text for both.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(feature = "chip-bus")]
pub mod chip_bus;
#[cfg(feature = "stopwatch")]
mod count;
pub mod digest;
#[cfg(all(target_os = "none", feature = "stopwatch"))]
pub mod stopwatch;
#[cfg(all(target_os = "none", feature = "usart"))]
pub mod usart;

#[cfg(target_arch = "arm")]
mod cortex_m;
#[cfg(target_arch = "arm")]
pub use cortex_m::entry;
#[cfg(target_arch = "riscv32")]
mod riscv;
#[cfg(target_arch = "riscv32")]
pub use riscv::entry;
#[cfg(target_os = "none")]
mod semihosting;
#[cfg(target_os = "none")]
pub use semihosting::{console, finish};

/// The host counts no instructions.
#[cfg(all(not(target_os = "none"), feature = "stopwatch"))]
pub mod stopwatch {
    pub use crate::count::Count;

    pub fn counted(work: impl FnOnce()) -> Count {
        work();
        Count::default()
    }

    pub fn instructions(work: impl FnOnce()) -> u32 {
        work();
        0
    }

    pub fn stack_depth(work: impl FnOnce()) -> u32 {
        work();
        0
    }

    pub fn is_exact() -> bool {
        true
    }

    pub fn keep<T: ?Sized>(value: &T) {
        core::hint::black_box(value);
    }
}

#[cfg(not(target_os = "none"))]
mod host;
#[cfg(not(target_os = "none"))]
pub use host::{console, finish};
