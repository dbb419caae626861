//! Counts the instructions of the codecs of the catalogue's first half in `FixedI32<U16>`.

#![cfg_attr(target_os = "none", no_std, no_main)]

use fixed::{FixedI32, types::extra::U16};

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(bench_target::run::<FixedI32<U16>, 0>(&mut board::console(), "q16.16"))
}
