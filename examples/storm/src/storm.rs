//! Two interrupts, one above the other, push more events than main takes, under each policy of the queue.
//!
//! Every event tells its source and number, so that main knows which are missing: all of them must have been counted,
//! and told at the item that follows them. The last storm strikes the lock-free queue.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod account;
mod check;
mod source;

#[cfg_attr(target_os = "none", path = "interrupts.rs")]
#[cfg_attr(not(target_os = "none"), path = "threads.rs")]
mod weather;

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(check::run(&mut board::console()))
}
