//! The host: what the board's UART said, from standard input, to values.

use crate::{SCHEMES, digest::Digest};
use spikewire::link::{MAX_FRAME, Reader, Receiver};
use std::{
    fmt,
    io::{self, Read},
};

pub fn run(out: &mut impl fmt::Write) -> fmt::Result {
    let mut captured = Vec::new();
    io::stdin().read_to_end(&mut captured).map_err(|_| fmt::Error)?;

    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::from_schemes(SCHEMES);
    let mut decoded = Digest::new();
    let mut bytes = captured.as_slice();
    while let Some(received) = reader.next_frame(&mut bytes) {
        // Keyframes come first in a frame, and repeat what is known.
        let mut keyframes = received.frame.keyframes().count();
        receiver.apply(&received, |channel, tick, value| match keyframes.checked_sub(1) {
            Some(rest) => keyframes = rest,
            None => decoded.add(channel, tick, value),
        });
    }
    writeln!(out, "{decoded}")?;
    writeln!(
        out,
        "{} bytes, {} frames, {} lost, {} bytes skipped",
        captured.len(),
        reader.frames(),
        reader.lost_frames(),
        reader.skipped()
    )
}
