//! A flight over a line on which one thing after the other goes wrong, sender and far end in one microcontroller.
//!
//! A spell of one second with a fault takes turns with half a second without. Whatever the far end calls exact must have
//! the bits of a decoder beside the encoder, every frame that it takes must be one that was sent, every frame or item that
//! is missing must have been counted, and all channels must be exact again by the next keyframe; where the far end itself
//! starts again, by the first keyframe with the sender's fingerprint.
//! `SOAK_SPELLS` at build time says how many spells each fault has; 40 of them are twelve minutes of flight.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod far_end;
mod line;
mod sender;
mod world;

use core::fmt::{self, Write};

use line::FAULTS;
use world::World;

fn run(out: &mut impl Write) -> fmt::Result {
    let spells = option_env!("SOAK_SPELLS").and_then(|spells| spells.parse().ok()).unwrap_or(40);
    let mut world = World::new();
    let mut samples = 0;
    for (fault, name) in FAULTS {
        let tally = world.fly(fault, spells).or_else(|broken| fail(out, name, broken))?;
        samples += tally.samples;
        writeln!(out, "{name}: {tally}")?;
    }
    writeln!(out, "{} s of flight", samples / (1_000_000 / world::PERIOD))
}

fn fail<T>(out: &mut impl Write, fault: &str, broken: &str) -> Result<T, fmt::Error> {
    writeln!(out, "{fault}: {broken}")?;
    Err(fmt::Error)
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
