//! Counts the instructions of the codecs of the catalogue's first half in `FixedI16<U8>`.

#![cfg_attr(target_os = "none", no_std, no_main)]

use fixed::{FixedI16, types::extra::U8};

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(bench_target::run::<FixedI16<U8>, 0>(&mut board::console(), "q8.8"))
}
