//! `ArduPilot`'s `DataFlash` logs: `.bin`, and the same in text, `.log`.
//!
//! A topic each for every type of message, later instances of a sensor as `IMU:1`. Columns of letters that stand for multiples
//! are divided, as pymavlink does; the multipliers of `MULT` belong to units and change no number.

mod binary;
mod format;
mod text;

pub(crate) use binary::Binary;
pub(crate) use text::Text;

/// The definition of `FMT` itself, with which a log begins.
pub(crate) const START: &[u8] = b"\xa3\x95\x80\x80\x59FMT\0BBnNZ";

/// The bytes of a file among which a log must begin: some loggers write words before it.
pub(crate) const LOOKED_AT: u64 = 8192;

/// Whether a file is a text log: a line among the first defines `FMT` itself.
pub(crate) fn is_text(start: &[u8]) -> bool {
    start.split(|&byte| byte == b'\n').any(|line| {
        let mut words = line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii);
        [&b"FMT"[..], b"128", b"89", b"FMT"].iter().all(|word| words.next() == Some(word))
    })
}
