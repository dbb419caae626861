//! Counts the instructions of an event on its way: queue, links, formats, chips' words.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(bench_target::run_events(&mut board::console()))
}
