//! Counts the instructions of every codec, exactly. `cargo bench-target` builds, runs and reads it.
//!
//! One line of JSON for each codec, direction, sample type and form. Counts come from the core's timer, which in
//! QEMU's `-icount` advances with the instructions; on the host, which has none, they are 0.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod codecs;
mod measure;
mod plain;
mod signal;

use core::fmt::{self, Write};
use fixed::{
    FixedI16, FixedI32,
    types::extra::{U8, U16},
};
use signal::Signal;

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}

fn run(out: &mut impl Write) -> fmt::Result {
    for signal in [Signal::Paper, Signal::Flight] {
        codecs::measure::<f32>(out, "f32", signal)?;
        codecs::measure::<FixedI32<U16>>(out, "q16.16", signal)?;
        codecs::measure::<FixedI16<U8>>(out, "q8.8", signal)?;
        codecs::measure::<i16>(out, "i16", signal)?;
    }
    Ok(())
}
