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

use core::fmt;
use flight::CHANNELS;
use line::Line;

/// Stands in until the schemes are here: a step code by hand.
pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    #[cfg(feature = "float")]
    {
        let mut line = Line::default();
        for index in 0..CHANNELS {
            let mut base = 0.0;
            for x in flight::channel(index) {
                let spike = i8::from(x > base + 0.1) - i8::from(x < base - 0.1);
                base += 0.1 * f32::from(spike);
                line.spike(spike);
                line.decoded(x, base);
            }
        }
        line.write(out, "placeholder", "f32")?;
    }

    let mut line = Line::default();
    for index in 0..CHANNELS {
        let mut base = 0i16;
        for x in flight::channel(index).map(|x| (x * 256.0) as i16) {
            let spike =
                i8::from(x > base.saturating_add(25)) - i8::from(x < base.saturating_sub(25));
            base = base.saturating_add(25 * i16::from(spike));
            line.spike(spike);
            line.decoded(f32::from(x), f32::from(base));
        }
    }
    line.write(out, "placeholder", "i16")
}
