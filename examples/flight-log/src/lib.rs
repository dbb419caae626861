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
use flight::CHANNELS;
pub use flight::{Recorded, channel};
use heapless::Vec;
use line::Line;
pub use schemes::{Log, Logs, fly};

/// Encodes and decodes all channels by every scheme, as floats and as a sensor's counts.
pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    report::<f32>(out, "f32")?;
    report::<i16>(out, "i16")
}

/// The same in fixed point: a program of its own, as the smallest flash has no room for all types.
pub fn run_fixed(out: &mut impl fmt::Write) -> fmt::Result {
    report::<FixedI16<U8>>(out, "q8.8")?;
    report::<FixedI32<U16>>(out, "q16.16")
}

/// Flies every scheme in one sample type, and prints a line for each.
fn report<S: Recorded>(out: &mut impl fmt::Write, sample: &str) -> fmt::Result {
    let mut lines = Lines::default();
    for index in 0..CHANNELS {
        if let Err(error) = fly::<S>(index, &mut lines) {
            // The text of a float takes more flash than the smallest core has left.
            #[cfg(not(target_os = "none"))]
            writeln!(out, "{error}")?;
            let _ = error;
            writeln!(out, "{sample} channel {index} makes a parameter bad")?;
            return Err(fmt::Error);
        }
    }
    lines.0.iter().try_for_each(|(name, line)| line.write(out, name, sample))
}

/// A line for each scheme, over all channels.
#[derive(Default)]
struct Lines(Vec<(&'static str, Line), 64>);

impl Logs for Lines {
    type Log = Line;

    fn log(&mut self, name: &'static str, _: usize) -> &mut Line {
        let known = self.0.iter().position(|(line, _)| *line == name);
        let place = known.unwrap_or_else(|| {
            assert!(self.0.push((name, Line::default())).is_ok(), "too many schemes for the lines");
            self.0.len() - 1
        });
        &mut self.0[place].1
    }
}
