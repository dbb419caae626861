//! Start and faults of a RISC-V core.

use crate::semihosting::fail;
use riscv::register::{mcause, mepc}; // the crate also brings the critical section
pub use riscv_rt::entry;

/// An exception ends the program at once: without a handler it would spin until the emulator is killed.
#[unsafe(export_name = "ExceptionHandler")]
fn exception(_frame: &riscv_rt::TrapFrame) -> ! {
    fail(format_args!("exception {} at {:#010x}", mcause::read().code(), mepc::read()))
}
