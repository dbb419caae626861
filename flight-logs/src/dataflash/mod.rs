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

/// First bytes of the `FMT` message that defines `FMT` itself. This message is the first of most logs.
const START: &[u8] = b"\xa3\x95\x80\x80\x59FMT\0BBnNZ";

/// Returns whether the first bytes of a file hold the start of a binary log: a message that defines a format.
pub(crate) fn is_binary(start: &[u8]) -> bool {
    start.windows(START.len()).any(|window| window == START) || binary::is_log(start)
}

/// Returns whether `start` holds the start of a text log. One of its lines must be an `FMT` message, which defines the
/// format of a message.
pub(crate) fn is_text(start: &[u8]) -> bool {
    start.split(|&byte| byte == b'\n').any(|line| {
        let mut words = line.splitn(6, |&byte| byte == b',').map(<[u8]>::trim_ascii);
        let is_definition = words.next() == Some(b"FMT");
        let words: Option<Vec<&str>> = words.map(|word| str::from_utf8(word).ok()).collect();
        let Some([kind, length, name, letters, columns]) = words.as_deref() else { return false };
        let (kind, length) = (kind.parse::<u8>(), length.parse());
        let (true, Ok(_), Ok(length)) = (is_definition, kind, length) else { return false };
        // The `FMT` line for `FMT` itself lacks the name of the last column.
        *name == "FMT" || format::Format::new(name, length, letters, columns).columns.is_ok()
    })
}
