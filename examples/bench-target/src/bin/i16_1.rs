//! Counts the instructions of the codecs of the catalogue's first half in `i16`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(bench_target::run::<i16, 0>(&mut board::console(), "i16"))
}
