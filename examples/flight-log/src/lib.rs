//! A recorded flight through every scheme. One line for each scheme and sample type:
//!
//! ```text
//! step-forward f32 spikes=1234 efficiency=87.21 rmse=3d4ccccd hash=0123456789abcdef
//! ```
//!
//! The hash is over all spikes and all decoded bits, so two machines that print the same line did the same
//! arithmetic. Nothing here knows a board: the caller passes somewhere to print to.

#![cfg_attr(target_os = "none", no_std)]

mod flight;
mod line;
mod schemes;

use core::fmt;
use fixed::{
    FixedI16, FixedI32,
    types::extra::{U8, U16},
};
use flight::{CHANNELS, Recorded};
use line::Line;
pub use schemes::{Channel, Flight, Log, flights};

/// Encodes and decodes all channels by every scheme, in every sample type.
pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    fly::<f32>(out, "f32")?;
    fly::<FixedI16<U8>>(out, "q8.8")?;
    fly::<FixedI32<U16>>(out, "q16.16")?;
    fly::<i16>(out, "i16")
}

/// Flies every scheme in one sample type, and prints a line for each.
fn fly<S: Recorded>(out: &mut impl fmt::Write, sample: &str) -> fmt::Result {
    for (name, flight) in flights::<S, Line>() {
        let mut line = Line::default();
        for index in 0..CHANNELS {
            if let Err(error) = flight(&Channel::new(index), &mut line) {
                writeln!(out, "{name} {sample} channel {index}: {error}")?;
                return Err(fmt::Error);
            }
        }
        line.write(out, name, sample)?;
    }
    Ok(())
}
