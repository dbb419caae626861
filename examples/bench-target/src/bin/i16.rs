//! Counts the instructions of every codec in `i16`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(bench_target::run::<i16>(&mut board::console(), "i16"))
}
