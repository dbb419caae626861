//! Reads `ArduPilot`'s `DataFlash` logs: the binary form `.bin`, and the text form `.log`.
//!
//! Every type of message is a topic; later instances of a sensor are `IMU:1` and so on. Columns whose letters stand for
//! multiples are divided, as in pymavlink. The multipliers in `MULT` belong to the units, and change no number.

mod binary;
mod format;
mod text;

pub(crate) use binary::Binary;
pub(crate) use text::Text;

/// The definition of `FMT` itself, with which a log begins.
pub(crate) const START: &[u8] = b"\xa3\x95\x80\x80\x59FMT\0BBnNZ";

/// Number of bytes within which a log must begin: some loggers write text before it.
pub(crate) const LOOKED_AT: u64 = 8192;

/// Returns whether a file is a text log, that is, whether one of its first lines defines `FMT` itself.
pub(crate) fn is_text(start: &[u8]) -> bool {
    start.split(|&byte| byte == b'\n').any(|line| {
        let mut words = line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii);
        [&b"FMT"[..], b"128", b"89", b"FMT"].iter().all(|word| words.next() == Some(word))
    })
}
