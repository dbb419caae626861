//! A Cortex-M with a debugger or an emulator attached.

use core::{
    fmt::{self, Write},
    panic::PanicInfo,
};
use cortex_m as _; // links its critical section
pub use cortex_m_rt::entry;
use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{
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

/// A fault ends the program at once: the default handler would spin until the emulator is killed.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    if let Ok(mut stream) = hio::hstdout() {
        let _ = writeln!(stream, "hard fault at {:#010x}", frame.pc());
    }
    stop(false)
}
