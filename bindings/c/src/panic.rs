//! The panic handler that cannot be linked.

use core::panic::PanicInfo;

unsafe extern "C" {
    /// There is none: whoever sees this name in a linker's error has found a path to a panic.
    safe fn sw_has_a_path_to_a_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    sw_has_a_path_to_a_panic()
}
