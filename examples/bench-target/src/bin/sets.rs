//! Counts what sets of six samples cost: in a bank, and from there to frames.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(bench_target::run_sets(&mut board::console()))
}
