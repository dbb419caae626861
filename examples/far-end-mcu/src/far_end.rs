//! A second microcontroller at the end of a serial line: link frames in at USART1, a command out of USART2 for each.
//!
//! After a silence it sends the neutral command, says what it has heard, and ends, for the emulator's sake.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod listen;

#[cfg(target_os = "none")]
#[board::entry]
fn main() -> ! {
    board::finish(listen::run(&mut board::console()))
}

/// The host is another example: `far-end-linux`.
#[cfg(not(target_os = "none"))]
fn main() {}
