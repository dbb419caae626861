//! A RISC-V core with a debugger or an emulator attached.

use core::{
    fmt::{self, Write},
    panic::PanicInfo,
};
use riscv::register::{mcause, mepc}; // the crate also brings the critical section
pub use riscv_rt::entry;
use riscv_semihosting::{
    debug::{self, EXIT_FAILURE, EXIT_SUCCESS},
    hio::{self, HostStream},
};

/// The debugger's or emulator's standard output.
pub fn console() -> HostStream {
    match hio::hstdout() {
        Ok(stream) => stream,
        Err(()) => stop(false),
    }
}

/// Ends the program; the emulator's exit status tells how it went.
pub fn finish(result: fmt::Result) -> ! {
    stop(result.is_ok())
}

fn stop(good: bool) -> ! {
    debug::exit(if good { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    if let Ok(mut stream) = hio::hstdout() {
        let _ = writeln!(stream, "{info}");
    }
    stop(false)
}

/// Ends the program at an exception: without a handler it would spin until the emulator is killed.
#[unsafe(export_name = "ExceptionHandler")]
fn exception(_frame: &riscv_rt::TrapFrame) -> ! {
    if let Ok(mut stream) = hio::hstdout() {
        let (cause, place) = (mcause::read().code(), mepc::read());
        let _ = writeln!(stream, "exception {cause} at {place:#010x}");
    }
    stop(false)
}
