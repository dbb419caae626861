//! What an event costs on its way: in the queue, in every link and format, and as a chip's word.
//!
//! The events are those of the recorded flight, six channels through SF. Whatever is written is read again and must be
//! the same: figures of something else would be worth nothing.

mod banks;
mod chips;
mod flight;
mod formats;
mod framed;
mod frames;
mod meter;
mod path;

use core::fmt::{self, Write};

use fixed::{FixedI32, types::extra::U16};

pub fn measure(out: &mut impl Write) -> fmt::Result {
    path::queues(out)?;
    framed::measure(out)?;
    framed::measure_slow(out)?;
    formats::measure(out)?;
    chips::measure(out)?;
    frames::measure(out)
}

/// What sets of six samples cost: in a bank, and from there to frames.
pub fn measure_sets(out: &mut impl Write) -> fmt::Result {
    banks::measure::<f32>(out, "f32")?;
    path::measure::<f32>(out, "f32")?;
    banks::measure::<FixedI32<U16>>(out, "q16.16")?;
    path::measure::<FixedI32<U16>>(out, "q16.16")?;
    path::measure::<i16>(out, "i16")
}

/// Ends the program with a reason if something is not as it must be.
fn ensure(out: &mut impl Write, holds: bool, subject: &str) -> fmt::Result {
    if !holds {
        writeln!(out, "{subject}: what was read is not what was written")?;
        return Err(fmt::Error);
    }
    Ok(())
}
