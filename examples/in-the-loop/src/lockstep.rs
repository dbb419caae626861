//! A flight controller in the loop: registers and what is wanted in at USART1, frames, values and motor speeds out.
//!
//! It encodes the registers, drops the frames that it is told to, hears the others, and flies the cascade on what they
//! decode to: the same chain, step by step, that `laptop/loop/flight.py` has on the laptop.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chain;
#[cfg(target_os = "none")]
mod control;

#[cfg(target_os = "none")]
#[board::entry]
fn main() -> ! {
    board::finish(chain::run(&mut board::console()))
}

/// The world is another program: `laptop/loop/board.py`.
#[cfg(not(target_os = "none"))]
fn main() {}
