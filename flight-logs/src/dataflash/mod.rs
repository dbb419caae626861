//! Reads `ArduPilot`'s `DataFlash` logs: the binary form `.bin`, and the text form `.log`.
//!
//! Every type of message is a topic. Further instances of a sensor have topics such as `IMU:1`. Columns that are logged
//! as fixed-point integers are divided by their factor, as in the Python library pymavlink. Messages of type `MULT`
//! define multipliers for units; the numbers of a log are not multiplied by them.

mod binary;
mod format;
mod text;

pub(crate) use binary::Binary;
pub(crate) use text::Text;

/// First bytes of the `FMT` message that defines `FMT` itself. This message is the first of every log.
pub(crate) const START: &[u8] = b"\xa3\x95\x80\x80\x59FMT\0BBnNZ";

/// A log must begin within this number of bytes from the start of its file, because some loggers write other text
/// first.
pub(crate) const LOOKED_AT: u64 = 8192;

/// Returns whether `start` begins a text log. One of its lines must be the `FMT` message that defines `FMT` itself.
pub(crate) fn is_text(start: &[u8]) -> bool {
    start.split(|&byte| byte == b'\n').any(|line| {
        let mut words = line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii);
        [&b"FMT"[..], b"128", b"89", b"FMT"].iter().all(|word| words.next() == Some(word))
    })
}
