//! A recorded flight: timer interrupt, bank, queue, frames out of the UART, for `spikewire listen` at the other end.
//!
//! The board decodes its spikes as they are made, and prints a digest of the values: those at the other end must be
//! the same.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod send;

#[cfg(target_os = "none")]
#[board::entry]
fn main() -> ! {
    board::finish(send::run(&mut board::console()))
}

/// The host has no UART; it listens.
#[cfg(not(target_os = "none"))]
fn main() {}
