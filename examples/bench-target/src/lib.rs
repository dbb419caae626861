//! Counts the instructions of every codec, and of an event's way, exactly. `cargo bench-target` builds, runs and
//! reads it.
//!
//! Two programs for each sample type, and two for events, as one of all does not fit the flash of a Cortex-M0. It prints one line of JSON
//! for each signal, codec, direction and form. Counts come from the core's timer, which in QEMU's `-icount` advances
//! with the instructions, and from a plugin of QEMU that adds up cycles; on the host, which has none, they are 0.

#![cfg_attr(target_os = "none", no_std)]

mod codecs;
mod events;
#[cfg(target_os = "none")]
mod loops;
mod measure;
mod signal;

use core::fmt::{self, Write};
use signal::{Measured, Signal};

/// Measures the codecs of one half of the catalogue in one sample type, which is called `sample` in what it prints.
pub fn run<S: Measured, const HALF: usize>(out: &mut impl Write, sample: &str) -> fmt::Result {
    ensure_exact(out)?;
    for signal in [Signal::Paper, Signal::Flight] {
        codecs::measure::<S, HALF>(out, sample, signal)?;
    }
    Ok(())
}

/// Measures what an event costs in the queue, in every link and format, and as a chip's word.
pub fn run_events(out: &mut impl Write) -> fmt::Result {
    ensure_exact(out)?;
    events::measure(out)
}

/// Counts small loops whose cycles are known. The host has none.
pub fn run_loops(out: &mut impl Write) -> fmt::Result {
    ensure_exact(out)?;
    #[cfg(target_os = "none")]
    loops::measure(out)?;
    Ok(())
}

/// Measures what sets of six samples cost.
pub fn run_sets(out: &mut impl Write) -> fmt::Result {
    ensure_exact(out)?;
    events::measure_sets(out)
}

fn ensure_exact(out: &mut impl Write) -> fmt::Result {
    if board::stopwatch::is_exact() {
        return Ok(());
    }
    writeln!(out, "instructions are not counted exactly: start this with `cargo bench-target`")?;
    Err(fmt::Error)
}
