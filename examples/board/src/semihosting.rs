//! A core with a debugger or an emulator attached.

#[cfg(target_arch = "arm")]
use cortex_m_semihosting as semihosting;
#[cfg(target_arch = "riscv32")]
use riscv_semihosting as semihosting;

use core::{
    fmt::{self, Write},
    panic::PanicInfo,
};
use semihosting::{
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

/// Prints why the program cannot go on, and ends it.
pub(crate) fn fail(why: fmt::Arguments<'_>) -> ! {
    if let Ok(mut stream) = hio::hstdout() {
        let _ = writeln!(stream, "{why}");
    }
    stop(false)
}

fn stop(good: bool) -> ! {
    debug::exit(if good { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    fail(format_args!("{info}"))
}
