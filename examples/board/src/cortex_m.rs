//! Start and faults of a Cortex-M.

use crate::semihosting::fail;
use cortex_m as _; // links its critical section
pub use cortex_m_rt::entry;
use cortex_m_rt::{ExceptionFrame, exception};

/// A fault ends the program at once: the default handler would spin until the emulator is killed.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    fail(format_args!("hard fault at {:#010x}", frame.pc()))
}
